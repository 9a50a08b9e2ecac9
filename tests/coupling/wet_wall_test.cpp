#include "imbibe/coupling/wet_wall.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/woven.h"

namespace imbibe {
namespace {

TEST(WetWall, ADryFaceShowsTheYarnsAdvancingAngle) {
  const Fabric fabric = test::woven("cotton", "cotton");
  const FaceMap map = build_face_map(fabric.network, 0.5e-3);
  const Placement placement;
  const Shape shape = sheet_shape(fabric.network, placement);
  const std::vector<float> dry(fabric.network.nodes(), 0);
  const Wall wall = wet_wall(shape, placement, map, dry);
  EXPECT_NEAR(wall.angles_at({0, 0, 0.5e-3}).cos_advancing, std::cos(radians(45)), 1e-6);
}

TEST(WetWall, AWetHydrophilicFaceIsMoreWettableByCassiesLaw) {
  // 45 degrees, half of the face liquid: cos = 0.5 cos 45 + 0.5, 31.4 degrees.
  EXPECT_NEAR(degrees(std::acos(cos_wet_face(std::cos(radians(45)), 1))), 31.4, 0.05);
  Real last = -2;
  for (Real s = 0; s <= 1; s += 0.1) {
    EXPECT_GT(cos_wet_face(0.2, s), last);
    last = cos_wet_face(0.2, s);
  }
}

TEST(WetWall, AMixedClothShowsTheMeanOfItsYarns) {
  const Fabric fabric = test::woven("cotton", "polypropylene");
  const FaceMap map = build_face_map(fabric.network, 0.5e-3);
  const Placement placement;
  const Shape shape = sheet_shape(fabric.network, placement);
  const std::vector<float> dry(fabric.network.nodes(), 0);
  const Wall wall = wet_wall(shape, placement, map, dry);
  // Equal shares of cotton (45) and polypropylene (100) within the reach of the kernel.
  EXPECT_NEAR(wall.angles_at({0, 0, 0.5e-3}).cos_advancing, 0.5 * (std::cos(radians(45)) + std::cos(radians(100))), 0.02);
}

TEST(FaceMap, FindsEveryNodeWithinReach) {
  const Fabric fabric = test::woven("cotton", "cotton", 10);
  const FaceMap map = build_face_map(fabric.network, 0.7e-3);
  for (const Vec3& at : {Vec3{0, 0, 0}, Vec3{2.3e-3, -1.7e-3, 0}, Vec3{-4.9e-3, 4.9e-3, 0}}) {
    std::size_t all = 0, found = 0;
    const auto within = [&](Index k) {
      const Vec3& c = fabric.network.node_centre(k);
      return std::hypot(c.x - at.x, c.y - at.y) < map.reach;
    };
    for (Index k = 0; k < fabric.network.nodes(); ++k) all += within(k);
    map.near(at.x, at.y, true, [&](const FaceMap::Node& n) { found += within(n.index); });
    EXPECT_EQ(found, all);
  }
}

TEST(FaceMap, NoNodeIsNearAPlaceFarAwayOrOneThatIsNoNumber) {
  const Fabric fabric = test::woven("cotton", "cotton", 10);
  const FaceMap map = build_face_map(fabric.network, 0.7e-3);
  const Real infinity = std::numeric_limits<Real>::infinity(), nan = std::numeric_limits<Real>::quiet_NaN();
  for (const Real x : {1e30, -1e30, infinity, -infinity, nan}) {
    map.near(x, 0, true, [&](const FaceMap::Node&) { ADD_FAILURE() << "a node near x = " << x; });
    map.near(0, x, true, [&](const FaceMap::Node&) { ADD_FAILURE() << "a node near y = " << x; });
  }
}

TEST(FaceMap, KernelIntegratesToOneOverThePlane) {
  Real sum = 0;
  const int n = 400;
  for (int i = 0; i < n; ++i) {
    const Real r = (i + 0.5) / n;
    sum += 2 * pi * r * face_kernel(r, 1) / n;
  }
  EXPECT_NEAR(sum, 1, 1e-5);  // midpoint rule, error of order 1/n^2
}

}  // namespace
}  // namespace imbibe
