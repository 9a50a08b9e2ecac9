// A drop that hangs under a wet cloth, and when it falls.
//
//   m = f 2 pi r gamma / g
//
// m kg, what breaks off; r m, radius of the drop's neck; gamma N/m; g m/s2; f 0.6, the part of the hanging drop that falls.
// Source: Tate, Phil. Mag. 27 (1864) 176; f: Harkins & Brown, J. Am. Chem. Soc. 41 (1919) 499, 0.60 to 0.65 for r/V^(1/3)
// from 0.7 to 1.2 and up to 0.75 for narrower necks. A hem has no rim that would set r: liquid wets it, and the neck is as
// wide as the drop lets it be, about three quarters of the capillary length sqrt(gamma/(rho g)), 2 mm for water (m; drops
// from wet cloth and from taps weigh 40 to 60 mg).
// Assumes it fills slowly against its own swinging (5 ms). Tested in tests/coupling/cell_cloth_test.cpp.
#pragma once

#include "imbibe/core/types.h"

namespace imbibe {

constexpr Real falling_part = 0.6;

// kg; infinite without gravity.
constexpr Real falling_drop_kg(Real neck_radius, Real surface_tension, Real gravity) {
  return gravity > 0 ? falling_part * 2 * pi * neck_radius * surface_tension / gravity
                     : std::numeric_limits<Real>::infinity();
}

}  // namespace imbibe
