// Closest points on the simple pieces that queries end at: a segment and a triangle. Pure functions.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "imbibe/core/types.h"

namespace imbibe {

struct SegmentPoint {
  Vec3 point{};
  Real parameter = 0;  // 0 at a, 1 at b
};

// The point of the segment a-b nearest to p. A segment without length is its point a.
inline SegmentPoint closest_on_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const Real length_squared = squared_norm(along);
  const Real s = length_squared > 0 ? std::clamp(dot(p - a, along) / length_squared, Real(0), Real(1)) : Real(0);
  return {a + s * along, s};
}

// Which part of the triangle (a, b, c) the closest point lies on; edge_ab runs from a to b.
enum class TriangleFeature : std::uint8_t { vertex_a, vertex_b, vertex_c, edge_ab, edge_bc, edge_ca, face };

struct TrianglePoint {
  Vec3 point{};
  TriangleFeature feature = TriangleFeature::face;
};

// The point of the triangle nearest to p. The plane around the triangle is cut into the Voronoi regions of its seven
// features by the signs of dot products; a triangle without area falls to the region of an edge or a vertex.
inline TrianglePoint closest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const Real ab_ap = dot(ab, ap), ac_ap = dot(ac, ap);
  if (ab_ap <= 0 && ac_ap <= 0) return {a, TriangleFeature::vertex_a};

  const Vec3 bp = p - b;
  const Real ab_bp = dot(ab, bp), ac_bp = dot(ac, bp);
  if (ab_bp >= 0 && ac_bp <= ab_bp) return {b, TriangleFeature::vertex_b};

  const Vec3 cp = p - c;
  const Real ab_cp = dot(ab, cp), ac_cp = dot(ac, cp);
  if (ac_cp >= 0 && ab_cp <= ac_cp) return {c, TriangleFeature::vertex_c};

  // Areas of the sub-triangles opposite to c, b and a, each times twice the triangle's area.
  const Real to_c = ab_ap * ac_bp - ab_bp * ac_ap;
  if (to_c <= 0 && ab_ap >= 0 && ab_bp <= 0) {
    return {a + (ab_ap / (ab_ap - ab_bp)) * ab, TriangleFeature::edge_ab};
  }
  const Real to_b = ab_cp * ac_ap - ab_ap * ac_cp;
  if (to_b <= 0 && ac_ap >= 0 && ac_cp <= 0) {
    return {a + (ac_ap / (ac_ap - ac_cp)) * ac, TriangleFeature::edge_ca};
  }
  const Real to_a = ab_bp * ac_cp - ab_cp * ac_bp;
  const Real from_b = ac_bp - ab_bp, from_c = ab_cp - ac_cp;
  if (to_a <= 0 && from_b >= 0 && from_c >= 0) {
    return {b + (from_b / (from_b + from_c)) * (c - b), TriangleFeature::edge_bc};
  }
  const Real scale = 1 / (to_a + to_b + to_c);
  return {a + (to_b * scale) * ab + (to_c * scale) * ac, TriangleFeature::face};
}

// Barycentric coordinates of the point of the triangle's plane nearest to p, of a, b and c; they add up to 1. A triangle without
// area has none: 1 for its corner nearest to p.
inline std::array<Real, 3> barycentric(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a, n = cross(ab, ac);
  const Real nn = squared_norm(n);
  if (!(nn > 0)) {
    const Real la = squared_norm(p - a), lb = squared_norm(p - b), lc = squared_norm(p - c);
    if (la <= lb && la <= lc) return {1, 0, 0};
    return lb <= lc ? std::array<Real, 3>{0, 1, 0} : std::array<Real, 3>{0, 0, 1};
  }
  const Real v = dot(cross(ap, ac), n) / nn, w = dot(cross(ab, ap), n) / nn;
  return {1 - v - w, v, w};
}

}  // namespace imbibe
