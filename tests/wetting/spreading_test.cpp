// How far liquid gets: Barenblatt's late spreading of a slug, and the strip constants of real yarns in cloth.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "imbibe/wetting/wetting_step.h"
#include "support/hand_networks.h"

namespace imbibe {
namespace {

using testing::cotton_fibre;
using testing::plain_weave;
using testing::polyester_fibre;
using testing::polypropylene_fibre;
using testing::shirting;
using testing::shirting_yarn;
using testing::transport_only;
using testing::wool_fibre;
using testing::yarn_strip;

TEST(Spreading, OfASlugFollowsBarenblattsExponent) {
  // Brooks-Corey makes D ~ s^m with m = 2 + 1/lambda; a slug on a line then has the half width ~ t^(1/(m + 2)).
  for (const Real lambda : {2.0, 5.0}) {
    WettingParams params = transport_only();
    params.yarn_size_index = lambda;
    const std::size_t count = 401;
    const WettingModel m = build_wetting_model(yarn_strip(count, 0.1e-3, shirting_yarn(cotton_fibre())), params, {});
    Contents c = conditioned_contents(m, Air{});
    const std::size_t middle = count / 2;
    for (std::size_t i = middle - 6; i <= middle + 6; ++i) c.liquid_kg[i] = 0.9 * m.liquid.density * m.volume(i);
    const auto width = [&] {
      Real moment = 0, mass = 0;
      for (std::size_t i = 0; i < count; ++i) {
        const Real x = m.centre[i].x - m.centre[middle].x;
        moment += c.liquid_kg[i] * x * x, mass += c.liquid_kg[i];
      }
      return std::sqrt(moment / mass);
    };
    Real now = 0, early = 0;
    const auto advance = [&](Real end) {
      while (now < end) {
        const Real dt = std::min(end - now, 1e-3 + 0.01 * now);
        ASSERT_TRUE(step_wetting(m, c, {}, {}, Air{}, {}, dt).converged);
        now += dt;
      }
    };
    advance(30);
    early = width();
    advance(300);
    // 2 %: what the slug remembers of its first shape at 30 s, and steps of 1 % of the time.
    const Real exponent = std::log10(width() / early), law = 1 / (4 + 1 / lambda);
    EXPECT_NEAR(exponent, law, 0.02 * law) << lambda;
    EXPECT_EQ(c.liquid_kg.front(), 0);
  }
}

// Front after `time` in a strip of shirting dipped at one end, m.
Real strip_front(const Fibre& fibre, Real packing, Real time) {
  const YarnType yarn = shirting_yarn(fibre, packing);
  const WettingModel m =
      build_wetting_model(plain_weave(60, 6, 1.0 / 3000, 1.0 / 2800, yarn, yarn), transport_only(), {});
  Contents c = conditioned_contents(m, Air{});
  Real left = 1e9;
  for (const Vec3& x : m.centre) left = std::min(left, x.x);
  std::vector<FaceSupply> supplies;
  for (std::size_t i = 0; i < m.nodes(); ++i) {
    if (m.centre[i].x < left + 0.2e-3) {
      supplies.push_back({.node = static_cast<Index>(i), .wetted_share = 1, .available_kg = 1});
    }
  }
  std::vector<Real> taken(supplies.size());
  Real now = 0, dt = 1e-4;
  while (now < time) {
    dt = std::min({dt, time - now, Real(0.2)});
    const WettingReport report = step_wetting(m, c, supplies, taken, Air{}, {0, 0, -9.81}, dt);
    EXPECT_TRUE(report.converged);
    now += dt;
    dt = report.suggested_step;
  }
  Real front = 0;
  for (std::size_t i = 0; i < m.segments; ++i) {
    if (saturation(m, c, i) > 0.05) front = std::max(front, m.centre[i].x - left);
  }
  return front;
}

TEST(Strip, ConstantsOfShirtingLieInTheDocumentedBandInTheDocumentedOrder) {
  const Real time = 8;
  const auto constant = [&](const Fibre& fibre, Real packing) {
    return strip_front(fibre, packing, time) * 1e3 / std::sqrt(time);  // mm/s^0.5
  };
  const Real cotton = constant(cotton_fibre(), 0.55), wool = constant(wool_fibre(65), 0.50);
  const Real polyester = constant(polyester_fibre(), 0.55);
  for (const Real k : {cotton, wool, polyester}) {
    EXPECT_GE(k, 1);
    EXPECT_LE(k, 5);
  }
  EXPECT_GT(cotton, wool);
  EXPECT_GT(wool, polyester);
  EXPECT_EQ(constant(wool_fibre(100), 0.50), 0);
  EXPECT_EQ(constant(cotton_fibre(95), 0.55), 0);
  EXPECT_EQ(constant(polypropylene_fibre(), 0.55), 0);
}

TEST(Pores, DoNotPassLiquidToEachOtherBelowTheOpeningPressure) {
  const WettingModel m = build_wetting_model(shirting(5, shirting_yarn(wool_fibre(100))), transport_only(), {});
  Contents c = conditioned_contents(m, Air{});
  const std::size_t pore = m.segments + 5;
  c.liquid_kg[pore] = 0.9 * m.liquid.density * m.volume(pore);
  const Real held = c.liquid_kg[pore];
  ASSERT_GT(node_pressure(m, c, pore), 0);
  ASSERT_LT(node_pressure(m, c, pore), m.open(pore));
  const WettingReport report = step_wetting(m, c, {}, {}, Air{}, {}, 60);
  EXPECT_EQ(c.liquid_kg[pore], held);
  EXPECT_TRUE(report.released.empty());
}

}  // namespace
}  // namespace imbibe
