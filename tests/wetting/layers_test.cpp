// Liquid between layers of cloth that lie on each other.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "imbibe/core/random.h"
#include "imbibe/fabric/fabric.h"
#include "imbibe/wetting/face_back.h"
#include "imbibe/wetting/wetting_step.h"

namespace imbibe {
namespace {

constexpr Vec3 none{}, down{0, 0, -9.81};

YarnNetwork stack(std::vector<LayerSpec> layers, Real gap = 0, int yarns = 8) {
  static const FibreLibrary library = read_fibre_library({std::filesystem::path(IMBIBE_SOURCE_DIR) / "fibres"});
  FabricSpec spec;
  spec.warp.linear_density = spec.weft.linear_density = 20e-6;
  spec.warp.density = spec.weft.density = 2900;
  spec.size = {yarns / 2900.0, yarns / 2900.0};
  spec.layers = std::move(layers);
  spec.layer_gap = gap;
  return build_fabric(spec, library).network;
}

// Transport only.
WettingModel model_of(const YarnNetwork& network, TransportModel law = TransportModel::physical) {
  WettingParams params;
  params.model = law;
  params.residual = 1e-9;
  params.evaporation = false;
  params.sorption = SorptionModel::none;
  return build_wetting_model(network, params, {});
}

Real layer_kg(const YarnNetwork& net, const Contents& c, int layer) {
  Real sum = 0;
  for (std::size_t i = 0; i < net.nodes(); ++i)
    if (net.layer_of(i) == layer) sum += c.liquid_kg[i];
  return sum;
}
Real total_kg(const Contents& c) {
  Real sum = 0;
  for (const Real kg : c.liquid_kg) sum += kg;
  return sum;
}
Real released_kg(const WettingReport& report) {
  Real sum = 0;
  for (const ReleasedLiquid& r : report.released) sum += r.kg;
  return sum;
}

void fill_layer(const YarnNetwork& net, const WettingModel& m, Contents& c, int layer, Real yarns, Real pores = 0) {
  for (std::size_t i = 0; i < net.nodes(); ++i)
    if (net.layer_of(i) == layer) c.liquid_kg[i] = (net.is_pore(i) ? pores : yarns) * m.liquid.density * m.volume(i);
}

WettingReport advance(const WettingModel& m, Contents& c, Real until, const Vec3& gravity = none,
                      std::span<const FaceSupply> supplies = {}) {
  std::vector<Real> taken(supplies.size());
  WettingReport report = step_wetting(m, c, supplies, taken, Air{}, gravity, until);
  EXPECT_TRUE(report.converged);
  return report;
}

// Water on the upper face, over all nodes of the first layer.
std::vector<FaceSupply> water_above(const YarnNetwork& net, Real pressure) {
  std::vector<FaceSupply> supplies;
  for (Index i = 0; i < net.nodes(); ++i)
    if (net.on_face(i, true))
      supplies.push_back({.node = i, .wetted_share = 1, .pressure = pressure, .available_kg = 1e-3});
  return supplies;
}

TEST(FaceBack, AMeniscusBridgesItsPlateGapAndNoMore) {
  const Real tension = 0.0728, cosines = 2 * std::cos(radians(45));
  EXPECT_NEAR(bridged_height(tension, cosines, -5000), 2 * tension * std::cos(radians(45)) / 5000, 1e-18);
  EXPECT_TRUE(std::isinf(bridged_height(tension, cosines, 0)));
  EXPECT_EQ(bridged_height(tension, 2 * std::cos(radians(100)), -1), 0);
  EXPECT_NEAR(bridged_area(10e-6, 4e-6, 4e-4, 1), 6e-6 * 4e-4, 1e-20);
  EXPECT_EQ(bridged_area(4e-6, 10e-6, 4e-4, 1), 0);
  EXPECT_EQ(bridged_area(1, 0, 4e-4, 1e-8), 1e-8);
}

TEST(FaceBack, KeepsTheMassAndTheMaximumPrinciple) {
  for (const TransportModel law : {TransportModel::physical, TransportModel::kunzel}) {
    const YarnNetwork net = stack({{.count = 2, .fibre = ""}, {.count = 1, .fibre = "viscose"}});
    const WettingModel m = model_of(net, law);
    Contents c = conditioned_contents(m, Air{});
    for (std::size_t i = 0; i < net.nodes(); ++i)
      c.liquid_kg[i] = uniform({7, i, 0}) * (net.is_pore(i) ? 0.3 : 0.95) * m.liquid.density * m.volume(i);
    const auto extremes = [&] {
      std::pair<Real, Real> range{1e30, -1e30};
      for (std::size_t i = 0; i < net.nodes(); ++i)
        if (m.volume(i) > 0) {
          const Real p = node_pressure(m, c, i);
          range = {std::min(range.first, p), std::max(range.second, p)};
        }
      return range;
    };
    const Real before = total_kg(c);
    auto range = extremes();
    for (const Real dt : {1e-4, 1e-2, 1.0, 100.0}) {
      const WettingReport report = advance(m, c, dt);
      EXPECT_NEAR(total_kg(c) + released_kg(report), before, 1e-13 * before);
      EXPECT_TRUE(report.released.empty());
      const auto now = extremes();
      EXPECT_LE(now.second, range.second + 1e-3);  // the residual, 1e-9 in saturation, in Pa at p'(s) ~ 1e5
      EXPECT_GE(now.first, range.first * (1 + 1e-6));
      range = now;
    }
  }
}

// Turned over and its axes exchanged, a square plain weave is itself, and a stack of three its own mirror image.
TEST(FaceBack, OuterLayersOfAMirroredStackShareAlike) {
  const YarnNetwork net = stack({{.count = 3, .fibre = ""}});
  const WettingModel m = model_of(net);
  Contents c = conditioned_contents(m, Air{});
  fill_layer(net, m, c, 1, 0.9);
  const Real before = total_kg(c);
  advance(m, c, 20);
  const Real upper = layer_kg(net, c, 0), lower = layer_kg(net, c, 2);
  EXPECT_GT(upper, 0.2 * before);
  EXPECT_NEAR(upper, lower, 1e-8 * before);  // Newton's tolerance, some hundred steps
  EXPECT_LT(upper, layer_kg(net, c, 1) * (1 + 1e-6));
}

TEST(FaceBack, TheLowerLayerIsReachedLaterAndHoldsLess) {
  const YarnNetwork net = stack({{.count = 2, .fibre = ""}});
  const WettingModel m = model_of(net);
  Contents c = conditioned_contents(m, Air{});
  Real last = 0;
  for (int k = 0; k < 6; ++k) {
    advance(m, c, 0.02, down, water_above(net, 20));
    const Real lower = layer_kg(net, c, 1);
    EXPECT_GT(lower, last);
    EXPECT_LT(lower, layer_kg(net, c, 0));
    last = lower;
  }
}

TEST(FaceBack, ARejectingLayerBetweenStaysDryAndKeepsTheLayerBelowDryUntilItsBreakthrough) {
  const YarnNetwork net = stack({{.count = 1, .fibre = ""}, {.count = 1, .fibre = "polypropylene"}, {.count = 1, .fibre = ""}});
  const WettingModel m = model_of(net);
  const std::size_t pore = m.pores / 2;  // of the layer between
  ASSERT_FALSE(m.pore_wets(pore));
  Contents c = conditioned_contents(m, Air{});
  advance(m, c, 10, down, water_above(net, 0.9 * m.pore_breakthrough(pore)));
  // Its yarns are full, and so are its pores.
  Real room = 0;
  for (std::size_t i = 0; i < net.nodes(); ++i)
    if (net.layer_of(i) == 0) room += m.liquid.density * m.volume(i);
  EXPECT_GT(layer_kg(net, c, 0), 0.99 * room);
  EXPECT_EQ(layer_kg(net, c, 1), 0);
  EXPECT_EQ(layer_kg(net, c, 2), 0);
  advance(m, c, 10, down, water_above(net, 1.2 * m.pore_breakthrough(pore)));
  EXPECT_GT(layer_kg(net, c, 1), 0);
  EXPECT_GT(layer_kg(net, c, 2), 0);
}

TEST(FaceBack, LayersApartPassNothingUntilTheLiquidBridgesTheGap) {
  const Real gap = 30e-6;  // cotton at 45 deg: a meniscus bridges it above -3.4 kPa
  const YarnNetwork net = stack({{.count = 2, .fibre = ""}}, gap);
  const WettingModel m = model_of(net);
  Contents c = conditioned_contents(m, Air{});
  fill_layer(net, m, c, 0, 0.8);  // about -13 kPa
  advance(m, c, 10);
  EXPECT_EQ(layer_kg(net, c, 1), 0);
  fill_layer(net, m, c, 0, 1, 0.5);  // full yarns and pores above -2 kPa
  for (int k = 0; k < 2; ++k) advance(m, c, 0.1);  // the contact is that of a step's start
  EXPECT_GT(layer_kg(net, c, 1), 0);
}

TEST(FaceBack, AWetStackComesToRestAsAColumn) {
  const YarnNetwork net = stack({{.count = 3, .fibre = ""}});
  const WettingModel m = model_of(net);
  Contents c = conditioned_contents(m, Air{});
  for (int layer = 0; layer < 3; ++layer) fill_layer(net, m, c, layer, 0.7, 0.01);
  const Vec3 gravity = 50 * down;  // 0.35 mm are 170 Pa
  for (int k = 0; k < 20; ++k) advance(m, c, 500, gravity);
  for (const Edge& e : net.edges) {
    if (e.kind != EdgeKind::face_back && e.kind != EdgeKind::along_yarn) continue;
    const Real head = m.liquid.density * gravity.z * (net.node_centre(e.b).z - net.node_centre(e.a).z);
    EXPECT_NEAR(node_pressure(m, c, e.b) - node_pressure(m, c, e.a), head, 0.5);  // of heads of 85 and 170 Pa
  }
}

TEST(FaceBack, OnlyOuterLayersSeeTheAirAndGiveLiquidOff) {
  const YarnNetwork net = stack({{.count = 3, .fibre = ""}});
  const WettingModel m = model_of(net);
  Real area[3] = {0, 0, 0};
  for (std::size_t s = 0; s < m.segments; ++s) area[net.layer_of(s)] += m.vapour_area(s);
  EXPECT_NEAR(area[0], m.area, 1e-9 * m.area);  // a kind's values have 30 bits
  EXPECT_EQ(area[1], 0);
  EXPECT_NEAR(area[2], m.area, 1e-9 * m.area);
  Contents c = conditioned_contents(m, Air{});
  for (int layer = 0; layer < 3; ++layer) fill_layer(net, m, c, layer, 1.0, 1.19);
  const Real before = total_kg(c);
  const WettingReport report = advance(m, c, 0.1, 100 * down);
  EXPECT_GT(released_kg(report), 0);
  EXPECT_NEAR(total_kg(c) + released_kg(report), before, 1e-12 * before);
  for (const ReleasedLiquid& r : report.released) EXPECT_NE(net.layer_of(r.node), 1);
}

}  // namespace
}  // namespace imbibe
