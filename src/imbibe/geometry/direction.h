// Directions that go with a given one.
#pragma once

#include "imbibe/core/types.h"

namespace imbibe {

// A unit vector at right angles to `direction`, which is not zero: which one is fixed, so results can be repeated.
inline Vec3 any_perpendicular(const Vec3& direction) {
  const Vec3 u = normalized(direction);
  return normalized(cross(u, std::abs(u.z) < 0.9 ? Vec3{0, 0, 1} : Vec3{1, 0, 0}));
}

}  // namespace imbibe
