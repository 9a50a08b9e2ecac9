// The smoothing kernel of the liquid and its integrals over solids: the one place that fixes kernel and support.
//
//   W(r)  = 21/(2 pi H^3) (1 - q)^4 (4 q + 1),  q = r/H < 1, else 0        Wendland C2
//   W'(r)/r = -210/(pi H^5) (1 - q)^3                                      so grad_i W = (W'/r)(x_i - x_j)
//   r distance [m], H support radius [m]
//   Source: Wendland, Adv. Comput. Math. 4 (1995) 389; normalised for three dimensions.
//
// Half-space of solid at distance d (d < 0 inside), u = 1 - |d|/H, integrating W over the solid:
//   lambda(d) = 21 (u^6/6 - 3 u^7/14 + u^8/14) for d >= 0, and 1 - lambda(-d) for d < 0
//   A(d) = -dlambda/dd = (21/H)(u^5 - 3 u^6/2 + 4 u^7/7)
// Solid ball of radius R at distance d (either sign, M by |d|): every shell of radius s around the particle lies inside the ball by the
// fraction (s-d)(2R+d-s)/(4(R+d)s), the half-space's times 1 - (s+d)/(2(R+d)), hence exactly (for 2R + d >= H)
//   lambda_ball = lambda - M/(2(R+d)),   M(d) = integral over s in [d, H] of 2 pi s (s^2 - d^2) W ds
//   dlambda_ball/dd = -A R/(R+d) + M/(2(R+d)^2)
// Smoothness instead of a table: no branches, no rounding that depends on a grid.
// Tested in tests/liquid/kernel_test.cpp: unit integral, finite differences, quadrature over half-space and ball.
#pragma once

#include <algorithm>
#include <cmath>

#include "imbibe/core/types.h"

namespace imbibe {

// H / dx. 2.5 gives 65 neighbours, 3 gives 113.
inline constexpr Real support_over_spacing = 2.5;

struct Kernel {
  float support = 1;      // H, m
  float inverse = 1;      // 1/H
  float value_scale = 0;  // 21/(2 pi H^3)
  float slope_scale = 0;  // -210/(pi H^5)

  Kernel() : Kernel(1) {}
  explicit Kernel(Real h)
      : support(static_cast<float>(h)),
        inverse(static_cast<float>(1 / h)),
        value_scale(static_cast<float>(21 / (2 * pi * h * h * h))),
        slope_scale(static_cast<float>(-210 / (pi * h * h * h * h * h))) {}

  // W(r), 1/m3.
  float value(float r) const {
    const float q = r * inverse, t = std::max(0.0f, 1 - q);
    return value_scale * (t * t) * (t * t) * (4 * q + 1);
  }
  // W'(r)/r, 1/m5: grad_i W(|x_i - x_j|) = slope * (x_i - x_j).
  float slope(float r) const {
    const float t = std::max(0.0f, 1 - r * inverse);
    return slope_scale * t * t * t;
  }
};

inline Kernel kernel_for(Real spacing) { return Kernel(support_over_spacing * spacing); }

// By how much V sum W (the particle itself included) exceeds 1 in a body-centred lattice of the rest density: the bias of
// a smooth kernel with few neighbours (Dehnen & Aly, MNRAS 425 (2012) 1068, section 2.6, correct it the same way, at the
// particle's own term). 0.8 % at H = 2.5 dx, 0.4 % at 3 dx; left in, the liquid would swell by as much.
Real lattice_excess(Real support_in_spacings = support_over_spacing);

// By how much it exceeds the lattice's in liquid that has flowed, at support_over_spacing: measured against the sum with
// H = 4.5 dx, which sees no disorder, in a collapsed column of water (0.0056), a free drop (0.0049), a drop on a plane
// (0.0067) and a column with surface tension (0.0071). Other supports: 0.0076, 0.0058, 0.0056, 0.0039 at 2, 2.25, 2.75, 3 dx.
inline constexpr Real disorder_excess = 0.0056;

// The second moment -V sum W'(r) r/3 of that lattice, 0.984 at H = 2.5 dx and 1 in the continuum: the stress that its pairs
// carry at k = 1, over rho0 (pressure.h).
Real lattice_stress(Real support_in_spacings = support_over_spacing);

// Integral of W over a solid at distance d, and its derivative along the outward normal (<= 0).
struct SolidIntegral {
  Real lambda = 0;  // 1
  Real slope = 0;   // dlambda/dd, 1/m
};

SolidIntegral half_space_integral(Real distance, Real support);

// The viscous sum of viscosity.h over a half-space of solid whose velocity continues the liquid's linearly through zero
// at the wall, u(y) = u_i y/d: the acceleration is -nu * half_space_shear * u_t. 1/m2; distance > 0.
//   10/d * (pi/4) integral over s in [d, H] of |W'| (s^2 - d^2)^2/s^2 ds
Real half_space_shear(Real distance, Real support);
// The gradient that the pressure feels from a flat wall over that of lambda (pressure.h), such that a uniform pressure
// does not accelerate liquid next to it although the liquid's own pairs are weighted by 1/(1 - lambda):
//   r = (1 + (1 - lambda) A_s/A)/2,  A_s = 2 A - integral over y > 0 of A(y) A(|d - y|)/(1 - lambda(y))^2
// The weights reach twice as far as the wall; r is cut at -12 (d = 0.8 H, A = 1/300 of its largest value), so that r A goes
// to 0 with A. Left out: 1 % of the gradient at the wall. d < 0 counts as 0.
Real pressure_gradient_ratio(Real distance, Real support);
// curvature = sum of the two principal curvatures of the solid, 1/m (> 0 convex): 2/R for a ball (exact), 1/R for a
// cylinder (first order in H/R), 0 for a plane.
SolidIntegral solid_integral(Real distance, Real curvature, Real support);

}  // namespace imbibe
