#include "imbibe/sim/step.h"

#include <gtest/gtest.h>

#include "imbibe/sim/run.h"

namespace imbibe {
namespace {

// Built by hand: sim does not know scenes. A pool-less world with a dropper over nothing.
World falling_drops(int count, Real interval) {
  World world;
  world.liquid.particle_mass = 1e-8;
  Source source;
  source.centre = {0, 0, 0.1};
  source.volume = 1e-9;
  source.interval = interval;
  source.count = count;
  world.sources.push_back(source);
  world.domain.include({-1, -1, 0});
  world.domain.include({1, 1, 1});
  return world;
}

TEST(Step, NoStepPassesOverADropsTimeAndMassIsSuppliedExactly) {
  World world = falling_drops(3, 0.04);  // 8 mm of fall clear the next drop's place
  run(world, {.until = 0.1, .every = 0, .max_steps = 0, .step = {}}, {});
  EXPECT_EQ(world.sources[0].emitted, 3);
  EXPECT_NEAR(world.ledger.supplied_kg, world.liquid.mass(), 1e-14 * world.ledger.supplied_kg);  // rounding of a sum
  EXPECT_NEAR(world.ledger.supplied_kg, 3e-9 * world.liquid.kind.density, 0.5 * world.liquid.particle_mass);
}

TEST(Step, ADropWhoseTimeIsARoundedSumMakesNoVanishingStep) {
  World world = falling_drops(4, 0.1 / 3);
  Real shortest = 1;
  RunHooks hooks;
  hooks.after_step = [&](const World&, const StepReport& report) { shortest = std::min(shortest, report.step_s); };
  run(world, {.until = 0.11, .every = 0.01, .max_steps = 0, .step = {}}, hooks);
  EXPECT_EQ(world.sources[0].emitted, 4);
  EXPECT_GT(shortest, 1e-9);
}

TEST(Step, ParticlesOutsideTheDomainLeaveAndStayInTheBooks) {
  World world = falling_drops(1, 0);
  world.sources[0].velocity = {0, 0, -5};
  run(world, {.until = 0.03, .every = 0, .max_steps = 0, .step = {}}, {});
  EXPECT_EQ(world.liquid.particles.size(), 0u);
  EXPECT_NEAR(world.ledger.left_kg, world.ledger.supplied_kg, 1e-14 * world.ledger.supplied_kg);  // rounding of a sum
  EXPECT_LE(mass_balance(world).error(), 1e-14);
}

TEST(Run, WritesOutputsAtExactMultiplesAndAtTheEnd) {
  World world;
  std::vector<Real> times;
  RunHooks hooks;
  hooks.at_output = [&](const World& w, const StepReport&) { times.push_back(w.time); };
  run(world, {.until = 0.25, .every = 0.1, .max_steps = 0, .step = {}}, hooks);
  ASSERT_EQ(times.size(), 4u);
  EXPECT_EQ(times[0], 0);
  EXPECT_EQ(times[1], 0.1);
  EXPECT_EQ(times[2], 0.2);
  EXPECT_EQ(times[3], 0.25);
}

TEST(Run, ADropARoundingErrorBeforeAnOutputDoesNotTakeItsPlace) {
  World world = falling_drops(1, 0);
  world.sources[0].start = 0.3;  // 3 x 0.1 is the next larger number
  ASSERT_LT(world.sources[0].start, 3 * 0.1);
  std::vector<Real> times;
  RunHooks hooks;
  hooks.at_output = [&](const World& w, const StepReport&) { times.push_back(w.time); };
  run(world, {.until = 0.42, .every = 0.1, .max_steps = 0, .step = {}}, hooks);
  ASSERT_EQ(times.size(), 6u);
  for (std::size_t k = 0; k < 5; ++k) EXPECT_NEAR(times[k], 0.1 * static_cast<Real>(k), 1e-15);  // rounding
}

TEST(Run, StopsWhenAskedAfterAWholeStep) {
  World world = falling_drops(1, 0);
  int steps = 0;
  RunHooks hooks;
  hooks.after_step = [&](const World&, const StepReport&) { ++steps; };
  hooks.stop_requested = [&] { return steps == 3; };
  EXPECT_EQ(run(world, {.until = 1, .every = 0, .max_steps = 0, .step = {}}, hooks), RunEnd::stopped);
  EXPECT_EQ(world.step, 3u);
}

}  // namespace
}  // namespace imbibe
