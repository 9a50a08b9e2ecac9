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

// What is too much drips off or hangs there; then cells, sheet and liquid rest, and steps are as long as nothing happens.
TEST(Resting, AClothOfOverFullCellsComesToRest) {
  World world = build_world(read_scene(std::string(IMBIBE_SOURCE_DIR) + "/scenes/cloth/wet_and_dry.yaml",
                                       {"textiles[0].size=[150 mm, 150 mm]", "textiles[0].sheet.soft.columns=12",
                                        "textiles[0].sheet.soft.rows=12", "air.mass_transfer=0"}),
                            read_library({IMBIBE_SOURCE_DIR}));
  world.sources.clear();
  CellCloth& cloth = world.cell_cloths[0];
  for (std::size_t c = 0; c < cloth.grid->cells(); ++c) {
    const Vec3 at = cloth.grid->centre(c);
    if (norm(at - Vec3{0.075, 0.075, 0}) > 0.06) continue;
    for (int k = 0; k < 20; ++k) add_parcel(*cloth.grid, cloth.contents, at.x, at.y, 0.08 * cloth.grid->capacity(c));
  }
  weigh(cloth);
  world.ledger.initial_kg = cell_kg(cloth);
  run_and_count(world, 40);  // all that is wet drains through the lowest cell
  EXPECT_GT(cloth.released_particles, 0u);
  EXPECT_TRUE(cloth.soft.at_rest);
  EXPECT_FALSE(leaks(cloth));
  const std::uint64_t released = cloth.released_particles, absorbed = cloth.absorbed_particles;
  const std::vector<Real> contents = cloth.contents.content_kg;
  const Counts later = run_and_count(world, 60);
  EXPECT_LE(later.moving + later.still, 100u);
  EXPECT_EQ(later.moving, 0u);
  EXPECT_EQ(cloth.released_particles, released);
  EXPECT_EQ(cloth.absorbed_particles, absorbed);
  EXPECT_TRUE(cloth.soft.at_rest);
  for (std::size_t c = 0; c < contents.size(); ++c)
    EXPECT_NEAR(cloth.contents.content_kg[c], contents[c], 0.02 * cloth.grid->capacity(c)) << c;
  EXPECT_LE(mass_balance(world).error(), 1e-10);
}

}  // namespace
}  // namespace imbibe
