// Pores between yarns: what they hold, how hard they pull, and the links through them.
//
//   throat       r_t = w_x w_y/(w_x + w_y);  P_e = 2 gamma cos(theta)/r_t;  P_c = P_e s^(-1/lambda_p), lambda_p = 2
//   from a face  q = pi r_t^4/(8 eta x) (p_liq + P_e - rho g x),  x = s t      (an empty pore fills as its throat's tube)
//   yarn - pore  q = T f [Psi_y(p_yarn) - Psi_y(p_pore)],  1/T = 1/T_lat + 2 r/(w T_along),
//                T_lat = K_t 0.4 pi r l/(eta r) on each of 4 pores,  f = sqrt(max(s_pore, 1e-4))
//   pore - pore  q = T [max(p_a - P_open, 0) - max(p_b - P_open, 0)],  T = 2 w h^3/(3 eta pitch),  h = (t - 2r)/2
//   tube alone   x dx/dt = r^2/(8 eta) (p + P_e - rho g x)                      Washburn; with gravity Fries & Dreyer
//   as_printed   D = D* + R U/(48 D), read implicitly: D = D*/2 + sqrt(D*^2/4 + R U/48)        seed A eq. 10
//
// w free gap, t thickness, x filled length, m; corner menisci give lambda_p = 2. P_open see entry.h.
// Pores are open at both faces. As closed tubes between each other they would wick ten times too fast, so a link in the
// plane is a valve that opens only when the meniscus bulges over the yarn between (p > P_open), gravity inside the same
// function. The axial part in series keeps liquid from hopping yarn - pore - yarn past the yarn's own resistance.
// f: corner menisci wet the walls of a pore as the root of its content. A floor of 0.01 would let liquid cross a dry pore
// from one hydrophilic yarn to the next beside hydrophobic ones.
// Source: Washburn 1921; Fries & Dreyer, J. Colloid Interface Sci. 320 (2008) 259, eq. 16; the links are derived.
// Tested in tests/wetting/models_test.cpp and network_test.cpp (Jurin, Washburn, Fries-Dreyer within 1 %).
#pragma once

#include "imbibe/core/types.h"
#include "imbibe/wetting/along_yarn.h"

namespace imbibe {

Real pore_throat_radius(Real gap_x, Real gap_y);
Real throat_suction(Real surface_tension, Real cos_angle, Real throat);
Real jurin_height(Real surface_tension, Real cos_angle, Real radius, Real density, Real gravity);

// h(t) of a vertical tube, Fries & Dreyer: (a/b) [1 + W0(-exp(-1 - b^2 t/a))]; Washburn where gravity = 0.
Real tube_rise(Real surface_tension, Real cos_angle, Real radius, Real density, Real viscosity, Real gravity, Real time);
// Principal branch of Lambert's W on [-1/e, 0].
Real lambert_w0(Real x);

// Conductance of a tube filled over `filled` metres, m3/(Pa s).
Real tube_conductance(Real radius, Real viscosity, Real filled);

Real lateral_conductance(Real transverse, Real radius, Real length, Real viscosity);
Real yarn_pore_conductance(Real lateral, Real along, Real radius, Real gap);
Real slot_conductance(Real gap, Real height, Real viscosity, Real pitch);

// max(p - open, 0).
constexpr Sloped valve(Real pressure, Real open) {
  return pressure > open ? Sloped{pressure - open, 1} : Sloped{0, 0};
}

Real printed_pore_diffusivity(Real molecular, Real radius, Real velocity);

}  // namespace imbibe
