// Exact signed distances. Outside, the nearest point may lie on a face, an edge or a corner: the distance there is that
// to the edge or corner (rounded level sets), not to the planes through it.
#include "imbibe/geometry/shapes.h"

#include <array>
#include <span>

#include "imbibe/core/portable.h"
#include "imbibe/geometry/bounds.h"
#include "imbibe/geometry/mesh_distance.h"

namespace imbibe {
namespace {

constexpr Real far = Bounds::unlimited_length;

SurfaceSample nearest_on(const Plane& plane, const Vec3& p) {
  return {dot(p - plane.point, plane.normal), plane.normal};
}

SurfaceSample nearest_on(const Sphere& sphere, const Vec3& p) {
  const Vec3 away = p - sphere.centre;
  const Real r = norm(away);
  return {r - sphere.radius, r > 0 ? away / r : Vec3{0, 0, 1}};
}

SurfaceSample nearest_on(const Box& box, const Vec3& p) {
  const Vec3 d = box.from_centre(p);
  const Vec3 side{std::copysign(1.0, d.x), std::copysign(1.0, d.y), std::copysign(1.0, d.z)};
  const Vec3 over{std::abs(d.x) - 0.5 * box.size.x, std::abs(d.y) - 0.5 * box.size.y,
                  std::abs(d.z) - 0.5 * box.size.z};
  const Vec3 out{std::max(over.x, 0.0), std::max(over.y, 0.0), std::max(over.z, 0.0)};
  const Real distance = norm(out);
  if (distance > 0) return {distance, box.to_world({side.x * out.x, side.y * out.y, side.z * out.z}) / distance};
  if (over.x >= over.y && over.x >= over.z) return {over.x, side.x * box.axes[0]};
  if (over.y >= over.z) return {over.y, side.y * box.axes[1]};
  return {over.z, side.z * box.axes[2]};
}

// A point or direction in the half-plane of a solid of revolution: across = distance from the axis, along = height.
struct HalfPlane {
  Real across = 0, along = 0;
};

// Signed distance and outward normal of a convex profile, whose corners run from the axis outwards and up back to it.
SurfaceSample nearest_on_profile(std::span<const HalfPlane> corners, const HalfPlane& p, HalfPlane& normal) {
  Real inside = -far, outside = far;
  HalfPlane inside_normal, outside_normal;
  for (std::size_t k = 0; k + 1 < corners.size(); ++k) {
    const HalfPlane &a = corners[k], &b = corners[k + 1];
    const HalfPlane side{b.across - a.across, b.along - a.along}, from{p.across - a.across, p.along - a.along};
    const Real length = portable::hypot(side.across, side.along);
    const HalfPlane out{side.along / length, -side.across / length};
    const Real height = from.across * out.across + from.along * out.along;
    if (height > inside) inside = height, inside_normal = out;
    const Real t = std::clamp((from.across * side.across + from.along * side.along) / (length * length), 0.0, 1.0);
    const HalfPlane gap{from.across - t * side.across, from.along - t * side.along};
    const Real distance = portable::hypot(gap.across, gap.along);
    if (distance < outside) {
      outside = distance;
      // Beside the face (or on it): its own normal, free of rounding. Past an end: away from the corner.
      outside_normal = t > 0 && t < 1 ? out : HalfPlane{gap.across / distance, gap.along / distance};
      if (distance == 0) outside_normal = out;
    }
  }
  normal = inside <= 0 ? inside_normal : outside_normal;
  return {inside <= 0 ? inside : outside, {}};
}

// The unit vector from the axis towards p; on the axis, any at right angles to it.
Vec3 radial_direction(const Vec3& across, const Vec3& axis) {
  if (squared_norm(across) > 0) return normalized(across);
  return normalized(cross(axis, std::abs(axis.x) < 0.5 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
}

SurfaceSample nearest_on_revolved(std::span<const HalfPlane> corners, const Vec3& base, const Vec3& axis,
                                  const Vec3& p) {
  const Vec3 d = p - base;
  const Real along = dot(d, axis);
  const Vec3 across = d - along * axis;
  HalfPlane normal;
  SurfaceSample sample = nearest_on_profile(corners, {norm(across), along}, normal);
  sample.normal = normalized(normal.across * radial_direction(across, axis) + normal.along * axis);
  return sample;
}

SurfaceSample nearest_on(const Cylinder& c, const Vec3& p) {
  const std::array<HalfPlane, 4> corners{{{0, 0}, {c.radius, 0}, {c.radius, c.height}, {0, c.height}}};
  return nearest_on_revolved(corners, c.base, c.axis, p);
}

SurfaceSample nearest_on(const Cone& c, const Vec3& p) {
  const std::array<HalfPlane, 3> corners{{{0, 0}, {c.radius, 0}, {0, c.height}}};
  return nearest_on_revolved(corners, c.base, c.axis, p);
}

SurfaceSample nearest_on(const MeshShape& mesh, const Vec3& p) { return mesh->nearest(p); }

Bounds bounds_on(const Plane&) {
  Bounds all;
  all.lower = {-far, -far, -far}, all.upper = {far, far, far};
  return all;
}

Bounds bounds_on(const Box& box) {
  const auto reach = [&](auto component) {
    return 0.5 * (std::abs(component(box.axes[0])) * box.size.x + std::abs(component(box.axes[1])) * box.size.y +
                  std::abs(component(box.axes[2])) * box.size.z);
  };
  const Vec3 half{reach([](const Vec3& a) { return a.x; }), reach([](const Vec3& a) { return a.y; }),
                  reach([](const Vec3& a) { return a.z; })};
  return {box.centre - half, box.centre + half};
}

Bounds bounds_on(const Sphere& s) {
  const Vec3 r{s.radius, s.radius, s.radius};
  return {s.centre - r, s.centre + r};
}

// A disc reaches radius * sin(angle between its axis and the coordinate direction) along that direction.
void include_disc(Bounds& bounds, const Vec3& centre, const Vec3& axis, Real radius) {
  const auto reach = [&](Real cosine) { return radius * std::sqrt(std::max(0.0, 1 - cosine * cosine)); };
  const Vec3 r{reach(axis.x), reach(axis.y), reach(axis.z)};
  bounds.include(centre - r);
  bounds.include(centre + r);
}

Bounds bounds_on(const Cylinder& c) {
  Bounds bounds;
  include_disc(bounds, c.base, c.axis, c.radius);
  include_disc(bounds, c.base + c.height * c.axis, c.axis, c.radius);
  return bounds;
}

Bounds bounds_on(const Cone& c) {
  Bounds bounds;
  include_disc(bounds, c.base, c.axis, c.radius);
  bounds.include(c.base + c.height * c.axis);
  return bounds;
}

Bounds bounds_on(const MeshShape& mesh) { return mesh->bounds(); }

}  // namespace

SurfaceSample nearest_surface(const Shape& shape, const Vec3& point) {
  return std::visit([&](const auto& s) { return nearest_on(s, point); }, shape);
}

Bounds bounds_of(const Shape& shape) {
  return std::visit([](const auto& s) { return bounds_on(s); }, shape);
}

}  // namespace imbibe
