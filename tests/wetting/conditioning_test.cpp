#include "imbibe/wetting/conditioning.h"

#include <gtest/gtest.h>

#include <numeric>

#include "imbibe/core/error.h"
#include "imbibe/wetting/isotherm.h"
#include "support/hand_networks.h"

namespace imbibe {
namespace {

using testing::cotton_fibre;
using testing::wool_fibre;

// A warp and a weft yarn type; all that conditioning looks at.
WettingModel two_fibres(const Fibre& warp, const Fibre& weft, SorptionModel sorption = SorptionModel::linear) {
  WettingModel model;
  model.params.sorption = sorption;
  model.fibres = {warp, weft};
  NodeKind a, b;
  a.type = 0, b.type = 1;
  a.dry_mass = 2e-6, b.dry_mass = 3e-6;
  a.volume = b.volume = 1e-12;
  model.kinds = {a, b};
  model.segments = 4;
  model.kind = {0, 1, 0, 1};
  model.segment_type = {0, 1, 0, 1};
  if (sorption == SorptionModel::shells) model.shells = build_radial_shells(6);
  return model;
}

TEST(Conditioning, OneFibreFollowsItsIsotherm) {
  const WettingModel model = two_fibres(cotton_fibre(), cotton_fibre());
  for (const Real phi : {0.0, 0.2, 0.65, 1.0}) {
    const Real regain = regain_in_balance(model, phi);
    EXPECT_NEAR(regain, equilibrium_regain(cotton_fibre(), phi), 1e-15);
    EXPECT_NEAR(humidity_in_balance(model, regain), phi, 1e-12);
  }
}

TEST(Conditioning, TwoFibresStandInBalanceWithOneAirAndTheClothHasTheRegain) {
  const WettingModel model = two_fibres(cotton_fibre(), wool_fibre());
  const Real phi = humidity_in_balance(model, 0.1);
  Contents contents = conditioned_contents(model, Air{.humidity = 0.3});
  condition_dry_fibres(model, contents, phi);
  EXPECT_NEAR(node_regain(model, contents, 0), equilibrium_regain(cotton_fibre(), phi), 1e-15);
  EXPECT_NEAR(node_regain(model, contents, 1), equilibrium_regain(wool_fibre(), phi), 1e-15);
  EXPECT_NEAR(std::accumulate(contents.sorbed_kg.begin(), contents.sorbed_kg.end(), 0.0) / 1e-5, 0.1, 1e-13);
}

TEST(Conditioning, TheAirGivesWhatTheFibresGain) {
  for (const SorptionModel sorption : {SorptionModel::linear, SorptionModel::shells}) {
    const WettingModel model = two_fibres(cotton_fibre(), wool_fibre(), sorption);
    Contents contents = conditioned_contents(model, Air{.humidity = 0.65});
    contents.liquid_kg[1] = 1e-9;  // liquid holds this one where it is
    const Contents before = contents;
    for (const Real phi : {0.9, 0.1}) {
      const Real was = total_sorbed_kg(model, contents);
      const Real from_air = condition_dry_fibres(model, contents, phi);
      EXPECT_NEAR(total_sorbed_kg(model, contents) - was, from_air, 1e-20);
      EXPECT_GT((phi > 0.65 ? 1 : -1) * from_air, 0);
      EXPECT_EQ(contents.sorbed_kg[1], before.sorbed_kg[1]);
      EXPECT_EQ(contents.liquid_kg, before.liquid_kg);
    }
    const auto n = static_cast<std::size_t>(model.shells.count);
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_EQ(contents.shell_regain[i], equilibrium_regain(cotton_fibre(), 0.1)) << "shells are even";
      EXPECT_EQ(contents.shell_regain[n + i], before.shell_regain[n + i]);
    }
  }
}

TEST(Conditioning, MoreThanSaturatedAirGivesIsRefused) {
  const WettingModel model = two_fibres(cotton_fibre(), cotton_fibre());
  EXPECT_NO_THROW(humidity_in_balance(model, regain_in_balance(model, 1)));
  EXPECT_THROW(humidity_in_balance(model, 1.001 * regain_in_balance(model, 1)), InputError);
}

}  // namespace
}  // namespace imbibe
