// Pores between yarns: what they hold, how hard they pull, and the links through them.
//
//   throat       r_t = w_x w_y/(w_x + w_y);  P_e = 2 gamma cos(theta)/r_t
//   retention    P_c = P_e (s/(c + (1 - c) s))^(-1/lambda_p),  lambda_p = 2,  c = pi sqrt(r_x r_y) r_t^2/V_p <= 1
//   from a face  q = pi r_t^4/(8 eta x) (p_liq + P_e - rho g x),  x = s t      (an empty pore fills as its throat's tube)
//   yarn - pore  q = T f [Psi_y(p_yarn) - Psi_y(p_pore)],  1/T = 1/T_lat + 2 r/(w T_along),
//                T_lat = K_t 0.4 pi r l/(eta r) on each of 4 pores,  f = sqrt(max(s_pore, 1e-4))
//   pore - pore  q = T [max(p_a - P_open, 0) - max(p_b - P_open, 0)],  T = 2 w h^3/(3 eta pitch),  h = (t - 2r)/2
//   tube alone   x dx/dt = r^2/(8 eta) (p + P_e - rho g x)                      Washburn; with gravity Fries & Dreyer
//   as_printed   D = D* + R U/(48 D), read implicitly: D = D*/2 + sqrt(D*^2/4 + R U/48)        seed A eq. 10
//
// w free gap, t thickness, x filled length, r yarn radius (r_x warp, r_y weft), m; V_p pore m3. P_open see entry.h.
// A pore empties in its middle as soon as the suction passes P_e; what stays are the rings at the crossings, one for each
// pore. Two crossed cylinders stand z = x^2/2 r_x + y^2/2 r_y apart, a meniscus at suction P reaches to z = h =
// 2 gamma cos(theta)/P, and below it lies pi sqrt(r_x r_y) h^2 = c V_p (P_e/P)^2: lambda_p = 2 and c, at any angle below 90
// degrees (.05-.15 for plain cloth; the corners of a square tube, at most .06, hold nothing from 45 degrees on). The law
// joins that to s = 1 at P_e; the jump between c and 1 is spread over a few tenths of P_e, so p(s) stays invertible.
// Rings are thin against the yarn for P >> P_e only; at P_e c is an estimate. Swelling does not change c.
// Pores are open at both faces. As closed tubes between each other they would wick ten times too fast, so a link in the
// plane is a valve that opens only when the meniscus bulges over the yarn between (p > P_open), gravity inside the same
// function. The axial part in series keeps liquid from hopping yarn - pore - yarn past the yarn's own resistance.
// f: rings wet the walls of a pore as the root of its content (2 r_t/(p_x + p_y) P_e/P of them; .25 for shirting, where
// sqrt(c) = .30). A floor of 0.01 would let liquid cross a dry pore from one hydrophilic yarn to the next beside hydrophobic
// ones.
// Source: rings by Derjaguin's approximation for crossed cylinders (Israelachvili, Intermolecular and Surface Forces, ch.
// 17); corners of tubes: Mayer & Stowe 1965, Princen 1969. Washburn 1921; Fries & Dreyer, J. Colloid Interface Sci. 320
// (2008) 259, eq. 16; the links are derived.
// Tested in tests/wetting/models_test.cpp and network_test.cpp (rings, Jurin, Washburn, Fries-Dreyer within 1 %).
#pragma once

#include "imbibe/core/types.h"
#include "imbibe/wetting/along_yarn.h"

namespace imbibe {

Real pore_throat_radius(Real gap_x, Real gap_y);
// c: of a pore, what the ring at its crossing holds at P_e. Radii of warp and weft m, volume m3.
Real pore_ring_share(Real radius_x, Real radius_y, Real throat, Real volume);
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
