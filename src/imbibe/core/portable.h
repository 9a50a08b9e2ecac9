// Elementary functions with the same bits on every machine and from every compiler.
//
// Those of the C library are not: glibc chooses between variants with and without fused multiply-add when the program
// starts (GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA changed the state of drop_on_cotton after 30 ms), and changes them
// from version to version. These here use nothing but +, -, *, /, sqrt and bit patterns, all exact by IEEE 754 (with
// -ffp-contract=off, which the build sets). All code that the state of a run depends on calls them; sqrt, floor, fabs
// and the like of the standard library are exact and stay.
//
// Method: reduction of the argument to a short interval, there the Taylor series (exp, sin, cos) or that of artanh (log)
// and arctan, summed to below half a unit in the last place. Error: below 1 unit in the last place for exp, log, sin,
// cos, cbrt; 2 for the arcs, expm1 and pow (|y log x| < 50). Tested against long double in tests/core/portable_test.cpp,
// where a sum over all bits is the same on every machine.
#pragma once

#include "imbibe/core/types.h"

namespace imbibe::portable {

Real exp(Real x);
Real expm1(Real x);
Real log(Real x);              // NaN below 0, -infinity at 0
Real pow(Real x, Real y);      // x >= 0, or whole y; else NaN
Real cbrt(Real x);
Real sin(Real x);              // |x| < 1e6 or so: beyond, digits of pi are missing
Real cos(Real x);
Real asin(Real x);             // NaN outside [-1, 1]
Real acos(Real x);
Real atan2(Real y, Real x);
inline Real tan(Real x) { return sin(x) / cos(x); }
inline Real hypot(Real x, Real y) { return std::sqrt(x * x + y * y); }

}  // namespace imbibe::portable
