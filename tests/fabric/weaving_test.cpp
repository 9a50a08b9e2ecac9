#include "imbibe/fabric/weaving.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "fabric/support.h"
#include "imbibe/core/parallel.h"
#include "imbibe/fabric/fabric.h"

namespace imbibe {
namespace {

using test::contains;
using test::paper_sheet;
using test::problems_of;
using test::shipped_fibres;
using test::shirting;

// Cloths of every kind that the tests walk over.
std::vector<FabricSpec> cloths() {
  std::vector<FabricSpec> out;
  for (const char* weave : {"plain", "twill 2/1", "twill 2/2 left", "satin 5/2", "basket 2/2", "110 011 101 010"}) {
    out.push_back(paper_sheet());
    out.back().size = {0.012, 0.015};
    out.back().weave = weave;
    out.push_back(shirting(0.004));
    out.back().weave = weave;
  }
  FabricSpec unequal = paper_sheet();
  unequal.size = {0.012, 0.012};
  unequal.warp.diameter = 0.2e-3;
  unequal.weft.density = 1300;
  out.push_back(unequal);
  unequal.warp_crimp_share = 0.3;
  out.push_back(unequal);
  FabricSpec striped = paper_sheet();
  striped.size = {0.02, 0.012};
  striped.weave = "twill 2/1";
  striped.stripes.push_back({.family = Family::warp, .first = 3, .count = 2, .repeat = 5, .yarn = {.diameter = 0.25e-3}});
  striped.stripes.push_back({.family = Family::weft, .first = 4, .count = 3, .repeat = 0, .yarn = {.diameter = 0.5e-3}});
  out.push_back(striped);
  FabricSpec wif;
  wif.size = {0.016, 0.016};
  wif.weave = IMBIBE_SOURCE_DIR "/fabrics/huckaback_liftplan.wif";
  out.push_back(wif);
  return out;
}

Fabric built(const FabricSpec& spec) { return build_fabric(spec, shipped_fibres()); }

TEST(Weaving, ThePaperSheetHasItsCounts) {
  const YarnNetwork net = built(paper_sheet()).network;
  EXPECT_EQ(net.segments(), 7200u);
  EXPECT_EQ(net.pores(), 59u * 59u);
  EXPECT_EQ(net.nodes(), 7200u + 3481u);
  EXPECT_NEAR(net.size_x, 0.06, 1e-15);
  EXPECT_NEAR(net.pitch_y, 1e-3, 1e-15);
  EXPECT_NEAR(net.thickness, 0.8e-3, 1e-15);
  EXPECT_EQ(net.points.size(), 120u * (60u * 8u + 1u));
  std::map<EdgeKind, std::size_t> kinds;
  for (const Edge& edge : net.edges) ++kinds[edge.kind];
  EXPECT_EQ(kinds[EdgeKind::along_yarn], 120u * 59u);
  EXPECT_EQ(kinds[EdgeKind::crossing], 3600u);
  EXPECT_EQ(kinds[EdgeKind::segment_pore], 8u * 3481u);
  EXPECT_EQ(kinds[EdgeKind::pore_pore], 2u * 59u * 58u);
}

TEST(Weaving, EveryPoreTouchesEightSegmentsFourOfEachFamilyAndEachInnerSegmentFourPores) {
  for (const FabricSpec& spec : cloths()) {
    const YarnNetwork net = built(spec).network;
    std::vector<std::set<Index>> beside(net.nodes());
    std::vector<int> warps(net.nodes());
    for (const Edge& e : net.edges) {
      if (e.kind != EdgeKind::segment_pore) continue;
      ASSERT_FALSE(net.is_pore(e.a));
      ASSERT_TRUE(net.is_pore(e.b));
      beside[e.a].insert(e.b);
      beside[e.b].insert(e.a);
      warps[e.b] += net.family_of_segment(e.a) == Family::warp;
      // The segment's crossing is a corner of the pore's cell: within a pitch of it each way.
      EXPECT_LE(std::abs(net.node_centre(e.a).x - net.node_centre(e.b).x), 1.5 * net.pitch_x);
      EXPECT_LE(std::abs(net.node_centre(e.a).y - net.node_centre(e.b).y), 1.5 * net.pitch_y);
    }
    for (std::size_t n = 0; n < net.nodes(); ++n) {
      if (net.is_pore(n)) {
        EXPECT_EQ(beside[n].size(), 8u);
        EXPECT_EQ(warps[n], 4);
      } else {
        EXPECT_TRUE(beside[n].size() == 4 || beside[n].size() == 2 || beside[n].size() == 1);
      }
    }
  }
}

TEST(Weaving, EveryEdgeJoinsTwoNodesOnceAndCrossingsTouch) {
  for (const FabricSpec& spec : cloths()) {
    const YarnNetwork net = built(spec).network;
    std::set<std::pair<Index, Index>> seen;
    for (const Edge& e : net.edges) {
      EXPECT_LT(std::max(e.a, e.b), net.nodes());
      EXPECT_NE(e.a, e.b);
      EXPECT_TRUE(seen.insert(std::minmax(e.a, e.b)).second);
      if (e.kind == EdgeKind::along_yarn) {
        EXPECT_EQ(net.segment_yarn[e.a], net.segment_yarn[e.b]);
      }
      if (e.kind != EdgeKind::crossing) continue;
      const Vec3 a = net.segment_centre[e.a], b = net.segment_centre[e.b];
      EXPECT_EQ(net.family_of_segment(e.a), Family::warp);
      EXPECT_EQ(net.family_of_segment(e.b), Family::weft);
      EXPECT_NEAR(a.x, b.x, 1e-12);
      EXPECT_NEAR(a.y, b.y, 1e-12);
      // Touching: centre distance r_w + r_f, to rounding of millimetres.
      EXPECT_NEAR(std::abs(a.z - b.z), net.type_of_segment(e.a).radius + net.type_of_segment(e.b).radius, 1e-15);
    }
  }
}

TEST(Weaving, TheDraftSaysWhoIsOnTheFace) {
  for (const FabricSpec& spec : cloths()) {
    const Fabric fabric = built(spec);
    const YarnNetwork& net = fabric.network;
    for (const Edge& e : net.edges) {
      if (e.kind != EdgeKind::crossing) continue;
      const Index end = net.segment_yarn[e.a];
      const Index pick = e.a - net.yarn_first_segment[end];
      EXPECT_EQ(net.segment_centre[e.a].z > net.segment_centre[e.b].z, fabric.draft.warp_on_face(pick, end));
    }
  }
}

// Least distance of the two centre lines of crossing yarns near their crossings, relative to r + r'.
Real least_relative_distance(const YarnNetwork& net) {
  const std::size_t steps = static_cast<std::size_t>(net.points_per_segment);
  Real least = 1e9;
  for (const Edge& e : net.edges) {
    if (e.kind != EdgeKind::crossing) continue;
    const auto points = [&](Index segment) {
      const Index yarn = net.segment_yarn[segment];
      return net.yarn_first_point[yarn] + (segment - net.yarn_first_segment[yarn]) * steps;
    };
    const Real touch = net.type_of_segment(e.a).radius + net.type_of_segment(e.b).radius;
    for (std::size_t i = 0; i <= steps; ++i)
      for (std::size_t j = 0; j <= steps; ++j)
        least = std::min(least, norm(net.points[points(e.a) + i] - net.points[points(e.b) + j]) / touch);
  }
  return least;
}

TEST(Weaving, NoTwoYarnsInterpenetrate) {
  for (FabricSpec spec : cloths()) {
    spec.points_per_segment = 32;
    spec.size = {std::min(spec.size[0], 0.01), std::min(spec.size[1], 0.01)};
    const YarnNetwork net = built(spec).network;
    // The points lie on the curves themselves, so only rounding is allowed.
    EXPECT_GE(least_relative_distance(net), 1 - 1e-9) << spec.weave;
    EXPECT_LE(least_relative_distance(net), 1 + 1e-9) << spec.weave;
  }
}

TEST(Weaving, YarnsOfOneFamilyKeepTheirDistance) {
  for (const FabricSpec& spec : cloths()) {
    const YarnNetwork net = built(spec).network;
    for (std::size_t p = 0; p < net.pores(); ++p) {
      EXPECT_GT(net.pore_opening_x[p], 0);
      EXPECT_GT(net.pore_opening_y[p], 0);
    }
  }
}

TEST(Weaving, SegmentLengthsAreTheLengthsOfTheirCurves) {
  for (FabricSpec spec : cloths()) {
    spec.points_per_segment = 64;
    spec.size = {std::min(spec.size[0], 0.006), std::min(spec.size[1], 0.006)};
    const YarnNetwork net = built(spec).network;
    for (std::size_t s = 0; s < net.segments(); ++s) {
      const Index yarn = net.segment_yarn[s];
      const std::size_t first = net.yarn_first_point[yarn] + (s - net.yarn_first_segment[yarn]) * 64;
      Real chords = 0;
      for (std::size_t k = first; k < first + 64; ++k) chords += norm(net.points[k + 1] - net.points[k]);
      // A chord of angle a is shorter than its arc by a^2/24; 64 steps of at most 2 rad in all: 4.1e-5.
      EXPECT_LE(chords, net.segment_length[s] * (1 + 1e-12));
      EXPECT_GE(chords, net.segment_length[s] * (1 - 4.1e-5));
      // The middle point of the half loop is its crossing.
      EXPECT_LT(norm(net.points[first + 32] - net.segment_centre[s]), 1e-12);
    }
  }
}

TEST(Weaving, YarnsRunInTheirPlanesFromEdgeToEdge) {
  const YarnNetwork net = built(paper_sheet()).network;
  for (std::size_t y = 0; y < net.yarn_family.size(); ++y) {
    const Vec3 a = net.points[net.yarn_first_point[y]], b = net.points[net.yarn_first_point[y + 1] - 1];
    if (net.yarn_family[y] == Family::warp) {
      EXPECT_NEAR(a.y, -0.03, 1e-12);
      EXPECT_NEAR(b.y, 0.03, 1e-12);
      EXPECT_EQ(a.x, b.x);
    } else {
      EXPECT_NEAR(a.x, -0.03, 1e-12);
      EXPECT_NEAR(b.x, 0.03, 1e-12);
      EXPECT_EQ(a.y, b.y);
    }
  }
}

// Volume of the half of a yarn that lies in the cell between its crossings k and k + 1, from the points.
Real half_yarn_volume(const YarnNetwork& net, std::size_t yarn, std::size_t k) {
  const std::size_t steps = static_cast<std::size_t>(net.points_per_segment);
  const std::size_t first = net.yarn_first_point[yarn] + k * steps + steps / 2;
  Real arc = 0;
  for (std::size_t p = first; p < first + steps; ++p) arc += norm(net.points[p + 1] - net.points[p]);
  const Real r = net.yarn_types[net.yarn_type[yarn]].radius;
  return pi * r * r * arc / 2;
}

TEST(Weaving, APoreAndTheEightHalfSegmentsAroundItFillTheirCell) {
  for (FabricSpec spec : cloths()) {
    spec.points_per_segment = 64;
    const YarnNetwork net = built(spec).network;
    const auto ends = static_cast<std::size_t>(
        std::count(net.yarn_family.begin(), net.yarn_family.end(), Family::warp));
    for (std::size_t pore = 0; pore < net.pores(); ++pore) {
      const std::size_t j = pore / (ends - 1), i = pore % (ends - 1);
      const Real yarns = half_yarn_volume(net, i, j) + half_yarn_volume(net, i + 1, j) +
                         half_yarn_volume(net, ends + j, i) + half_yarn_volume(net, ends + j + 1, i);
      const Real cell = net.pore_area[pore] * net.thickness;
      ASSERT_GT(net.pore_volume[pore], 0);
      // A chord of angle a is shorter than its arc by a^2/24; 64 steps of at most 2 rad in all: 4.1e-5 of the yarns.
      ASSERT_NEAR(net.pore_volume[pore] + yarns, cell, 4.1e-5 * yarns) << spec.weave << " " << pore;
    }
  }
}

TEST(Weaving, TheCellsTileTheSheetBetweenItsOutermostYarns) {
  for (const FabricSpec& spec : cloths()) {
    const YarnNetwork net = built(spec).network;
    Real area = 0;
    for (Real a : net.pore_area) area += a;
    const auto ends = static_cast<std::size_t>(
        std::count(net.yarn_family.begin(), net.yarn_family.end(), Family::warp));
    const Real width = net.pitch_x * static_cast<Real>(ends - 1);
    const Real length = net.pitch_y * static_cast<Real>(net.yarn_family.size() - ends - 1);
    EXPECT_NEAR(area / (width * length), 1, 1e-12);  // rounding of the sum
    for (const Vec3& c : net.pore_centre) {
      EXPECT_LT(std::abs(c.x), width / 2);
      EXPECT_LT(std::abs(c.y), length / 2);
    }
  }
}

TEST(Weaving, AMirroredClothHasMirroredPores) {
  // Turning a plain weave by half a turn maps it onto itself: volumes are symmetric to rounding.
  const YarnNetwork net = built(paper_sheet()).network;
  for (std::size_t p = 0; p < net.pores(); ++p)
    EXPECT_NEAR(net.pore_volume[p] / net.pore_volume[net.pores() - 1 - p], 1, 1e-12);
}

TEST(Weaving, GivesTheSameBitsWithAnyNumberOfThreads) {
  const auto with = [](int threads) {
    ThreadLimit limit(threads);
    return built(paper_sheet()).network;
  };
  const YarnNetwork one = with(1), two = with(2);
  EXPECT_EQ(one.points, two.points);
  EXPECT_EQ(one.segment_length, two.segment_length);
  EXPECT_EQ(one.pore_volume, two.pore_volume);
}

TEST(Weaving, ThickAndThinYarnsAreFlushWithBothFaces) {
  FabricSpec spec = paper_sheet();
  spec.size = {0.01, 0.01};
  spec.warp.diameter = 0.2e-3;
  const YarnNetwork net = built(spec).network;
  EXPECT_NEAR(net.thickness, 2 * (0.1e-3 + 0.2e-3), 1e-15);
  for (std::size_t s = 0; s < net.segments(); ++s)
    EXPECT_NEAR(std::abs(net.segment_centre[s].z) + net.type_of_segment(s).radius, net.thickness / 2, 1e-15);
}

TEST(Weaving, AllCrimpCanBeInOneFamily) {
  FabricSpec spec = paper_sheet();
  spec.size = {0.01, 0.01};
  spec.warp_crimp_share = 0;
  const Fabric fabric = built(spec);
  EXPECT_NEAR(fabric.numbers.warp.crimp, 0, 1e-12);
  EXPECT_GT(fabric.numbers.weft.crimp, 0.1);
  EXPECT_NEAR(fabric.network.thickness, 2 * (0.4e-3 + 0.2e-3), 1e-15);
}

}  // namespace
}  // namespace imbibe
