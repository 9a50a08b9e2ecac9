// Axis-aligned boxes.
#pragma once

#include <algorithm>

#include "imbibe/core/types.h"

namespace imbibe {

// Empty when lower > upper; starts empty.
struct Bounds {
  Vec3 lower{unlimited_length, unlimited_length, unlimited_length};
  Vec3 upper{-unlimited_length, -unlimited_length, -unlimited_length};
  static constexpr Real unlimited_length = std::numeric_limits<Real>::infinity();

  void include(const Vec3& p) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
  }
  void include(const Bounds& b) {
    if (b.empty()) return;
    include(b.lower);
    include(b.upper);
  }
  void grow(Real margin) { lower -= {margin, margin, margin}, upper += {margin, margin, margin}; }
  bool empty() const { return lower.x > upper.x; }
  bool contains(const Vec3& p) const {
    return p.x >= lower.x && p.x <= upper.x && p.y >= lower.y && p.y <= upper.y && p.z >= lower.z && p.z <= upper.z;
  }
  bool overlaps(const Bounds& b) const {
    return lower.x <= b.upper.x && b.lower.x <= upper.x && lower.y <= b.upper.y && b.lower.y <= upper.y &&
           lower.z <= b.upper.z && b.lower.z <= upper.z;
  }
  Vec3 centre() const { return 0.5 * (lower + upper); }
  Vec3 size() const { return empty() ? Vec3{} : upper - lower; }
};

}  // namespace imbibe
