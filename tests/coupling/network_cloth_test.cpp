// What the water of a network does to its sheet.
#include "imbibe/coupling/network_cloth.h"

#include <gtest/gtest.h>

#include <numeric>

#include "support/woven.h"

namespace imbibe {
namespace {

struct Wet {
  Fabric fabric;
  WettingModel model;
  Contents contents;
  ExchangeState exchange;
  NetworkCloth cloth;
  std::vector<std::uint8_t> held;

  explicit Wet(const std::string& fibre) : fabric(test::woven(fibre, fibre, 20)) {
    const YarnNetwork& n = fabric.network;
    model = build_wetting_model(n, {}, {});
    contents = conditioned_contents(model, {});
    exchange.waiting_kg.assign(n.nodes(), 0);
    SoftSheet soft;
    soft.sheet =
        make_sheet(GridSheet{.width = n.size_x, .height = n.size_y, .columns = 11, .rows = 11, .areal_mass = 0.1});
    cloth = make_network_cloth(std::move(soft), n, model, {}, {});
    find_held(cloth.soft, held);
  }
  void weigh_it() {
    WeighScratch scratch;
    weigh(cloth, held, fabric.network, model, contents, exchange, {}, scratch);
  }
  Real carried() const {
    const auto& kg = cloth.soft.sheet.added_mass;
    return std::accumulate(kg.begin(), kg.end(), Real{0});
  }
  Real held_kg() const {
    return total_sorbed_kg(model, contents) + total_yarn_kg(model, contents) + total_pore_kg(model, contents);
  }
};

TEST(NetworkCloth, CarriesWhatItHoldsBeyondTheAirsRegainAndWhatWaits) {
  Wet wet("cotton");
  wet.weigh_it();
  EXPECT_NEAR(wet.carried(), 0, 1e-18);
  const Real before = wet.held_kg();
  for (std::size_t k = 0; k < 300; ++k) wet.contents.liquid_kg[k] += 1e-9 * static_cast<Real>(k);
  wet.exchange.waiting_kg[40] = 3e-7;
  wet.cloth.borrowed_kg = 1e-7;
  wet.weigh_it();
  const Real expected = wet.held_kg() - before + 3e-7 - 1e-7;
  EXPECT_NEAR(wet.carried(), expected, 1e-12 * expected);
}

TEST(NetworkCloth, TheWeightLiesWhereTheWaterIs) {
  Wet wet("cotton");
  const Index node = 137;
  wet.contents.liquid_kg[node] += 1e-6;
  wet.weigh_it();
  const Sheet& sheet = wet.cloth.soft.sheet;
  Vec3 centre{};
  for (std::size_t n = 0; n < sheet.size(); ++n) centre += sheet.added_mass[n] * Vec3{sheet.u[n], sheet.v[n], 0};
  const Vec3 c = wet.fabric.network.node_centre(node);
  const Vec3 at = centre / 1e-6 - Vec3{0.5 * wet.fabric.network.size_x, 0.5 * wet.fabric.network.size_y, 0};
  EXPECT_NEAR(at.x, c.x, 1e-12);
  EXPECT_NEAR(at.y, c.y, 1e-12);
}

TEST(NetworkCloth, SwollenViscoseHasLostHalfItsStiffnessAndCottonNone) {
  for (const auto& [fibre, alpha] : {std::pair{"viscose", 0.5}, {"wool", 0.4}, {"nylon66", 0.2}, {"cotton", 0.0}}) {
    Wet wet(fibre);
    wet.weigh_it();
    const Sheet& sheet = wet.cloth.soft.sheet;
    EXPECT_EQ(sheet.stiffness_factor[60], 1) << fibre;  // in balance with the air
    for (std::size_t s = 0; s < wet.contents.sorbed_kg.size(); ++s)
      wet.contents.sorbed_kg[s] *= wet.model.yarns[0].swelling_regain / node_regain(wet.model, wet.contents, s);
    wet.weigh_it();
    EXPECT_NEAR(sheet.stiffness_factor[60], 1 - alpha, 1e-9) << fibre;
    EXPECT_NEAR(sheet.damping_added[60], wet.cloth.soft.cloth.damping, 1e-9 * wet.cloth.soft.cloth.damping) << fibre;
  }
}

TEST(NetworkCloth, ClingsWhereItsYarnsAreWetByBridgesBetweenCrowns) {
  // Shirting: 28 x 28 per cm, r = 86 um, water at 10 deg: 3.9e6 crowns a m2, 3.87e-5 N each: 152 Pa.
  EXPECT_NEAR(cling_pressure(0.5 * 2800 * 2800, 86e-6, 0.0728, std::cos(radians(10))), 151.9, 0.2);
  EXPECT_EQ(cling_pressure(1e6, 1e-4, 0.0728, -0.2), 0);  // what repels bridges nothing
  Wet wet("cotton");
  wet.weigh_it();
  const Sheet& sheet = wet.cloth.soft.sheet;
  EXPECT_EQ(sheet.cling[60], 0);
  for (std::size_t s = 0; s < wet.fabric.network.segments(); ++s)
    wet.contents.liquid_kg[s] = 0.5 * wet.model.liquid.density * wet.model.volume(s);
  wet.weigh_it();
  const YarnType& yarn = wet.fabric.network.yarn_types.front();
  const Real crowns = 0.5 / (wet.fabric.network.pitch_x * wet.fabric.network.pitch_y);
  EXPECT_NEAR(sheet.cling[60], cling_pressure(crowns, yarn.radius, 0.0728, std::cos(yarn.fibre.receding_angle)), 1e-9);
}

}  // namespace
}  // namespace imbibe
