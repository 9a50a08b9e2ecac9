#include "imbibe/fabric/layers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "imbibe/core/random.h"
#include "imbibe/fabric/fabric.h"

namespace imbibe {
namespace {

const FibreLibrary& library() {
  static const FibreLibrary read = read_fibre_library({std::filesystem::path(IMBIBE_SOURCE_DIR) / "fibres"});
  return read;
}

FabricSpec shirting(std::vector<LayerSpec> layers = {}) {
  FabricSpec spec;
  spec.size = {4e-3, 4e-3};
  spec.warp.linear_density = spec.weft.linear_density = 20e-6;
  spec.warp.density = 3000, spec.weft.density = 2800;
  spec.layers = std::move(layers);
  return spec;
}

std::size_t count(const YarnNetwork& net, EdgeKind kind) {
  return static_cast<std::size_t>(std::count_if(net.edges.begin(), net.edges.end(), [&](const Edge& e) { return e.kind == kind; }));
}

TEST(Layers, GapOfTwoCrownsIsTheLeastOverThePlane) {
  const Crown a{86e-6, 258e-6}, b{258e-6, 86e-6};
  const Real dx = 90e-6, dy = 60e-6;
  Real least = 1;
  for (int i = -400; i <= 400; ++i)
    for (int j = -400; j <= 400; ++j) {
      const Real x = i * 0.5e-6, y = j * 0.5e-6;
      least = std::min(least, 0.5 * (x * x / a.radius_x + (x - dx) * (x - dx) / b.radius_x + y * y / a.radius_y +
                                     (y - dy) * (y - dy) / b.radius_y));
    }
  EXPECT_NEAR(crown_gap(a, b, dx, dy), least, 1e-3 * least);  // the lattice misses the place by up to 0.25 um
}

TEST(Layers, ContactAreaIsWhereTheGapIsSmallerThanTheHeight) {
  const Crown a{86e-6, 258e-6}, b{200e-6, 150e-6};
  const Real height = 5e-6;
  constexpr int tries = 200000;
  int inside = 0;
  const Real side = 200e-6;
  for (std::uint64_t i = 0; i < tries; ++i) {
    const Real x = side * (uniform({1, i, 0}, 0) - 0.5), y = side * (uniform({1, i, 0}, 1) - 0.5);
    if (0.5 * (x * x * (1 / a.radius_x + 1 / b.radius_x) + y * y * (1 / a.radius_y + 1 / b.radius_y)) < height) ++inside;
  }
  const Real area = side * side * inside / tries;
  EXPECT_NEAR(contact_area_per_height(a, b) * height, area, 0.02 * area);  // 3 sigma of the counting is 1.7 %
}

TEST(Layers, TwoLayersAreTwiceOneAndTouchAtEveryCrossing) {
  const Fabric one = build_fabric(shirting(), library()), two = build_fabric(shirting({{.count = 2, .fibre = ""}}), library());
  const YarnNetwork &a = one.network, &b = two.network;
  EXPECT_EQ(b.layers, 2);
  EXPECT_EQ(b.segments(), 2 * a.segments());
  EXPECT_EQ(b.pores(), 2 * a.pores());
  EXPECT_NEAR(b.thickness, 2 * a.thickness, 1e-15);
  EXPECT_NEAR(two.numbers.areal_mass, 2 * one.numbers.areal_mass, 1e-12 * two.numbers.areal_mass);
  EXPECT_NEAR(two.numbers.porosity, one.numbers.porosity, 1e-12);
  EXPECT_NEAR(two.numbers.geometric_thickness, b.thickness, 1e-12);
  EXPECT_NEAR(two.numbers.warp.crimp, one.numbers.warp.crimp, 1e-12);
  EXPECT_NEAR(two.numbers.radius_as_printed, one.numbers.radius_as_printed, 1e-15);
  for (const EdgeKind kind : {EdgeKind::along_yarn, EdgeKind::crossing, EdgeKind::segment_pore})
    EXPECT_EQ(count(b, kind), 2 * count(a, kind));
  EXPECT_EQ(count(b, EdgeKind::pore_pore), 2 * count(a, EdgeKind::pore_pore) + a.pores());
  EXPECT_EQ(count(b, EdgeKind::face_back), one.network.segments() / 2);  // ends x picks crossings
  ASSERT_EQ(b.face_contacts.size(), count(b, EdgeKind::face_back));
  for (const FaceContact& c : b.face_contacts) EXPECT_NEAR(c.gap, 0, 1e-12);
}

TEST(Layers, NodesKnowTheirLayerAndFacingNodesLieOnTopOfEachOther) {
  const YarnNetwork net = build_fabric(shirting({{.count = 3, .fibre = ""}}), library()).network;
  for (std::size_t node = 0; node < net.nodes(); ++node)
    EXPECT_LT(std::abs(net.node_centre(node).z - net.layer_height(net.layer_of(node))), 0.5 * net.layer_thickness());
  EXPECT_TRUE(net.on_face(0, true));
  EXPECT_FALSE(net.on_face(0, false));
  EXPECT_TRUE(net.on_face(net.nodes() - 1, false));
  for (const Edge& e : net.edges) {
    if (e.kind != EdgeKind::face_back) continue;
    EXPECT_EQ(net.layer_of(e.a) + 1, net.layer_of(e.b));
    EXPECT_NE(net.family_of_segment(e.a), net.family_of_segment(e.b));  // plain weave laid edge to edge
    // The crowns touch: their axes are two radii apart.
    EXPECT_NEAR(norm(net.segment_centre[e.a] - net.segment_centre[e.b]),
                net.type_of_segment(e.a).radius + net.type_of_segment(e.b).radius, 1e-12);
  }
}

TEST(Layers, EveryNodeOfALayerIsInTheBoundsOfItsYarn) {
  const YarnNetwork net = build_fabric(shirting({{.count = 2, .fibre = ""}}), library()).network;
  ASSERT_EQ(net.yarn_first_segment.size(), net.yarn_family.size() + 1);
  ASSERT_EQ(net.yarn_first_segment.back(), net.segments());
  ASSERT_EQ(net.yarn_first_point.back(), net.points.size());
  for (Index y = 0; y < net.yarn_family.size(); ++y)
    for (Index s = net.yarn_first_segment[y]; s < net.yarn_first_segment[y + 1]; ++s) {
      EXPECT_EQ(net.segment_yarn[s], y);
      const Index middle = net.yarn_first_point[y] +
                           (s - net.yarn_first_segment[y]) * static_cast<Index>(net.points_per_segment) +
                           static_cast<Index>(net.points_per_segment) / 2;
      EXPECT_NEAR(norm(net.points[middle] - net.segment_centre[s]), 0, 1e-12);
    }
}

TEST(Layers, ALayerOfAnotherFibreHasTheSameTubesAndItsOwnMass) {
  const Fabric mixed = build_fabric(shirting({{}, {.count = 1, .fibre = "polypropylene"}}), library());
  const YarnNetwork& net = mixed.network;
  const YarnType &top = net.type_of_segment(0), &back = net.type_of_segment(net.segments() - 1);
  EXPECT_EQ(top.fibre.name, "cotton");
  EXPECT_EQ(back.fibre.name, "polypropylene");
  EXPECT_EQ(top.radius, back.radius);
  EXPECT_NEAR(back.linear_density / top.linear_density, back.fibre.density / top.fibre.density, 1e-12);
}

TEST(Layers, AGapKeepsTheCrownsApart) {
  FabricSpec spec = shirting({{.count = 2, .fibre = ""}});
  spec.layer_gap = 20e-6;
  const YarnNetwork net = build_fabric(spec, library()).network;
  ASSERT_FALSE(net.face_contacts.empty());
  for (const FaceContact& c : net.face_contacts) EXPECT_NEAR(c.gap, 20e-6, 1e-12);
  spec.layer_gap = 100e-6;  // wider than half a radius of 86 um: no meniscus reaches across
  EXPECT_TRUE(build_fabric(spec, library()).network.face_contacts.empty());
}

TEST(Layers, WrongLayersAreRefusedAllAtOnce) {
  FabricSpec spec = shirting({{.count = 0, .fibre = ""}, {.count = 1, .fibre = "coton"}});
  try {
    build_fabric(spec, library(), "textiles[0]");
    FAIL();
  } catch (const InputError& e) {
    ASSERT_EQ(e.problems().size(), 2u);
    EXPECT_EQ(e.problems()[0].key, "textiles[0].layers[0].count");
    EXPECT_EQ(e.problems()[1].key, "textiles[0].layers[1].fibre");
  }
  spec = shirting({{.count = 2, .fibre = ""}});
  spec.thickness = 0.3e-3;  // the yarns reach 0.346 mm
  EXPECT_THROW(build_fabric(spec, library()), InputError);
}

}  // namespace
}  // namespace imbibe
