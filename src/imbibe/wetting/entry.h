// Whether and how fast liquid on a face enters a pore between round yarns, and when it comes out on the other side.
//
//   P(phi)   = gamma sin(theta + phi - pi) [1/(b_x + r (1 - sin phi)) + 1/(b_y + r (1 - sin phi))]
//   breakthrough = max over phi of P;   P_open = P(pi) = 4 gamma sin(theta)/p_mean
//   inertia: u <= sqrt(2 dP/(1.5 rho))
//
// P pressure the meniscus between two pairs of parallel yarns needs to stand at angle phi from the yarns' crowns
// (flat at phi = pi - theta); b half the free gap w/2 and r the yarn radius of each pair, m; theta contact angle;
// gamma N/m; p_mean mean pitch; dP driving pressure Pa; rho kg/m3.
// Derivation: the gap between two cylinders at angle phi is b + r(1 - sin phi), the meniscus' slope there theta + phi - pi.
// Below 90 degrees a pore fills by itself but holds its liquid up to P_open; from 90 degrees on it stays shut up to the
// breakthrough. 2 gamma |cos theta|/r_t would let a resting drop (50-70 Pa) leak through raw cotton (42 Pa at 95
// degrees where round yarns give 330). The cap is Bosanquet's: the viscous law alone gives 6 m/s in an 86 um throat.
// Tested in tests/wetting/models_test.cpp against a table of both pressures.
#pragma once

#include "imbibe/core/types.h"

namespace imbibe {

struct PoreOpening {
  Real gap_x = 0, gap_y = 0;        // m, free widths between the yarns
  Real radius_x = 0, radius_y = 0;  // m, of the yarns bounding each gap
};

Real meniscus_pressure(Real surface_tension, Real angle, const PoreOpening& opening, Real phi);
Real breakthrough_pressure(Real surface_tension, Real angle, const PoreOpening& opening);
Real opening_pressure(Real surface_tension, Real angle, const PoreOpening& opening);
Real inertial_speed(Real driving_pressure, Real density);

}  // namespace imbibe
