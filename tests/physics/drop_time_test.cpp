// How long a 50 uL drop stands on cloth, on the quickstart's own scene: documented parameters only.
#include <gtest/gtest.h>

#include "support/scene_runs.h"

namespace imbibe {
namespace {

// Scoured cotton shirting drinks such a drop in 1-10 s (the class that the AATCC 79 drop test calls absorbent). After
// 10 s all but its last 0.5 % is gone; that rest, some ten particles on a full cloth, takes to 10.6 s.
TEST(DropTime, OfFiftyMicrolitresOnScouredCottonIsAboutTenSeconds) {
  const auto file = test::scenes_folder() / "quickstart" / "drop_on_cotton.yaml";
  World world = test::build(read_scene(file), file);
  test::run_until(world, 1);
  EXPECT_GT(mass_balance(world).free, 0.1 * world.ledger.supplied_kg);
  test::run_until(world, 10);
  EXPECT_LT(mass_balance(world).free, 5e-3 * world.ledger.supplied_kg);
  test::run_until(world, 11);
  const MassBalance b = mass_balance(world);
  EXPECT_LT(b.free, 1e-3 * b.supplied);
  EXPECT_LE(b.error(), 1e-10);
}

TEST(DropTime, OnRawCottonAndPolypropyleneNeverEnds) {
  for (const char* name : {"drop_on_raw_cotton", "drop_on_polypropylene"}) {
    const auto file = test::scenes_folder() / "extra" / (std::string(name) + ".yaml");
    World world = test::build(read_scene(file), file);
    test::run_until(world, 3);
    const MassBalance b = mass_balance(world);
    EXPECT_EQ(b.yarn + b.pore, 0) << name;
    EXPECT_GT(b.free, 0.999 * b.supplied) << name;  // vapour only
  }
}

}  // namespace
}  // namespace imbibe
