// Liquid between the fibres of a yarn: permeability, suction, and the three laws of transport along it.
//
// physical    q = T [Psi(p_i - rho g dz/2) - Psi(p_j + rho g dz/2)],  T = K_a pi r^2/(eta l),  dz = z_j - z_i
//     Gebart:       K_a = (8 R_f^2/53) eps^3/phi^2 / tau^2,  K_t = 0.231 R_f^2 (sqrt(0.9069/phi) - 1)^(5/2) / tau^2
//     suction:      P_h = gamma cos(theta_a + alpha) 2 phi/(R_f eps),  P_e = P_h 0.5^(1/lambda)
//     Brooks-Corey: P_c = P_e s^(-1/lambda),  k_r = s^(3 + 2/lambda)          (of pores between yarns see capillary.h)
//     Kirchhoff:    Psi(p) = int k_r dp = P_e s^(3 + 1/lambda)/(3 lambda + 1) below s = 1, Psi(1) + (p + P_e) above
//     over-full:    p rises in a straight line from -P_e at s = 1 to P_open at s = 1 + delta (bulging menisci)
// kunzel      D_ws(s) = 3.8 (A_w/w_f)^2 1000^(s - 1); after the source is gone D_ww = D_ws/10
//     Kirchhoff:    Phi(s) = (1000^(s-1) - 1000^(-1))/ln 1000, flow = A eps D_ws(1) (Phi_i - Phi_j)/l
// as_printed  D(s) = 3.8 A_w/(rho c_s) 1000^(-s), seed A eq. 7 read literally (square lost, falling with content)
//     Kirchhoff:    Phi(s) = (1 - 1000^(-s))/ln 1000
//
// K m2; R_f fibre radius, r yarn radius, l arc length m; phi fibre share, eps = 1 - phi; eta Pa s; gamma N/m; theta_a
// advancing angle, alpha divergence of the fibres; lambda size index; s saturation; p Pa; A_w kg/(m2 s^0.5);
// w_f = rho eps kg/m3; c_s liquid volume per yarn volume at saturation.
// Source: Gebart, J. Compos. Mater. 26 (1992) 1100 (hexagonal packing); Brooks & Corey 1964 with Burdine's k_r; Kuenzel,
// Simultaneous Heat and Moisture Transport, 1995, eq. 24. tau^2 (2-10) is documented, not derived; alpha = 10 degrees
// was calibrated on one class (plain polyester).
// Assumes fibres parallel, laminar, isothermal, air free to leave. The Kirchhoff difference lets a wet node wet a dry one
// with finite flow although k_r(0) = 0; upwinded differences of p would blow up there, harmonic means freeze.
// Tested in tests/wetting/models_test.cpp, network_test.cpp (sorptivity, Kuenzel absorption), spreading_test.cpp.
#pragma once

#include "imbibe/core/types.h"

namespace imbibe {

Real axial_permeability(Real fibre_radius, Real packing, Real tortuosity_squared);
Real transverse_permeability(Real fibre_radius, Real packing, Real tortuosity_squared);
Real mean_suction(Real surface_tension, Real cos_angle, Real fibre_radius, Real packing);
Real entry_suction(Real mean_suction, Real size_index);

// A scalar and its derivative.
struct Sloped {
  Real value = 0, slope = 0;
};

// p(s) of a node: Brooks-Corey with x = s/(c + (1 - c) s) in place of s, then a straight line to `open` at 1 + overfill
// and beyond. c = 1: plain Brooks-Corey, a yarn; c < 1: a pore whose middle empties at P_e (capillary.h).
struct Retention {
  Real entry = 0;      // P_e > 0, Pa
  Real size_index = 5; // lambda
  Real open = 0;       // P_open, Pa
  Real overfill = 0.02;
  Real corner_share = 1;  // c, 0 .. 1, above 0
};
inline constexpr Real driest = 1e-10;  // saturation below which the suction no longer grows

// x: the saturation at which plain Brooks-Corey has the same pressure; s < 1.
inline Real plain_saturation(const Retention& r, Real s) { return s / (r.corner_share + (1 - r.corner_share) * s); }
Sloped pressure_at(const Retention& retention, Real saturation);
// The saturation at pressure p (inverse of the above).
Real saturation_at(const Retention& retention, Real pressure);
Real relative_permeability(Real saturation, Real size_index);

// Psi(p) and k_r = dPsi/dp.
Sloped kirchhoff_potential(Real entry, Real size_index, Real pressure);

// Phi(s) of Kuenzel's and of the printed diffusivity, per D(1) and D(0).
Sloped kunzel_potential(Real saturation);
Sloped printed_potential(Real saturation);
Real kunzel_diffusivity(Real absorption_coefficient, Real free_saturation);  // D_ws(1), m2/s
Real printed_diffusivity(Real absorption_coefficient, Real density, Real saturated_share);  // D(0) of eq. 7

// S^2 of a yarn fed at p = 0: (K P_e/(eta eps)) [2 + (1/lambda)(1/(m+1) + 1/(m+2))], m = 2 + 1/lambda; water taken
// per cross-section of yarn = eps S sqrt(t).
Real sorptivity_squared(Real permeability, Real entry, Real viscosity, Real void_share, Real size_index);

}  // namespace imbibe
