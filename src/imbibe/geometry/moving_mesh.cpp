#include "imbibe/geometry/moving_mesh.h"

#include <algorithm>

#include "imbibe/core/parallel.h"

namespace imbibe {
namespace {

constexpr Real slack = 1e-9;  // of weights: far above their rounding, far below any triangle
// cos 45 deg: a point over a convex fold leans by up to half the fold's turn, at most 45 deg where two triangles stand
// square to each other; beside an outline it leans by up to 90 deg.
constexpr Real border_cosine = 0.7;

struct Cubic {
  std::array<Real, 4> c{};
  Real operator()(Real t) const { return c[0] + t * (c[1] + t * (c[2] + t * c[3])); }
};

// (p - a).((b - a) x (c - a)) with p, a, b, c straight in t.
Cubic plane_function(const Vec3& p0, const Vec3& p1, const std::array<Vec3, 3>& s, const std::array<Vec3, 3>& e) {
  const Vec3 p = p0 - s[0], dp = (p1 - p0) - (e[0] - s[0]);
  const Vec3 u = s[1] - s[0], du = (e[1] - s[1]) - (e[0] - s[0]);
  const Vec3 v = s[2] - s[0], dv = (e[2] - s[2]) - (e[0] - s[0]);
  const Vec3 n0 = cross(u, v), n1 = cross(du, v) + cross(u, dv), n2 = cross(du, dv);
  return {{dot(p, n0), dot(p, n1) + dot(dp, n0), dot(p, n2) + dot(dp, n1), dot(dp, n2)}};
}

// The extrema of f inside (0, 1), rising.
int extrema(const Cubic& f, std::array<Real, 2>& at) {
  const Real a = 3 * f.c[3], b = 2 * f.c[2], c = f.c[1];
  int count = 0;
  const auto add = [&](Real t) {
    if (t > 0 && t < 1 && count < 2) at[static_cast<std::size_t>(count++)] = t;
  };
  const Real square = b * b - 4 * a * c;
  if (square < 0) return 0;
  // Stable form: the larger root first, the other from the product of both.
  const Real q = -0.5 * (b + std::copysign(std::sqrt(square), b));
  if (a != 0) add(q / a);
  if (q != 0) add(c / q);
  if (count == 2 && at[0] > at[1]) std::swap(at[0], at[1]);
  return count;
}

Real root_between(const Cubic& f, Real low, Real high) {
  const bool rising = f(high) > f(low);
  for (int i = 0; i < 60; ++i) {
    const Real middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) break;
    ((f(middle) < 0) == rising ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

Vec3 between(const Vec3& a, const Vec3& b, Real t) { return a + t * (b - a); }

Bounds box_of(const MovingMesh& m, std::size_t triangle, bool whole_way) {
  Bounds b;
  for (const Index v : m.mesh.triangles[triangle]) {
    b.include(m.mesh.vertices[v]);
    if (whole_way) b.include(m.start[v]);
  }
  return b;
}

void set_boxes(MovingMesh& m, BoxHierarchy& tree, bool whole_way, bool build) {
  m.boxes.resize(m.mesh.triangles.size());
  parallel_for(m.boxes.size(), [&](std::size_t t) { m.boxes[t] = box_of(m, t, whole_way); });
  if (build) tree = build_hierarchy(m.boxes);
  else refit(tree, m.boxes);
}

}  // namespace

std::optional<MovingCrossing> cross_moving_triangle(const Vec3& p0, const Vec3& p1, const std::array<Vec3, 3>& start,
                                                    const std::array<Vec3, 3>& end) {
  const Cubic f = plane_function(p0, p1, start, end);
  std::array<Real, 2> at{};
  const int turns = extrema(f, at);
  Real low = 0;
  for (int piece = 0; piece <= turns; ++piece) {
    const Real high = piece < turns ? at[static_cast<std::size_t>(piece)] : 1;
    const Real f_low = f(low), f_high = f(high);
    if ((f_low < 0 && f_high >= 0) || (f_low > 0 && f_high <= 0)) {
      const Real t = root_between(f, low, high);
      const Vec3 p = between(p0, p1, t), a = between(start[0], end[0], t), b = between(start[1], end[1], t),
                 c = between(start[2], end[2], t);
      const std::array<Real, 3> w = barycentric(p, a, b, c);
      if (w[0] >= -slack && w[1] >= -slack && w[2] >= -slack) {
        MovingCrossing hit;
        hit.time_fraction = t;
        hit.at.weight = w;
        hit.normal = normalized(cross(b - a, c - a)) * (f_low > 0 ? 1.0 : -1.0);
        return hit;
      }
    }
    low = high;
  }
  return std::nullopt;
}

void set_step(MovingMesh& m, std::span<const Vec3> start, std::span<const Vec3> end,
              std::span<const std::array<Index, 3>> triangles) {
  const bool build = m.swept.empty() || !std::equal(m.mesh.triangles.begin(), m.mesh.triangles.end(), triangles.begin(),
                                                    triangles.end());
  m.start.assign(start.begin(), start.end());
  m.mesh.vertices.assign(end.begin(), end.end());
  if (build) m.mesh.triangles.assign(triangles.begin(), triangles.end());
  set_boxes(m, m.swept, true, build);
  set_boxes(m, m.at_end, false, build);
}

std::optional<MovingCrossing> first_crossing(const MovingMesh& m, const Vec3& p0, const Vec3& p1) {
  std::optional<MovingCrossing> best;
  Real latest = 1;
  QueryCounts counts;
  // The boxes hold the whole way of their triangles: one entered after the best hit cannot hold an earlier one.
  visit_swept(m.swept, p0, p1 - p0, 1e-12, latest, counts, [&](Index t) {
    const auto& v = m.mesh.triangles[t];
    std::optional<MovingCrossing> hit = cross_moving_triangle(
        p0, p1, {m.start[v[0]], m.start[v[1]], m.start[v[2]]},
        {m.mesh.vertices[v[0]], m.mesh.vertices[v[1]], m.mesh.vertices[v[2]]});
    if (!hit) return;
    if (best && (hit->time_fraction > best->time_fraction ||
                 (hit->time_fraction == best->time_fraction && t > best->at.triangle)))
      return;
    hit->at.triangle = t;
    best = hit;
    latest = hit->time_fraction;
  });
  return best;
}

NearestOnSheet nearest_on(const MovingMesh& m, const Vec3& p, Real limit) {
  NearestOnSheet n;
  MeshPoint near;
  Real best = limit * limit;
  QueryCounts counts;
  visit_nearest(m.at_end, p, best, counts, [&](Index t) {
    const TrianglePoint at = closest_on_triangle(p, m.mesh.corner(t, 0), m.mesh.corner(t, 1), m.mesh.corner(t, 2));
    const Real square = squared_norm(p - at.point);
    if (square > best || (square == near.squared_distance && t > near.triangle)) return;
    best = square;
    near = {t, at.feature, at.point, square};
  });
  if (near.triangle == no_index) return n;
  const auto& v = m.mesh.triangles[near.triangle];
  const Vec3 &a = m.mesh.vertices[v[0]], &b = m.mesh.vertices[v[1]], &c = m.mesh.vertices[v[2]];
  n.at.triangle = near.triangle;
  n.at.weight = barycentric(near.point, a, b, c);
  n.point = near.point;
  n.distance = std::sqrt(near.squared_distance);
  const Vec3 own = normalized(cross(b - a, c - a)), away = p - near.point;
  n.side = dot(away, own) < 0 ? -1 : 1;
  n.normal = n.distance > 1e-9 ? away / n.distance : n.side * own;
  // Beside the sheet: the nearest point is on an edge or corner and the way to it leans out of the triangle's normal by
  // more than the fold between two triangles would.
  n.on_border = near.feature != TriangleFeature::face && std::abs(dot(n.normal, own)) < border_cosine;
  return n;
}

}  // namespace imbibe
