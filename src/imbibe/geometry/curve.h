// Centre lines: open polylines of points. Lengths, points at a length, nearest points, frames that do not twist.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "imbibe/core/types.h"
#include "imbibe/geometry/closest.h"

namespace imbibe {

inline Real curve_length(std::span<const Vec3> points) {
  Real length = 0;
  for (std::size_t i = 1; i < points.size(); ++i) length += norm(points[i] - points[i - 1]);
  return length;
}

// Arc length from the first point to each point; as many values as points.
inline std::vector<Real> arc_lengths(std::span<const Vec3> points) {
  std::vector<Real> lengths(points.size());
  for (std::size_t i = 1; i < points.size(); ++i) lengths[i] = lengths[i - 1] + norm(points[i] - points[i - 1]);
  return lengths;
}

// The point at arc length s, held at the ends.
inline Vec3 point_at_length(std::span<const Vec3> points, std::span<const Real> lengths, Real s) {
  const auto after = std::upper_bound(lengths.begin(), lengths.end(), s);
  if (after == lengths.begin()) return points.front();
  if (after == lengths.end()) return points.back();
  const auto i = static_cast<std::size_t>(after - lengths.begin());
  const Real t = (s - lengths[i - 1]) / (lengths[i] - lengths[i - 1]);
  return points[i - 1] + t * (points[i] - points[i - 1]);
}

// Unit tangent at point i: along the chord of its neighbours, one-sided at the ends.
inline Vec3 tangent_at(std::span<const Vec3> points, std::size_t i) {
  const std::size_t before = i > 0 ? i - 1 : 0, after = std::min(i + 1, points.size() - 1);
  return normalized(points[after] - points[before]);
}

struct CurvePoint {
  Vec3 point{};
  std::size_t piece = 0;  // between points[piece] and points[piece + 1]
  Real parameter = 0;     // 0..1 in the piece
  Real squared_distance = std::numeric_limits<Real>::infinity();
};

// The point of the curve nearest to p; of equal ones the first.
inline CurvePoint closest_on_curve(std::span<const Vec3> points, const Vec3& p) {
  CurvePoint best;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const SegmentPoint near = closest_on_segment(p, points[i], points[i + 1]);
    const Real squared = squared_norm(p - near.point);
    if (squared < best.squared_distance) best = {near.point, i, near.parameter, squared};
  }
  return best;
}

// Two unit vectors across a curve's tangent.
struct CrossFrame {
  Vec3 side{}, up{};
};

// For a curve that lies in the plane of `plane_normal` (a crimped yarn in a flat sheet) or near it: side = that normal
// made orthogonal to the tangent. Needs no history along the curve, so any piece of it gives the same frame.
inline CrossFrame frame_beside(const Vec3& tangent, const Vec3& plane_normal) {
  const Vec3 side = normalized(plane_normal - dot(plane_normal, tangent) * tangent);
  return {side, cross(tangent, side)};
}

}  // namespace imbibe
