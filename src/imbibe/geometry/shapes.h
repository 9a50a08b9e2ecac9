// Fixed solids as signed-distance shapes: plane, box, sphere, cylinder, cone, closed mesh.
#pragma once

#include <array>
#include <memory>
#include <variant>

#include "imbibe/core/types.h"

namespace imbibe {

// The surface point nearest to a query point, seen from outside the solid.
struct SurfaceSample {
  Real distance = 0;  // m, < 0 inside the solid
  Vec3 normal{};      // unit, out of the solid at the nearest point
};

struct Plane { Vec3 point{}; Vec3 normal{0, 0, 1}; };                   // solid below, normal points to the liquid
struct Box {
  Vec3 centre{}, size{1, 1, 1};
  std::array<Vec3, 3> axes{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};  // unit, square to each other; size along each
  Vec3 from_centre(const Vec3& p) const { return {dot(p - centre, axes[0]), dot(p - centre, axes[1]), dot(p - centre, axes[2])}; }
  Vec3 to_world(const Vec3& direction) const { return direction.x * axes[0] + direction.y * axes[1] + direction.z * axes[2]; }
};
struct Sphere { Vec3 centre{}; Real radius = 1; };
struct Cylinder { Vec3 base{}; Vec3 axis{0, 0, 1}; Real radius = 1; Real height = 1; };  // axis: unit
struct Cone { Vec3 base{}; Vec3 axis{0, 0, 1}; Real radius = 1; Real height = 1; };      // apex at base + height*axis
class MeshDistance;                                                     // closed triangle mesh with its hierarchy
using MeshShape = std::shared_ptr<const MeshDistance>;

using Shape = std::variant<Plane, Box, Sphere, Cylinder, Cone, MeshShape>;

SurfaceSample nearest_surface(const Shape& shape, const Vec3& point);

// Bounds of the solid's surface; a plane has none (infinite).
struct Bounds;
Bounds bounds_of(const Shape& shape);

}  // namespace imbibe
