// Seed A, figure 7, in short form: an eighth of the particles, half a second.
#include <gtest/gtest.h>

#include "imbibe/sim/measures.h"
#include "imbibe/sim/mechanism.h"
#include "support/scene_runs.h"

namespace imbibe {
namespace {

struct Outcome {
  Real taken = 0, wet_area = 0, balance = 0;
  std::vector<std::string> mechanism;
};

Outcome outcome(const std::string& name) {
  const auto file = test::scenes_folder() / "seed_a" / (name + ".yaml");
  Scene scene = read_scene(file);
  *scene.liquid.particle_mass *= 8;
  World world = test::build(scene, file);
  test::run_until(world, 0.5);
  const MassBalance b = mass_balance(world);
  const TextileMeasures m = measure(world.textiles[0], world.air);
  return {b.yarn + b.pore, m.wet_area, b.error(), explain_uptake(world)};
}

TEST(Figure7, ShrinkProofedWoolHoldsMoreAndSpreadsFurtherThanPolyesterAtEqualTimes) {
  const Outcome wool = outcome("fig07_wool"), polyester = outcome("fig07_polyester");
  EXPECT_GT(wool.taken, polyester.taken);
  EXPECT_GT(wool.wet_area, polyester.wet_area);
  EXPECT_LE(wool.balance, 1e-10);
  EXPECT_LE(polyester.balance, 1e-10);
}

TEST(Figure7, UntreatedWoolTakesNoneAndTheReportSaysWhy) {
  const Outcome untreated = outcome("fig07_wool_untreated");
  EXPECT_EQ(untreated.taken, 0);
  EXPECT_EQ(untreated.wet_area, 0);
  ASSERT_FALSE(untreated.mechanism.empty());
  EXPECT_NE(untreated.mechanism[0].find("no capillary entry"), std::string::npos) << untreated.mechanism[0];
  EXPECT_NE(untreated.mechanism[0].find("break through"), std::string::npos) << untreated.mechanism[0];
}

}  // namespace
}  // namespace imbibe
