// Two pieces of one sheet that may meet: a node and a triangle, or two edges, that share no node. Where they are nearest,
// and when moving ones come near.
//
// The swept test steps along the motion by what the distance allows (additive conservative advancement, Li, Kaufman &
// Jiang, ACM TOG 40 (2021) 170, section 5): with d the distance and L the greatest speed at which it can shrink, no contact
// can come before t + d/L. No polynomial is solved and nothing is missed: a pair that is let through stays apart by at
// least a tenth of its distance at the start.
// Tested in tests/cloth/close_pair_test.cpp against sampled motions.
#pragma once

#include <algorithm>
#include <array>
#include <optional>

#include "imbibe/core/types.h"
#include "imbibe/geometry/closest.h"

namespace imbibe {

enum class PairKind : std::uint8_t { node_triangle, edge_edge };

// node_triangle: node 0 against the triangle 1 2 3. edge_edge: the edge 0 1 against the edge 2 3.
struct ClosePair {
  std::array<Index, 4> node{};
  PairKind kind = PairKind::node_triangle;
  Real thickness = 0;  // m they are to keep
};

// The gap: sum weight x = distance * normal, normal towards the first piece.
struct PairGap {
  Real distance = 0;
  Vec3 normal{};
  std::array<Real, 4> weight{};
};

namespace detail {

// Parameters (s, t) of the nearest points of the segments a + s u and b + t v.
inline std::array<Real, 2> nearest_on_segments(const Vec3& a, const Vec3& u, const Vec3& b, const Vec3& v) {
  const Vec3 r = a - b;
  const Real uu = squared_norm(u), vv = squared_norm(v), uv = dot(u, v), ur = dot(u, r), vr = dot(v, r);
  const auto clamped = [](Real x) { return std::clamp(x, Real{0}, Real{1}); };
  const Real determinant = uu * vv - uv * uv;
  // Parallel edges: any s will do.
  Real s = determinant > 1e-14 * uu * vv ? clamped((uv * vr - ur * vv) / determinant) : Real{0};
  Real t = vv > 0 ? (uv * s + vr) / vv : Real{0};
  if (t < 0 || t > 1) {
    t = clamped(t);
    s = uu > 0 ? clamped((uv * t - ur) / uu) : Real{0};
  }
  return {s, t};
}

}  // namespace detail

inline PairGap gap_of(PairKind kind, const std::array<Vec3, 4>& x) {
  PairGap gap;
  Vec3 away;
  if (kind == PairKind::node_triangle) {
    const Vec3 point = closest_on_triangle(x[0], x[1], x[2], x[3]).point;
    const auto b = barycentric(point, x[1], x[2], x[3]);
    gap.weight = {1, -b[0], -b[1], -b[2]};
    away = x[0] - point;
  } else {
    const Vec3 u = x[1] - x[0], v = x[3] - x[2];
    const auto [s, t] = detail::nearest_on_segments(x[0], u, x[2], v);
    gap.weight = {1 - s, s, t - 1, -t};
    away = (x[0] + s * u) - (x[2] + t * v);
  }
  gap.distance = norm(away);
  if (gap.distance > 0) gap.normal = away / gap.distance;
  return gap;
}

// Greatest speed at which the distance of the pair can shrink: sum of the greatest displacements of both pieces, less
// their common motion.
inline Real approach_bound(PairKind kind, std::array<Vec3, 4>& motion) {
  const Vec3 mean = 0.25 * (motion[0] + motion[1] + motion[2] + motion[3]);
  for (Vec3& m : motion) m -= mean;
  if (kind == PairKind::node_triangle) {
    return norm(motion[0]) + std::sqrt(std::max({squared_norm(motion[1]), squared_norm(motion[2]),
                                                 squared_norm(motion[3])}));
  }
  return std::sqrt(std::max(squared_norm(motion[0]), squared_norm(motion[1]))) +
         std::sqrt(std::max(squared_norm(motion[2]), squared_norm(motion[3])));
}

// The gap at the time (within a tenth of it) at which a pair that starts apart, moving by `motion`, is to be stopped;
// nothing when it stays apart. A pair that starts in touch gives nothing: it has no side to be kept on.
inline std::optional<PairGap> swept_gap(PairKind kind, std::array<Vec3, 4> x, std::array<Vec3, 4> motion) {
  const Real bound = approach_bound(kind, motion);
  PairGap gap = gap_of(kind, x);
  const Real start = gap.distance;
  if (start > bound || !(start > 0)) return std::nullopt;
  constexpr Real kept = 0.1;
  Real time = 0;
  for (int round = 0; round < 1000; ++round) {
    const Real advance = (1 - kept) * gap.distance / bound;
    time += advance;
    if (time >= 1) return std::nullopt;
    for (std::size_t k = 0; k < 4; ++k) x[k] += advance * motion[k];
    gap = gap_of(kind, x);
    if (gap.distance < kept * start) return gap;
  }
  return gap;
}

}  // namespace imbibe
