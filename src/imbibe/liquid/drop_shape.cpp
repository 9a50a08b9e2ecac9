#include "imbibe/liquid/drop_shape.h"

#include <algorithm>

#include "imbibe/core/error.h"
#include "imbibe/core/portable.h"

namespace imbibe {

namespace {

// Along the profile: r, z, phi and the integrals over the volume above.
struct State {
  Real r = 0, z = 0, phi = 0;
  Real volume = 0, depth_moment = 0, square_moment = 0;  // of 1, z and <x2 + y2>
};

struct Ode {
  Real b, c;

  State slope(const State& y) const {
    const Real sine = portable::sin(y.phi), section = pi * y.r * y.r;
    const Real around = y.r > 0 ? sine / y.r : b;
    return {portable::cos(y.phi), sine, 2 * b + c * y.z - around, section * sine, section * y.z * sine,
            section * y.r * y.r / 2 * sine};
  }

  State step(const State& y, Real h) const {
    const auto add = [](const State& a, const State& d, Real t) {
      return State{a.r + t * d.r,           a.z + t * d.z,
                   a.phi + t * d.phi,       a.volume + t * d.volume,
                   a.depth_moment + t * d.depth_moment, a.square_moment + t * d.square_moment};
    };
    const State k1 = slope(y), k2 = slope(add(y, k1, h / 2)), k3 = slope(add(y, k2, h / 2)), k4 = slope(add(y, k3, h));
    return add(add(add(add(y, k1, h / 6), k2, h / 3), k3, h / 3), k4, h / 6);
  }
};

}  // namespace

Real cap_volume(Real radius, Real cosine) {
  return pi / 3 * (2 + cosine) * (1 - cosine) * (1 - cosine) * radius * radius * radius;
}

Real cap_radius(Real volume, Real cosine) {
  return portable::cbrt(3 * volume / (pi * (2 + cosine) * (1 - cosine) * (1 - cosine)));
}

SessileShape sessile_profile(Real apex_curvature, Real c, Real angle, Real height, Real longest_step) {
  IMBIBE_ASSERT(apex_curvature > 0 && c >= 0 && angle > 0 && angle <= pi && height > 0 && longest_step > 0);
  constexpr Real turn = 0.01;  // rad per step
  const Ode ode{apex_curvature, c};
  SessileShape shape;
  shape.apex_curvature = apex_curvature;
  State y;
  const auto keep = [&] { shape.profile.push_back({y.r, y.z, y.phi}); };
  keep();
  const auto left = [&](const State& at) { return std::min(angle - at.phi, (height - at.z) / longest_step); };
  while (left(y) > 0) {
    Real h = std::min(longest_step, turn / ode.slope(y).phi);
    State next = ode.step(y, h);
    if (left(next) < 0) {  // the end lies in this step: bisect its length
      Real low = 0;
      for (int i = 0; i < 50; ++i) {
        const Real middle = 0.5 * (low + h);
        (left(ode.step(y, middle)) < 0 ? h : low) = middle;
      }
      y = ode.step(y, low);
      keep();
      break;
    }
    y = next;
    keep();
  }
  shape.angle = y.phi, shape.base_radius = y.r, shape.height = y.z, shape.volume = y.volume;
  if (y.volume > 0) {
    shape.centre_height = y.z - y.depth_moment / y.volume;
    shape.mean_square_radius = y.square_moment / y.volume;
  }
  return shape;
}

SessileShape sessile_shape(Real volume, Real angle, Real c) {
  IMBIBE_ASSERT(volume > 0 && angle > 0 && angle < pi && c >= 0);
  const Real size = portable::cbrt(volume), infinite = std::numeric_limits<Real>::infinity();
  const auto with = [&](Real b) { return sessile_profile(b, c, angle, infinite, 0.01 * size); };
  // A cap without gravity has the most curved apex; from there down until the volume is too large.
  Real high = (1 + 1e-9) / cap_radius(volume, portable::cos(angle));
  if (c == 0) return with(high / (1 + 1e-9));
  Real low = high;
  while (with(low).volume < volume) low /= 2;
  for (int i = 0; i < 60 && high > low * (1 + 1e-12); ++i) {
    const Real middle = std::sqrt(low * high);
    (with(middle).volume < volume ? high : low) = middle;
  }
  return with(std::sqrt(low * high));
}

Real angle_of_centre_height(Real centre_height, Real volume, Real c) {
  Real low = radians(1), high = radians(179);
  for (int i = 0; i < 30; ++i) {
    const Real middle = 0.5 * (low + high);
    (sessile_shape(volume, middle, c).centre_height < centre_height ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace imbibe
