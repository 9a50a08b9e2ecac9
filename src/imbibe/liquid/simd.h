// Eight particles at a time with the compiler's vector types: one loop body for every instruction set. Each lane is
// one particle, so its sums run in list order and the bits do not depend on the vector width of the machine.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "imbibe/core/types.h"
#include "imbibe/liquid/particles.h"

namespace imbibe::simd {

inline constexpr int lanes = 8;
using Floats = float __attribute__((vector_size(4 * lanes)));
using Ints = std::int32_t __attribute__((vector_size(4 * lanes)));
using Floats3 = Vector3<Floats>;  // three components of eight particles
using Row = float __attribute__((vector_size(16)));

inline Floats load(const float* p) {
  Floats v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
inline Ints load_int(const void* p) {
  Ints v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
inline void store(float* p, Floats v) { std::memcpy(p, &v, sizeof v); }
inline Floats broadcast(float s) { return Floats{} + s; }
inline Floats max(Floats a, Floats b) { return a > b ? a : b; }
inline Floats min(Floats a, Floats b) { return a < b ? a : b; }
inline Floats max(Floats a, float b) { return max(a, broadcast(b)); }
inline Floats min(Floats a, float b) { return min(a, broadcast(b)); }
inline Floats select(Ints mask, Floats yes, Floats no) { return mask ? yes : no; }
inline Floats sqrt(Floats v) {  // exact; the compiler turns the loop into one instruction (-fno-math-errno)
  Floats r;
  for (int l = 0; l < lanes; ++l) r[l] = std::sqrt(v[l]);
  return r;
}
// Bit l is set where lane l of a comparison is true.
inline unsigned bits(Ints mask) {
#ifdef __AVX__
  return static_cast<unsigned>(__builtin_ia32_movmskps256(reinterpret_cast<Floats>(mask)));
#else
  unsigned b = 0;
  for (int l = 0; l < lanes; ++l) b |= mask[l] ? 1u << l : 0u;
  return b;
#endif
}
// Lane l of the result is lane from[l] of v.
template <class Vector>
inline Vector permuted(Vector v, Ints from) {
#ifdef __clang__  // has no __builtin_shuffle by a variable
  Vector r;
  for (int l = 0; l < lanes; ++l) r[l] = v[from[l]];
  return r;
#else
  return __builtin_shuffle(v, from);
#endif
}
inline Floats dot(const Floats3& a, const Floats3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// Eight records of four floats.
struct Floats4 {
  Floats x, y, z, w;
  Floats3 xyz() const { return {x, y, z}; }
};

namespace detail {
inline Row row(const Float4* p) {
  Row r;
  std::memcpy(&r, p, sizeof r);
  return r;
}
// Rows a0..a7 become columns.
inline Floats4 transposed(Row a0, Row a1, Row a2, Row a3, Row a4, Row a5, Row a6, Row a7) {
  const Floats p0 = __builtin_shufflevector(a0, a4, 0, 1, 2, 3, 4, 5, 6, 7);
  const Floats p1 = __builtin_shufflevector(a1, a5, 0, 1, 2, 3, 4, 5, 6, 7);
  const Floats p2 = __builtin_shufflevector(a2, a6, 0, 1, 2, 3, 4, 5, 6, 7);
  const Floats p3 = __builtin_shufflevector(a3, a7, 0, 1, 2, 3, 4, 5, 6, 7);
  const Floats xy01 = __builtin_shufflevector(p0, p1, 0, 8, 1, 9, 4, 12, 5, 13);
  const Floats zw01 = __builtin_shufflevector(p0, p1, 2, 10, 3, 11, 6, 14, 7, 15);
  const Floats xy23 = __builtin_shufflevector(p2, p3, 0, 8, 1, 9, 4, 12, 5, 13);
  const Floats zw23 = __builtin_shufflevector(p2, p3, 2, 10, 3, 11, 6, 14, 7, 15);
  return {__builtin_shufflevector(xy01, xy23, 0, 1, 8, 9, 4, 5, 12, 13),
          __builtin_shufflevector(xy01, xy23, 2, 3, 10, 11, 6, 7, 14, 15),
          __builtin_shufflevector(zw01, zw23, 0, 1, 8, 9, 4, 5, 12, 13),
          __builtin_shufflevector(zw01, zw23, 2, 3, 10, 11, 6, 7, 14, 15)};
}
}  // namespace detail

// The records of eight neighbours, by index: 8 row loads and 12 shuffles instead of 32 gathers.
inline Floats4 load4(const Float4* base, const Index* id) {
  using detail::row;
  return detail::transposed(row(base + id[0]), row(base + id[1]), row(base + id[2]), row(base + id[3]),
                            row(base + id[4]), row(base + id[5]), row(base + id[6]), row(base + id[7]));
}
// Eight consecutive records.
inline Floats4 load4(const Float4* p) {
  using detail::row;
  return detail::transposed(row(p), row(p + 1), row(p + 2), row(p + 3), row(p + 4), row(p + 5), row(p + 6), row(p + 7));
}
// Eight floats by index.
inline Floats load(const float* base, const Index* id) {
  return Floats{base[id[0]], base[id[1]], base[id[2]], base[id[3]], base[id[4]], base[id[5]], base[id[6]], base[id[7]]};
}
inline void store4(Float4* p, const Floats4& v) {
  for (int l = 0; l < lanes; ++l) p[l] = {v.x[l], v.y[l], v.z[l], v.w[l]};
}
inline void store4(Float4* p, const Floats3& v, Floats w) { store4(p, Floats4{v.x, v.y, v.z, w}); }

}  // namespace imbibe::simd
