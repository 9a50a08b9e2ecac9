#include "imbibe/geometry/sweep.h"

#include <algorithm>

#include "imbibe/geometry/direction.h"

namespace imbibe {
namespace {

constexpr Real never = std::numeric_limits<Real>::infinity();

// Adds the time span of a convex part to that of the union (the capsule is one convex body made of three).
void merge(std::optional<TimeSpan>& all, const TimeSpan& part) {
  if (!all) all = part;
  all->enter = std::min(all->enter, part.enter);
  all->leave = std::max(all->leave, part.leave);
}

// Keeps the part of [enter, leave] where offset + t * slope >= 0.
bool clip_half_space(TimeSpan& span, Real offset, Real slope) {
  if (slope == 0) return offset >= 0;
  const Real t = -offset / slope;
  if (slope > 0) span.enter = std::max(span.enter, t);
  else span.leave = std::min(span.leave, t);
  return span.enter <= span.leave;
}

}  // namespace

std::optional<TimeSpan> cross_ball(const Vec3& from, const Vec3& step, const Vec3& centre, Real radius) {
  const Real step_squared = squared_norm(step);
  const Vec3 to_start = from - centre;
  if (!(step_squared > 0)) {
    if (squared_norm(to_start) > radius * radius) return std::nullopt;
    return TimeSpan{-never, never};
  }
  const Real nearest = -dot(to_start, step) / step_squared;
  const Real room = radius * radius - squared_norm(to_start + nearest * step);
  if (room < 0) return std::nullopt;
  const Real half = std::sqrt(room / step_squared);
  return TimeSpan{nearest - half, nearest + half};
}

std::optional<TimeSpan> cross_capsule(const Vec3& from, const Vec3& step, const Vec3& a, const Vec3& b, Real radius) {
  std::optional<TimeSpan> all = cross_ball(from, step, a, radius);
  if (const auto ball = cross_ball(from, step, b, radius)) merge(all, *ball);
  const Vec3 along = b - a;
  const Real length = norm(along);
  if (!(length > 0)) return all;
  // The round side: a ball in the plane across the axis, kept where the axis is beside it.
  const Vec3 axis = along / length;
  const Vec3 start = from - a;
  const Real start_along = dot(start, axis), step_along = dot(step, axis);
  auto side = cross_ball(start - start_along * axis, step - step_along * axis, {}, radius);
  if (!side) return all;
  if (!clip_half_space(*side, start_along, step_along)) return all;
  if (!clip_half_space(*side, length - start_along, -step_along)) return all;
  merge(all, *side);
  return all;
}

std::optional<SweepHit> sweep_capsule(const Vec3& p0, const Vec3& p1, Real reach, const Vec3& a, const Vec3& b,
                                      Real radius) {
  const auto span = cross_capsule(p0, p1 - p0, a, b, radius + reach);
  if (!span || span->enter > 1 || span->leave < 0) return std::nullopt;
  const Real t = std::max(Real(0), span->enter);
  const Vec3 at = p0 + t * (p1 - p0);
  const Vec3 away = at - closest_on_segment(at, a, b).point;
  return SweepHit{t, squared_norm(away) > 0 ? normalized(away) : any_perpendicular(b - a)};
}

std::optional<Real> cross_triangle(const Vec3& p0, const Vec3& p1, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 step = p1 - p0;
  const Vec3 pa = a - p0, pb = b - p0, pc = c - p0;
  // Volumes of the tetrahedra of the path and each edge: all of one sign where the line goes through.
  const Real ab = dot(step, cross(pa, pb)), bc = dot(step, cross(pb, pc)), ca = dot(step, cross(pc, pa));
  if (!((ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0))) return std::nullopt;
  const Vec3 normal = cross(b - a, c - a);
  const Real speed = dot(step, normal);
  if (speed == 0) return std::nullopt;  // along the plane: it has no side to come from
  const Real t = dot(pa, normal) / speed;
  if (!(t >= 0 && t <= 1)) return std::nullopt;
  return t;
}

std::optional<TimeSpan> cross_prism(const Vec3& from, const Vec3& step, const Vec3& a, const Vec3& b, const Vec3& c,
                                    Real above, Real below, Real slack) {
  const Vec3 normal = normalized(cross(b - a, c - a));
  const Real height = dot(from - a, normal), rise = dot(step, normal);
  TimeSpan span{0, 1};
  if (!clip_half_space(span, above - height, -rise) || !clip_half_space(span, height + below, rise)) {
    return std::nullopt;
  }
  const Vec3* corners[] = {&a, &b, &c};
  for (int k = 0; k < 3; ++k) {
    const Vec3& start = *corners[k];
    const Vec3 inward = normalized(cross(normal, *corners[(k + 1) % 3] - start));
    if (!clip_half_space(span, dot(from - start, inward) + slack, dot(step, inward))) return std::nullopt;
  }
  return span;
}

std::optional<SweepHit> sweep_triangle(const Vec3& p0, const Vec3& p1, Real reach, const Vec3& a, const Vec3& b,
                                       const Vec3& c) {
  const Vec3 step = p1 - p0;
  std::optional<TimeSpan> all;
  if (norm(cross(b - a, c - a)) > 0) all = cross_prism(p0, step, a, b, c, reach, reach, 0);
  const Vec3* corners[] = {&a, &b, &c};
  for (int k = 0; k < 3; ++k) {
    const auto edge = cross_capsule(p0, step, *corners[k], *corners[(k + 1) % 3], reach);
    if (edge && edge->enter <= 1 && edge->leave >= 0) merge(all, *edge);
  }
  if (!all) return std::nullopt;
  const Real t = std::max(Real(0), all->enter);
  const Vec3 at = p0 + t * step;
  const Vec3 away = at - closest_on_triangle(at, a, b, c).point;
  if (squared_norm(away) > 0) return SweepHit{t, normalized(away)};
  const Vec3 normal = normalized(cross(b - a, c - a));
  return SweepHit{t, dot(normal, step) > 0 ? -normal : normal};
}

}  // namespace imbibe
