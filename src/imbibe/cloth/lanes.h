// Four numbers at once, with the compiler's vector types: for pieces or threads that share no node. Each lane does what one piece
// does, so its bits are those of a piece solved alone.
#pragma once

#include <cmath>

#include "imbibe/core/types.h"

namespace imbibe {

inline constexpr std::size_t lanes = 4;
using Reals = double __attribute__((vector_size(8 * lanes)));
using Reals3 = Vector3<Reals>;

inline Reals root(Reals v) {
  for (std::size_t l = 0; l < lanes; ++l) v[l] = std::sqrt(v[l]);
  return v;
}
inline Reals size_of(Reals v) { return v < 0 ? -v : v; }
inline Reals greater(Reals a, Reals b) { return a < b ? b : a; }

inline void set_lane(Reals3& v, std::size_t l, const Vec3& value) { v.x[l] = value.x, v.y[l] = value.y, v.z[l] = value.z; }
inline Vec3 lane_of(const Reals3& v, std::size_t l) { return {v.x[l], v.y[l], v.z[l]}; }

}  // namespace imbibe
