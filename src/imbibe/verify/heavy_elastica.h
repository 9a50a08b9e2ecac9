// Tip of a heavy elastica clamped flat: B theta'' = -w (L - s) cos(theta), theta(0) = 0, theta'(L) = 0, theta downward [rad],
// s along the strip [m], w weight and B bending stiffness per width [N/m2, N m]; shooting on theta'(0) with Runge-Kutta's
// fourth-order steps.
#pragma once

#include <cmath>

#include "imbibe/core/types.h"

namespace imbibe::verify {

struct ElasticaTip {
  Real drop = 0, reach = 0;  // m
  Real end_moment = 0;       // theta'(L), 1/m: 0 for the solution
};

inline ElasticaTip shoot_elastica(Real slope, Real length, Real weight_over_stiffness) {
  constexpr int steps = 2000;
  const Real h = length / steps;
  ElasticaTip tip;
  Real theta = 0, rate = slope;
  const auto bend = [&](Real s, Real angle) { return -weight_over_stiffness * (length - s) * std::cos(angle); };
  for (int k = 0; k < steps; ++k) {
    const Real s = k * h;
    const Real a1 = rate, b1 = bend(s, theta);
    const Real a2 = rate + 0.5 * h * b1, b2 = bend(s + 0.5 * h, theta + 0.5 * h * a1);
    const Real a3 = rate + 0.5 * h * b2, b3 = bend(s + 0.5 * h, theta + 0.5 * h * a2);
    const Real a4 = rate + h * b3, b4 = bend(s + h, theta + h * a3);
    const Real middle = theta + 0.5 * h * a2, end = theta + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    tip.drop += h / 6 * (std::sin(theta) + 4 * std::sin(middle) + std::sin(end));
    tip.reach += h / 6 * (std::cos(theta) + 4 * std::cos(middle) + std::cos(end));
    theta = end;
    rate += h / 6 * (b1 + 2 * b2 + 2 * b3 + b4);
  }
  tip.end_moment = rate;
  return tip;
}

inline ElasticaTip heavy_elastica(Real length, Real weight_over_stiffness) {
  Real low = 0, high = weight_over_stiffness * length * length;
  for (int k = 0; k < 100; ++k) {
    const Real middle = 0.5 * (low + high);
    (shoot_elastica(middle, length, weight_over_stiffness).end_moment > 0 ? high : low) = middle;
  }
  return shoot_elastica(0.5 * (low + high), length, weight_over_stiffness);
}

}  // namespace imbibe::verify
