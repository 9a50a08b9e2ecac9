// Earliest contact of a point moving in a straight line with fixed pieces. The moving point is the centre of a sphere
// of radius `reach`; 0 = the point itself. Times are fractions of the path p0 -> p1. Pure functions.
#pragma once

#include <optional>

#include "imbibe/core/types.h"
#include "imbibe/geometry/closest.h"

namespace imbibe {

// Where a moving point first comes within `reach` of a piece.
struct SweepHit {
  Real time_fraction = 0;  // in [0, 1]; 0 also when it starts within reach
  Vec3 normal{};           // unit, from the piece towards the moving point
};

// The path from + t * step through a ball: entered at `enter`, left at `leave` (any real numbers; none: nullopt).
// Solved around the time of closest approach, where nothing cancels even for paths much longer than the ball.
struct TimeSpan {
  Real enter = 0, leave = 0;
};
std::optional<TimeSpan> cross_ball(const Vec3& from, const Vec3& step, const Vec3& centre, Real radius);

// The path through a capsule: all points nearer than `radius` to the segment a-b. A capsule is convex, so a line
// enters it once and leaves it once.
std::optional<TimeSpan> cross_capsule(const Vec3& from, const Vec3& step, const Vec3& a, const Vec3& b, Real radius);

// First contact with a capsule of radius `radius` by a sphere of radius `reach`, from outside or from within.
std::optional<SweepHit> sweep_capsule(const Vec3& p0, const Vec3& p1, Real reach, const Vec3& a, const Vec3& b,
                                      Real radius);

// The time at which the path crosses the triangle, from either side. Triangles that share an edge leave no gap: a path
// through the edge crosses at least one of them, since their edge tests are exact opposites.
std::optional<Real> cross_triangle(const Vec3& p0, const Vec3& p1, const Vec3& a, const Vec3& b, const Vec3& c);

// The path through the prism over a triangle: points whose projection lies inside the triangle and whose signed
// distance from its plane (positive outside) lies in [-below, above]. The sides lean out by `slack` metres, so that a
// path along a shared edge is in one prism at least.
std::optional<TimeSpan> cross_prism(const Vec3& from, const Vec3& step, const Vec3& a, const Vec3& b, const Vec3& c,
                                    Real above, Real below, Real slack);

// First contact of a sphere of radius `reach` with a triangle, its edges and corners rounded: the exact form.
std::optional<SweepHit> sweep_triangle(const Vec3& p0, const Vec3& p1, Real reach, const Vec3& a, const Vec3& b,
                                       const Vec3& c);

}  // namespace imbibe
