// A fixed cloth may lean: what matters is how cloth, liquid and gravity lie to each other.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include "imbibe/sim/measures.h"
#include "support/scene_runs.h"

namespace imbibe {
namespace {

std::string list(const Vec3& v, const std::string& unit) {
  return fmt::format("[{:.12g} {}, {:.12g} {}, {:.12g} {}]", v.x, unit, v.y, unit, v.z, unit);
}

Real taken_up_in_40_ms(const std::vector<std::string>& overrides) {
  World world = test::build_small_drop(overrides);
  test::run_until(world, 0.04);
  const MassBalance b = mass_balance(world);
  EXPECT_LE(b.error(), 1e-10);
  return b.yarn + b.pore;
}

TEST(TurnedCloth, TakesUpAsMuchWhenLiquidAndGravityTurnWithIt) {
  const Vec3 u = normalized(Vec3{2, 1, -1}), v = normalized(cross(Vec3{0.3, 0, 1}, u)), n = cross(u, v);
  const Real straight = taken_up_in_40_ms({});
  const Real turned = taken_up_in_40_ms(
      {"textiles[0].weft_direction=" + list(u, ""), "textiles[0].warp_direction=" + list(v, ""),
       "gravity=" + list(-9.81 * n, "m/s2"), "liquid.drops[0].centre=" + list(1.2 * n, "mm"),
       "liquid.drops[0].velocity=" + list(-0.1 * n, "m/s")});
  EXPECT_GT(straight, 0.2e-6);
  // The lattice on which the drop's 190 particles lie at the start does not turn.
  EXPECT_NEAR(turned, straight, 0.04 * straight);
}

}  // namespace
}  // namespace imbibe
