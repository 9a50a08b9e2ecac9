// The shape of a stain follows the cloth: a fifth of the particles, the first seconds.
#include <gtest/gtest.h>

#include "imbibe/sim/measures.h"
#include "support/scene_runs.h"

namespace imbibe {
namespace {

struct Extents {
  Real warp = 0, weft = 0;
};

Extents extents(const World& world) {
  const TextileMeasures m = measure(world.textiles[0], world.air);
  return {m.extent_warp, m.extent_weft};
}

World started(const std::string& name) {
  const auto file = test::scenes_folder() / "extra" / (name + ".yaml");
  Scene scene = read_scene(file);
  *scene.liquid.particle_mass *= 5;
  return test::build(scene, file);
}

TEST(StainShape, OfCottonWarpAndPolypropyleneWeftGrowsAlongTheWarp) {
  World world = started("hydrophobic_weft");
  test::run_until(world, 0.6);  // the footprint is wetted: its pores and the warp under it
  const Extents early = extents(world);
  test::run_until(world, 2.5);
  const Extents late = extents(world);
  EXPECT_GT(late.warp - early.warp, 4e-3);
  // A step of the extent is one pitch, 0.33 mm; a quarter of the growth along the warp is at least 1 mm.
  EXPECT_LE(late.weft - early.weft, 0.25 * (late.warp - early.warp));
}

TEST(StainShape, OfADenseWeftIsLongerAlongTheWeft) {
  World world = started("dense_weft");
  test::run_until(world, 2.5);
  const Extents late = extents(world);
  EXPECT_GT(late.weft, 1.1 * late.warp);
}

}  // namespace
}  // namespace imbibe
