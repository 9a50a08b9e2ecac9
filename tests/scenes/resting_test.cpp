// Liquid at rest makes no SPH steps and still feeds the cloth; without liquid the network runs alone.
#include <gtest/gtest.h>

#include "support/scene_runs.h"

namespace imbibe {
namespace {

struct Counts {
  std::uint64_t moving = 0, still = 0, taken_while_still = 0;
};

Counts run_and_count(World& world, Real until) {
  Counts counts;
  RunHooks hooks;
  hooks.after_step = [&](const World&, const StepReport& report) {
    (report.liquid_moved ? counts.moving : counts.still) += 1;
    if (!report.liquid_moved) counts.taken_while_still += report.absorbed;
  };
  run(world, {.until = until, .every = 0, .max_steps = 0, .step = {}}, hooks);
  return counts;
}

TEST(Resting, ADropOnRejectingClothComesToRestAndCostsNoLiquidSteps) {
  World world = test::build_small_drop({"textiles[0].contact_angle=110 deg", "textiles[0].receding_angle=90 deg"});
  run_and_count(world, 0.4);
  ASSERT_TRUE(world.pace.resting);
  const Counts later = run_and_count(world, 0.8);
  EXPECT_EQ(later.moving, 0u);
  EXPECT_GT(later.still, 0u);
}

TEST(Resting, ADropOnCottonIsTakenUpWhollyAlsoWhileItRests) {
  World world = test::build_small_drop();
  const Counts counts = run_and_count(world, 3);
  EXPECT_GT(counts.taken_while_still, 0u);
  EXPECT_EQ(world.liquid.particles.size(), 0u);
  const MassBalance b = mass_balance(world);
  EXPECT_LE(b.error(), 1e-10);
  // Nothing stays on the face: less than a thousandth of a particle.
  EXPECT_LT(b.free, 1e-3 * world.liquid.particle_mass);
}

}  // namespace
}  // namespace imbibe
