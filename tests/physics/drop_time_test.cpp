// How long a 50 uL drop stands on cloth, on the quickstart's own scene: documented parameters only.
#include <gtest/gtest.h>

#include "support/scene_runs.h"

namespace imbibe {
namespace {

// Scoured cotton shirting drinks such a drop in 1-10 s (the class that the AATCC 79 drop test calls absorbent). Its last film
// is one particle thick, so the end comes earlier with smaller ones: 0.018 mg 10.6 s, 0.012 mg (here) 10.0 s, 0.009 mg 9.6 s.
TEST(DropTime, OfFiftyMicrolitresOnScouredCottonIsTenSecondsAtMost) {
  const auto file = test::scenes_folder() / "quickstart" / "drop_on_cotton.yaml";
  World world = test::build(read_scene(file), file);
  test::run_until(world, 1);
  EXPECT_GT(mass_balance(world).free, 0.1 * world.ledger.supplied_kg);
  test::run_until(world, 10);
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
