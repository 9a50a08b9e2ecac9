#include "imbibe/view/shape_mesh.h"

#include <gtest/gtest.h>

#include <cmath>

#include "imbibe/geometry/mesh_distance.h"
#include "support/meshes.h"

namespace imbibe {
namespace {

struct Sums {
  Real volume = 0, area = 0;
  Real least_agreement = 1;  // of a vertex's normal with that of a triangle at it
};

Sums sums_of(const DrawnMesh& mesh) {
  Sums s;
  for (const auto& t : mesh.triangles) {
    const Vec3 a(mesh.vertices[t[0]]), b(mesh.vertices[t[1]]), c(mesh.vertices[t[2]]), twice = cross(b - a, c - a);
    s.volume += dot(a, cross(b, c)) / 6;
    s.area += norm(twice) / 2;
    if (mesh.normals.empty() || norm(twice) < 1e-12) continue;  // at a pole or an apex
    for (const Index v : t) s.least_agreement = std::min(s.least_agreement, dot(Vec3(mesh.normals[v]), normalized(twice)));
  }
  return s;
}

// Drawn with 96 faces round a circle: an inscribed polygon of them lacks 7e-4 of the circle's area, a sphere twice that.
constexpr Real faceted = 2e-3;

void expect_closed(const Shape& shape, Real volume, Real area) {
  const Sums s = sums_of(mesh_of(shape));
  EXPECT_NEAR(s.volume, volume, faceted * volume);  // outward triangles all around, or it would not be
  EXPECT_NEAR(s.area, area, faceted * area);
  EXPECT_GT(s.least_agreement, 0.9);
}

TEST(ShapeMesh, OfEachSolidIsClosedHasItsVolumeAndItsNormalsPointOutward) {
  expect_closed(Box{{1, 2, 3}, {2, 3, 4}}, 24, 2 * (6 + 8 + 12));
  expect_closed(Sphere{{1, -1, 2}, 2}, 4.0 / 3 * pi * 8, 4 * pi * 4);
  expect_closed(Cylinder{{1, 0, -1}, normalized(Vec3{1, 2, 2}), 0.5, 3}, pi * 0.25 * 3, pi * 3 + 2 * pi * 0.25);
  expect_closed(Cone{{0, 1, 0}, normalized(Vec3{0, 1, 1}), 1.5, 2}, pi * 2.25 * 2 / 3, pi * 1.5 * 2.5 + pi * 2.25);
}

TEST(ShapeMesh, OfAMeshIsTheMeshAndAPlaneHasNone) {
  const auto box = std::make_shared<const MeshDistance>(testing::box_mesh({1, 2, 3}));
  EXPECT_NEAR(sums_of(mesh_of(MeshShape{box})).volume, 48, 1e-4);  // single-precision vertices
  EXPECT_TRUE(mesh_of(Plane{}).triangles.empty());
}

}  // namespace
}  // namespace imbibe
