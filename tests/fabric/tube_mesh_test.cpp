#include "imbibe/fabric/tube_mesh.h"

#include "fabric/support.h"

namespace imbibe {
namespace {

using test::contains;
using test::problems_of;

YarnNetwork small_net() {
  FabricSpec spec = test::paper_sheet();
  spec.size = {0.006, 0.005};
  spec.weave = "twill 2/1";
  spec.warp.diameter = 0.3e-3;
  return build_fabric(spec, test::shipped_fibres()).network;
}

TEST(TubeMesh, AYarnWithCapsIsAClosedSolidWithOutwardNormals) {
  const YarnNetwork net = small_net();
  for (Index yarn = 0; yarn < net.yarn_family.size(); ++yarn)
    for (int sides : {3, 8, 13}) {
      const TriangleMesh mesh = yarn_tube(net, yarn, {.sides = sides, .caps = true});
      EXPECT_FALSE(find_defects(mesh).any()) << yarn << " " << sides;
    }
}

TEST(TubeMesh, NeighbouringSegmentsShareTheirRingToTheBit) {
  const YarnNetwork net = small_net();
  const TubeParams params{.sides = 10};
  for (Index s = 0; s + 1 < net.segments(); ++s) {
    if (net.segment_yarn[s] != net.segment_yarn[s + 1]) continue;
    const TriangleMesh a = segment_tube(net, s, params), b = segment_tube(net, s + 1, params);
    for (std::size_t k = 0; k < 10; ++k) EXPECT_EQ(a.vertices[a.vertices.size() - 10 + k], b.vertices[k]);
  }
}

TEST(TubeMesh, NormalsPointAwayFromTheCentreLine) {
  const YarnNetwork net = small_net();
  for (Index s = 0; s < net.segments(); ++s) {
    const TriangleMesh mesh = segment_tube(net, s);
    const Index yarn = net.segment_yarn[s];
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const Vec3 middle = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3.0;
      Vec3 nearest{};
      Real least = 1e9;
      for (Index p = net.yarn_first_point[yarn]; p < net.yarn_first_point[yarn + 1]; ++p)
        if (norm(net.points[p] - middle) < least) least = norm(net.points[p] - middle), nearest = net.points[p];
      EXPECT_GT(dot(triangle_normal(mesh, t), middle - nearest), 0);
    }
  }
}

TEST(TubeMesh, CornersLieOnTheRoundYarnAndSidesInsideByTheStatedDeviation) {
  const YarnNetwork net = small_net();
  const TriangleMesh mesh = segment_tube(net, 3, {.sides = 6});
  const Index first = net.yarn_first_point[0] + 3 * 8;
  const Real r = net.type_of_segment(3).radius;
  for (std::size_t ring = 0; ring <= 8; ++ring)
    for (std::size_t k = 0; k < 6; ++k) {
      const Vec3 a = mesh.vertices[6 * ring + k], b = mesh.vertices[6 * ring + (k + 1) % 6];
      EXPECT_NEAR(norm(a - net.points[first + ring]), r, 1e-15);
      EXPECT_NEAR(norm(0.5 * (a + b) - net.points[first + ring]), r - tube_deviation(r, 6), 1e-15);
    }
}

TEST(TubeMesh, ItsVolumeTendsToThatOfTheRoundYarn) {
  FabricSpec spec = test::paper_sheet();
  spec.size = {0.005, 0.005};
  spec.points_per_segment = 64;
  const YarnNetwork net = build_fabric(spec, test::shipped_fibres()).network;
  Real arc = 0;
  for (Index s = net.yarn_first_segment[0]; s < net.yarn_first_segment[1]; ++s) arc += net.segment_length[s];
  const Real round = pi * 0.04e-6 * arc;
  Real before = 1;
  for (int sides : {8, 16, 32, 64}) {
    const Real missing = 1 - enclosed_volume(yarn_tube(net, 0, {.sides = sides, .caps = true})) / round;
    // An n-gon's area falls short by 2 pi^2 / (3 n^2): second order. The length's error is 1e-5 (64 points).
    EXPECT_NEAR(missing, 2 * pi * pi / (3.0 * sides * sides), 0.1 * missing + 3e-5) << sides;
    EXPECT_LT(missing, before);
    before = missing;
  }
}

TEST(TubeMesh, ResolutionIsAParameterAndMustFit) {
  const YarnNetwork net = small_net();
  const TriangleMesh fine = segment_tube(net, 0, {.sides = 12, .every_point = 1});
  const TriangleMesh coarse = segment_tube(net, 0, {.sides = 12, .every_point = 4});
  EXPECT_EQ(fine.triangles.size(), 2u * 12u * 8u);
  EXPECT_EQ(coarse.triangles.size(), 2u * 12u * 2u);
  EXPECT_TRUE(contains(problems_of([&] { segment_tube(net, 0, {.sides = 2, .every_point = 3}); }), "sides: 2 is below 3"));
  EXPECT_TRUE(contains(problems_of([&] { segment_tube(net, 0, {.sides = 2, .every_point = 3}); }), "does not divide"));
  EXPECT_EQ(fabric_tubes(net).triangles.size(), net.segments() * 2 * 12 * 8);
}

}  // namespace
}  // namespace imbibe
