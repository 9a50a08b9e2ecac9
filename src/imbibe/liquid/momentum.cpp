#include "imbibe/liquid/momentum.h"

#include <cmath>
#include <limits>

#include "imbibe/core/parallel.h"

namespace imbibe {
namespace {

constexpr Real most_rounded = 1e-5;  // of what was exchanged; measured: 1e-6 at most

// Adds to one stored number; returns what rounding kept back.
Real add_rounded(float& stored, Real change) {
  const Real wanted = static_cast<Real>(stored) + change;
  stored = static_cast<float>(wanted);
  return wanted - static_cast<Real>(stored);
}

// Along one axis: what is left over, and the particle that moves least (the first of equals).
struct Spread {
  Real left = 0;
  float speed = std::numeric_limits<float>::infinity();
  std::size_t slowest = 0;
  Spread& operator+=(const Spread& o) {
    left += o.left;
    if (o.speed < speed) speed = o.speed, slowest = o.slowest;
    return *this;
  }
};

Real spread_along(float Float4::*axis, std::span<Float4> velocity, Real missing) {
  const Real share = missing / static_cast<Real>(velocity.size());
  const Spread all = parallel_sum(velocity.size(), [&](std::size_t begin, std::size_t end) {
    Spread part;
    for (std::size_t i = begin; i < end; ++i) {
      part.left = add_rounded(velocity[i].*axis, share + part.left);
      part += {.left = 0, .speed = std::abs(velocity[i].*axis), .slowest = i};
    }
    return part;
  });
  return add_rounded(velocity[all.slowest].*axis, all.left);
}

}  // namespace

SpeedSums sum_speeds(std::span<const Float4> velocity) {
  return parallel_sum(velocity.size(), [&](std::size_t begin, std::size_t end) {
    SpeedSums sums;
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 v(velocity[i].x, velocity[i].y, velocity[i].z);
      sums.velocity += v, sums.speed += norm(v);
    }
    return sums;
  });
}

Vec3 spread_over_particles(std::span<Float4> velocity, const Vec3& missing) {
  if (velocity.empty()) return missing;
  return {spread_along(&Float4::x, velocity, missing.x), spread_along(&Float4::y, velocity, missing.y),
          spread_along(&Float4::z, velocity, missing.z)};
}

Vec3 make_up_rounding(std::span<Float4> velocity, const SpeedSums& before, const Vec3& given, Real exchanged) {
  const SpeedSums now = sum_speeds(velocity);
  const Vec3 missing = before.velocity + given - now.velocity;
  if (norm(missing) > most_rounded * (before.speed + now.speed + exchanged)) return {};
  return spread_over_particles(velocity, missing);
}

}  // namespace imbibe
