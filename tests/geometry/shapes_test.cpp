#include "imbibe/geometry/shapes.h"

#include <gtest/gtest.h>

#include <functional>
#include <memory>

#include "imbibe/geometry/bounds.h"
#include "imbibe/geometry/mesh_distance.h"
#include "imbibe/geometry/sampling.h"
#include "imbibe/geometry/shape_spec.h"
#include "support/meshes.h"

namespace imbibe {
namespace {

struct ShapeCase {
  const char* name;
  Shape shape;
  std::function<bool(const Vec3&)> inside;  // by its definition, no distance involved
};

std::vector<ShapeCase> all_shapes() {
  const Vec3 axis = normalized(Vec3{1, 2, 2});
  const auto in_round = [=](const Vec3& p, const std::function<Real(Real)>& radius_at) {
    const Real z = dot(p, axis), r = norm(p - z * axis);
    return z >= 0 && z <= 1 && r <= radius_at(z);
  };
  const Vec3 tilt = normalized(Vec3{0.2, -0.3, 1});
  const Vec3 u = normalized(Vec3{2, 1, -0.5}), v = normalized(cross(tilt, u)), n = cross(u, v);
  return {
      {"plane", Plane{{0, 0, 0.2}, tilt}, [=](const Vec3& p) { return dot(p - Vec3{0, 0, 0.2}, tilt) <= 0; }},
      {"box", Box{{0.1, 0, 0}, {1, 0.6, 1.4}},
       [](const Vec3& p) { return std::abs(p.x - 0.1) <= 0.5 && std::abs(p.y) <= 0.3 && std::abs(p.z) <= 0.7; }},
      {"turned_box", Box{{0.1, 0, 0}, {1, 0.6, 1.4}, {u, v, n}},
       [=](const Vec3& p) {
         const Vec3 from = p - Vec3{0.1, 0, 0};
         return std::abs(dot(from, u)) <= 0.5 && std::abs(dot(from, v)) <= 0.3 && std::abs(dot(from, n)) <= 0.7;
       }},
      {"sphere", Sphere{{0, 0.1, 0}, 0.8}, [](const Vec3& p) { return norm(p - Vec3{0, 0.1, 0}) <= 0.8; }},
      {"cylinder", Cylinder{{}, axis, 0.5, 1}, [=](const Vec3& p) { return in_round(p, [](Real) { return 0.5; }); }},
      {"cone", Cone{{}, axis, 0.7, 1}, [=](const Vec3& p) { return in_round(p, [](Real z) { return 0.7 * (1 - z); }); }},
      {"mesh", std::make_shared<const MeshDistance>(testing::box_mesh({0.5, 0.3, 0.7})),
       [](const Vec3& p) { return std::abs(p.x) <= 0.5 && std::abs(p.y) <= 0.3 && std::abs(p.z) <= 0.7; }},
  };
}

Vec3 random_point(std::uint64_t id) {
  return random_in({{-2, -2, -2}, {2, 2, 2}}, {.seed = 51, .id = id, .step = 0});
}

class Shapes : public ::testing::TestWithParam<ShapeCase> {};

TEST_P(Shapes, TheSignTellsInsideFromOutside) {
  int inside = 0;
  for (std::uint64_t id = 0; id < 3000; ++id) {
    const Vec3 p = 0.6 * random_point(id);
    const SurfaceSample s = nearest_surface(GetParam().shape, p);
    if (std::abs(s.distance) < 1e-12) continue;
    EXPECT_EQ(s.distance < 0, GetParam().inside(p)) << id;
    inside += s.distance < 0;
  }
  EXPECT_GT(inside, 100);
}

TEST_P(Shapes, TheFootOfEveryPointLiesOnTheSurfaceAndNoPointOfTheOtherSideIsNearer) {
  for (std::uint64_t id = 0; id < 300; ++id) {
    const Vec3 p = random_point(id);
    const SurfaceSample s = nearest_surface(GetParam().shape, p);
    EXPECT_NEAR(norm(s.normal), 1, 1e-12);
    const Vec3 foot = p - s.distance * s.normal;
    // Just beyond and just before the foot lie the two sides (unless the foot is an edge seen from inside).
    EXPECT_NEAR(nearest_surface(GetParam().shape, foot).distance, 0, 1e-12) << id;
    if (s.distance > 0) {
      for (const Vec3& d : directions_on_sphere(60)) {
        EXPECT_FALSE(GetParam().inside(p + 0.999999 * s.distance * d)) << id;
      }
    } else {
      for (const Vec3& d : directions_on_sphere(60)) {
        EXPECT_TRUE(GetParam().inside(p - 0.999999 * s.distance * d)) << id;
      }
    }
  }
}

TEST_P(Shapes, TheNormalIsTheGradientOfTheDistance) {
  const Real h = 1e-6;
  int smooth = 0;
  for (std::uint64_t id = 0; id < 300; ++id) {
    const Vec3 p = random_point(id);
    const auto d = [&](const Vec3& shift) { return nearest_surface(GetParam().shape, p + shift).distance; };
    const Vec3 gradient{(d({h, 0, 0}) - d({-h, 0, 0})) / (2 * h), (d({0, h, 0}) - d({0, -h, 0})) / (2 * h),
                        (d({0, 0, h}) - d({0, 0, -h})) / (2 * h)};
    if (std::abs(norm(gradient) - 1) > 1e-3) continue;  // on the ridge inside, where two faces are as near
    ++smooth;
    // Central differences: curvature / distance times h^2, and rounding / h.
    EXPECT_NEAR(norm(gradient - nearest_surface(GetParam().shape, p).normal), 0, 1e-6) << id;
  }
  EXPECT_GT(smooth, 290);
}

TEST_P(Shapes, TheBoundsTouchTheSolidOnAllSixSides) {
  const Bounds bounds = bounds_of(GetParam().shape);
  if (std::isinf(bounds.upper.x)) return;
  Bounds sampled;  // of the feet of many points: dense on every side
  for (std::uint64_t id = 0; id < 20000; ++id) {
    const Vec3 p = random_point(id);
    const SurfaceSample s = nearest_surface(GetParam().shape, p);
    const Vec3 foot = p - s.distance * s.normal;
    sampled.include(foot);
  }
  EXPECT_NEAR(norm(sampled.lower - bounds.lower), 0, 0.02);  // rounded sides are sampled at 0.1 spacing: sagitta 0.01
  EXPECT_NEAR(norm(sampled.upper - bounds.upper), 0, 0.02);
  EXPECT_GE(sampled.lower.x, bounds.lower.x - 1e-12);
  EXPECT_LE(sampled.upper.z, bounds.upper.z + 1e-12);
}

INSTANTIATE_TEST_SUITE_P(AllKinds, Shapes, ::testing::ValuesIn(all_shapes()),
                         [](const auto& shape) { return shape.param.name; });

TEST(Shapes, APlaneHasNoBounds) {
  const Bounds bounds = bounds_of(Plane{});
  EXPECT_TRUE(std::isinf(bounds.upper.z) && std::isinf(bounds.lower.x));
}

TEST(Shapes, PointsOnAnAxisOrAnApexGetAUnitNormal) {
  const Cone cone{{}, {0, 0, 1}, 1, 1};
  const Cylinder cylinder{{}, {0, 0, 1}, 0.1, 1};
  for (const Vec3& p : {Vec3{0, 0, 0.5}, Vec3{0, 0, 1}, Vec3{0, 0, 0}, Vec3{0, 0, 3}, Vec3{0, 0, -1}}) {
    for (const Shape& shape : {Shape{cone}, Shape{cylinder}, Shape{Sphere{p, 1}}, Shape{Box{p, {1, 1, 1}}}}) {
      const SurfaceSample s = nearest_surface(shape, p);
      EXPECT_NEAR(norm(s.normal), 1, 1e-12);
      EXPECT_TRUE(std::isfinite(s.distance));
    }
  }
}

TEST(MeshDistance, ATorusIsSignedRightInItsHoleAndInItsTube) {
  const MeshDistance torus(testing::torus_mesh(2, 0.5, 96, 48));
  int inside = 0;
  for (std::uint64_t id = 0; id < 2000; ++id) {
    const Vec3 p = 1.4 * random_point(id);
    const Real exact = std::hypot(std::hypot(p.x, p.y) - 2, p.z) - 0.5;
    // Chords of 96 by 48 corners lie at most 2.5 (1 - cos(pi/96)) + 0.5 (1 - cos(pi/48)) = 2.4e-3 inside.
    EXPECT_NEAR(torus.nearest(p).distance, exact, 2.5e-3);
    inside += exact < -2.5e-3;
  }
  EXPECT_GT(inside, 50);
}

TEST(MeshDistance, AMeshWithAHoleIsRefused) {
  TriangleMesh box = testing::box_mesh({1, 1, 1});
  box.triangles.pop_back();
  EXPECT_THROW(MeshDistance(box, "open.obj"), InputError);
}

// --- specs ------------------------------------------------------------------------------------------------------------

bool has_problem(const ShapeSpec& spec, const std::string& key) {
  for (const Problem& p : find_problems(spec)) {
    if (p.key == key) return true;
  }
  return false;
}

TEST(ShapeSpec, EachKindTellsWhatItLacksAndWhatItDoesNotUse) {
  ShapeSpec spec{.kind = ShapeKind::sphere};
  EXPECT_TRUE(has_problem(spec, "centre"));
  EXPECT_TRUE(has_problem(spec, "radius"));
  spec.centre = Vec3{}, spec.radius = 1.0;
  EXPECT_TRUE(find_problems(spec).empty());
  spec.height = 2.0;
  EXPECT_TRUE(has_problem(spec, "height"));
  spec.kind = ShapeKind::cone;
  EXPECT_TRUE(has_problem(spec, "base"));
  EXPECT_TRUE(has_problem(spec, "centre"));
}

TEST(ShapeSpec, UnusableValuesAreAllReportedInOneGo) {
  const ShapeSpec spec{.kind = ShapeKind::cylinder, .base = Vec3{NAN, 0, 0}, .axis = Vec3{}, .radius = -1.0, .height = 0.0};
  for (const char* key : {"base", "axis", "radius", "height"}) EXPECT_TRUE(has_problem(spec, key)) << key;
  try {
    make_shape(spec);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.problems().size(), 4u);
  }
  EXPECT_TRUE(has_problem({.kind = ShapeKind::box, .centre = Vec3{}, .size = Vec3{1, 0, 1}}, "size"));
}

TEST(ShapeSpec, DirectionsOfAnyLengthBecomeUnitVectors) {
  const Shape plane = make_shape({.kind = ShapeKind::plane, .point = Vec3{}, .normal = Vec3{0, 0, 5}});
  EXPECT_NEAR(nearest_surface(plane, {0, 0, 2}).distance, 2, 1e-15);
  const Shape cone = make_shape({.kind = ShapeKind::cone, .base = Vec3{}, .axis = Vec3{0, 3, 0}, .radius = 1.0, .height = 2.0});
  EXPECT_NEAR(nearest_surface(cone, {0, 3, 0}).distance, 1, 1e-15);
}

TEST(ShapeSpec, AMeshIsScaledThenTurnedThenMoved) {
  TriangleMesh mesh;
  mesh.vertices = {{1000, 0, 0}};
  apply_transform(mesh, {.scale = 1e-3, .rotation = {0, 0, pi / 2}, .translation = {0, 0, 5}});
  EXPECT_NEAR(norm(mesh.vertices[0] - Vec3{0, 1, 5}), 0, 1e-15);
}

}  // namespace
}  // namespace imbibe
