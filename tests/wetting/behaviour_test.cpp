// What swelling, hysteresis, shells, release and the models as printed do to a network.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "imbibe/core/error.h"
#include "imbibe/wetting/isotherm.h"
#include "imbibe/wetting/wetting_step.h"
#include "support/hand_networks.h"

namespace imbibe {
namespace {

using testing::cotton_fibre;
using testing::paper_sheet;
using testing::paper_yarn;
using testing::polyester_fibre;
using testing::released_kg;
using testing::shirting;
using testing::shirting_yarn;
using testing::total_kg;
using testing::wool_fibre;
using testing::yarn_strip;

TEST(Swelling, KeepsTheCellsVolume) {
  WettingParams params;
  const WettingModel m = build_wetting_model(shirting(9, shirting_yarn(cotton_fibre())), params, {});
  Contents dry = conditioned_contents(m, Air{}), wet = dry;
  for (std::size_t s = 0; s < m.segments; ++s) wet.sorbed_kg[s] = m.dry_mass(s) * m.yarns[0].swelling_regain;
  const std::size_t pore = m.segments + 4 * 8 + 4, segment = 4 * 9 + 4;  // inside the sheet: 8 segments, 4 pores
  EXPECT_NEAR(current_volume(m, dry, pore), m.volume(pore), 1e-9 * m.volume(pore));
  const Real growth = current_volume(m, wet, segment) / m.volume(segment) - 1;
  EXPECT_GT(growth, 0.2);
  Real yarns = 0;
  for (const Index s : m.segments_of_pore(pore - m.segments)) yarns += 0.25 * m.yarn_volume(s) * growth;
  EXPECT_NEAR(m.volume(pore) - current_volume(m, wet, pore), yarns, 1e-12 * m.volume(pore));
}

TEST(Swelling, SqueezesTheSurplusOutOfAFullClothAndBooksIt) {
  WettingParams params;
  params.evaporation = false;
  const WettingModel m = build_wetting_model(shirting(9, shirting_yarn(cotton_fibre())), params, {});
  Contents c = conditioned_contents(m, Air{});
  for (std::size_t i = 0; i < m.nodes(); ++i) c.liquid_kg[i] = m.liquid.density * m.volume(i) * (1 + m.overfill(i));
  const Real before = total_kg(m, c);
  Real out = 0, now = 0, dt = 0.1;
  while (now < 1800) {
    const WettingReport report = step_wetting(m, c, {}, {}, Air{}, {0, 0, -9.81}, dt);
    ASSERT_TRUE(report.converged);
    out += released_kg(report);
    now += dt;
    dt = report.suggested_step;
  }
  EXPECT_NEAR(total_kg(m, c) + out, before, 1e-12 * before);
  // The fibres reached full swelling (k = 4.9e-3 /s), and what they took in they also took from the pores' room:
  // no node stands above its rim.
  for (std::size_t i = 0; i < m.segments; ++i) EXPECT_GT(node_regain(m, c, i), 0.99 * m.yarns[0].swelling_regain);
  for (std::size_t i = 0; i < m.nodes(); ++i) EXPECT_LE(saturation(m, c, i), 1 + m.overfill(i) + 1e-9);
}

TEST(Release, AnOverFullPoreGivesOffWhatStandsAboveItsOpeningPressure) {
  WettingParams params;
  params.evaporation = false;
  params.sorption = SorptionModel::none;
  const WettingModel m = build_wetting_model(shirting(5, shirting_yarn(wool_fibre(100))), params, {});
  Contents c = conditioned_contents(m, Air{});
  const std::size_t pore = m.segments + 5;
  c.liquid_kg[pore] = 1.5 * m.liquid.density * m.volume(pore);
  const WettingReport report = step_wetting(m, c, {}, {}, Air{}, {}, 1);
  ASSERT_FALSE(report.released.empty());
  EXPECT_EQ(report.released[0].node, pore);
  EXPECT_LE(node_pressure(m, c, pore), m.open(pore) * (1 + 1e-6));
}

TEST(Release, SaysByHowMuchThePressureAtTheLowerFaceIsAboveTheOpeningAndHowFastLiquidComes) {
  WettingParams params;
  params.evaporation = false;
  params.sorption = SorptionModel::none;
  const WettingModel m = build_wetting_model(shirting(5, shirting_yarn(wool_fibre(100))), params, {});
  const std::size_t pore = m.segments + 5;
  for (const Real gravity : {0.0, -9.81, 9.81}) {
    Contents c = conditioned_contents(m, Air{});
    c.liquid_kg[pore] = 1.21 * m.liquid.density * m.volume(pore);
    const WettingReport report = step_wetting(m, c, {}, {}, Air{}, {0, 0, gravity}, 1e-5);
    ASSERT_EQ(report.released.size(), 1u);
    const Real head = m.liquid.density * std::abs(gravity) * 0.5 * m.thickness;
    const Real at_start = filling_pressure(m, pore, 1.21).value + head - m.open(pore);
    EXPECT_GT(report.released[0].excess_pressure, 0);
    EXPECT_LT(report.released[0].excess_pressure, at_start);
    EXPECT_NEAR(report.released[0].flow, m.release_conductance(pore) * report.released[0].excess_pressure,
                1e-12 * report.released[0].flow);
  }
}

TEST(Supply, LiquidGoesBackWhereThePressureAboveIsLower) {
  WettingParams params;
  params.evaporation = false;
  params.sorption = SorptionModel::none;
  const WettingModel m = build_wetting_model(shirting(7, shirting_yarn(cotton_fibre())), params, {});
  Contents c = conditioned_contents(m, Air{});
  for (std::size_t i = 0; i < m.nodes(); ++i) c.liquid_kg[i] = m.liquid.density * m.volume(i) * (1 + 0.9 * m.overfill(i));
  const std::vector<FaceSupply> supplies{{.node = static_cast<Index>(m.segments + 10), .wetted_share = 1, .pressure = 0}};
  std::vector<Real> taken(1);
  const Real before = total_kg(m, c);
  const WettingReport report = step_wetting(m, c, supplies, taken, Air{}, {}, 1e-3);
  EXPECT_LT(taken[0], 0);
  EXPECT_NEAR(total_kg(m, c) + released_kg(report), before + taken[0], 1e-12 * before);
}

TEST(Hysteresis, HoldsTheStainBackAndKeepsTheMass) {
  // A short strip wetted at one end: with the receding angle on drainage the wet end lets go later.
  Real reach[2];
  for (const bool on : {false, true}) {
    WettingParams params;
    params.evaporation = false;
    params.sorption = SorptionModel::none;
    params.hysteresis = on;
    const WettingModel m = build_wetting_model(yarn_strip(80, 0.3e-3, shirting_yarn(polyester_fibre())), params, {});
    Contents c = conditioned_contents(m, Air{});
    for (std::size_t i = 0; i < 10; ++i) {
      c.liquid_kg[i] = m.liquid.density * m.volume(i);
      if (on) c.reached_saturation[i] = 1;
    }
    const Real before = total_kg(m, c);
    Real now = 0, dt = 1e-3;
    while (now < 600) {
      const WettingReport report = step_wetting(m, c, {}, {}, Air{}, {}, dt);
      ASSERT_TRUE(report.converged);
      now += dt;
      dt = report.suggested_step;
    }
    EXPECT_NEAR(total_kg(m, c), before, 1e-12 * before);
    std::size_t last = 0;
    for (std::size_t i = 0; i < 80; ++i) last = saturation(m, c, i) > 0.05 ? i : last;
    reach[on ? 1 : 0] = static_cast<Real>(last);
  }
  EXPECT_LT(reach[1], 0.8 * reach[0]);
}

TEST(Shells, AndTheLinearFormEndAtTheSameSorbedWater) {
  Real sorbed[2];
  for (const SorptionModel model : {SorptionModel::linear, SorptionModel::shells}) {
    WettingParams params;
    params.evaporation = false;
    params.sorption = model;
    const WettingModel m = build_wetting_model(yarn_strip(4, 1e-3, paper_yarn(wool_fibre())), params, {});
    Contents c = conditioned_contents(m, Air{});
    for (std::size_t i = 0; i < 4; ++i) c.liquid_kg[i] = m.liquid.density * m.volume(i);
    const Real before = total_kg(m, c);
    for (int i = 0; i < 50; ++i) step_wetting(m, c, {}, {}, Air{}, {}, 300);
    EXPECT_NEAR(total_kg(m, c), before, 1e-12 * before);
    EXPECT_NEAR(node_regain(m, c, 0), m.yarns[0].swelling_regain, 1e-3 * m.yarns[0].swelling_regain);
    sorbed[model == SorptionModel::shells ? 1 : 0] = total_sorbed_kg(m, c);
    if (model == SorptionModel::shells) {
      EXPECT_NEAR(mean_regain(m.shells, std::span(c.shell_regain).first(std::size_t(m.shells.count))),
                  node_regain(m, c, 0), 1e-9);
    }
  }
  EXPECT_NEAR(sorbed[0], sorbed[1], 1e-3 * sorbed[0]);
}

TEST(Monofilament, SorbsFromThePoresBesideItAndCarriesNothing) {
  WettingParams params;
  params.evaporation = false;
  YarnType yarn = paper_yarn(wool_fibre(65), 1);
  yarn.monofilament = true;
  const WettingModel m = build_wetting_model(paper_sheet(4, yarn), params, {});
  Contents c = conditioned_contents(m, Air{});
  for (std::size_t i = m.segments; i < m.nodes(); ++i) c.liquid_kg[i] = 0.8 * m.liquid.density * m.volume(i);
  const Real before = total_kg(m, c), sorbed = total_sorbed_kg(m, c);
  EXPECT_NEAR(saturation(m, c, 0), 0, 1e-12);  // conditioned is dry
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(step_wetting(m, c, {}, {}, Air{}, {}, 100).converged);
  EXPECT_GT(total_sorbed_kg(m, c), sorbed);
  EXPECT_GT(saturation(m, c, 0), 0);
  EXPECT_EQ(total_yarn_kg(m, c), 0);
  EXPECT_NEAR(total_kg(m, c), before, 1e-12 * before);
}

TEST(AsPrinted, WoolHoldsMoreAndPolyesterSpreadsFurtherAsTheEquationsLiterallySay) {
  WettingParams params;
  params.model = TransportModel::as_printed;
  params.evaporation = false;
  params.pores = false;  // eq. 7 by itself: pores hold far more than c_s and hide it
  Real taken[2], cells[2];
  for (const bool wool : {true, false}) {
    const YarnType yarn = paper_yarn(wool ? wool_fibre() : polyester_fibre());
    const WettingModel m = build_wetting_model(paper_sheet(30, yarn), params, {});
    Contents c = conditioned_contents(m, Air{});
    std::vector<FaceSupply> supplies;
    for (Index s = 0; s < m.segments; ++s) {
      if (squared_norm(m.centre[s]) < 9e-6) supplies.push_back({.node = s, .wetted_share = 1, .available_kg = 1});
    }
    std::vector<Real> given(supplies.size());
    Real dt = 1e-6, now = 0;
    Real total = 0;
    while (now < 5e-4) {
      const WettingReport report = step_wetting(m, c, supplies, given, Air{}, {}, dt);
      ASSERT_TRUE(report.converged);
      now += dt, dt = report.suggested_step, total += report.taken_kg;
    }
    taken[wool] = total;
    cells[wool] = 0;
    for (Index s = 0; s < m.segments; ++s) cells[wool] += saturation(m, c, s) > 0.05 ? 1 : 0;
  }
  EXPECT_GT(taken[1], taken[0]);
  EXPECT_GT(cells[0], cells[1]);
}

TEST(Build, NamesEverythingThatIsWrong) {
  YarnNetwork network = paper_sheet(3, paper_yarn(cotton_fibre()));
  network.pore_volume[1] = -1e-12;
  network.yarn_types[0].radius = 0;
  try {
    build_wetting_model(network, WettingParams{}, {.viscosity = 0});
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_EQ(error.problems().size(), 3u);
  }
}

}  // namespace
}  // namespace imbibe
