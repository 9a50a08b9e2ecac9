#include "imbibe/wetting/entry.h"

#include <algorithm>

#include "imbibe/core/portable.h"

namespace imbibe {

Real meniscus_pressure(Real surface_tension, Real angle, const PoreOpening& o, Real phi) {
  const Real height = 1 - portable::sin(phi);
  return surface_tension * portable::sin(angle + phi - pi) *
         (1 / (0.5 * o.gap_x + o.radius_x * height) + 1 / (0.5 * o.gap_y + o.radius_y * height));
}

Real breakthrough_pressure(Real surface_tension, Real angle, const PoreOpening& o) {
  // Smooth with one maximum in (pi - theta, pi]: bracket on a grid, then golden section.
  const auto pressure = [&](Real phi) { return meniscus_pressure(surface_tension, angle, o, phi); };
  constexpr int steps = 64;
  const Real first = pi - angle, step = angle / steps;
  int best = 0;
  for (int i = 1; i <= steps; ++i) {
    if (pressure(first + i * step) > pressure(first + best * step)) best = i;
  }
  Real low = first + std::max(0, best - 1) * step, high = first + std::min(steps, best + 1) * step;
  constexpr Real golden = 0.6180339887498949;
  for (int i = 0; i < 40; ++i) {
    const Real a = high - golden * (high - low), b = low + golden * (high - low);
    (pressure(a) > pressure(b) ? high : low) = pressure(a) > pressure(b) ? b : a;
  }
  return std::max(pressure(0.5 * (low + high)), pressure(pi));
}

Real opening_pressure(Real surface_tension, Real angle, const PoreOpening& o) {
  return meniscus_pressure(surface_tension, angle, o, pi);
}

Real inertial_speed(Real driving_pressure, Real density) {
  return std::sqrt(2 * std::max<Real>(0, driving_pressure) / (1.5 * density));
}

}  // namespace imbibe
