// The shape of a stain follows the cloth: half of the particles, the first seconds.
#include <gtest/gtest.h>

#include <algorithm>

#include "imbibe/sim/measures.h"
#include "support/scene_runs.h"

namespace imbibe {
namespace {

struct Extents {
  Real warp = 0, weft = 0;
};

// Of the stain itself: what the outer 2 % of the wet segments on either side say is left out, since a satellite of the
// splash that falls beside the stain would be its extent.
Real extent(std::vector<Real> at) {
  std::sort(at.begin(), at.end());
  const std::size_t out = at.size() / 50;
  return at.empty() ? 0 : at[at.size() - 1 - out] - at[out];
}

Extents extents(const World& world) {
  const Textile& textile = world.textiles[0];
  const std::vector<Real> saturation = node_saturations(textile, world.air);
  std::vector<Real> along_weft, along_warp;
  for (std::size_t s = 0; s < textile.fabric->network.segments(); ++s) {
    if (!textile.model->yarns[textile.model->segment_type[s]].wets) continue;  // sorbs vapour, carries nothing
    if (saturation[s] <= MeasureParams{}.wet_saturation) continue;
    along_weft.push_back(textile.fabric->network.node_centre(s).x);
    along_warp.push_back(textile.fabric->network.node_centre(s).y);
  }
  return {extent(along_warp), extent(along_weft)};
}

World started(const std::string& name, Real coarser) {
  const auto file = test::scenes_folder() / "extra" / (name + ".yaml");
  Scene scene = read_scene(file);
  *scene.liquid.particle_mass *= coarser;
  return test::build(scene, file);
}

TEST(StainShape, OfCottonWarpAndPolypropyleneWeftGrowsAlongTheWarp) {
  World world = started("hydrophobic_weft", 2);
  test::run_until(world, 0.4);  // the drop has spread as far as it will and has drawn back: its footprint is wetted
  const Extents early = extents(world);
  test::run_until(world, 3);
  const Extents late = extents(world);
  EXPECT_GT(late.warp - early.warp, 8e-3);
  // A step of the extent is one pitch, 0.33 mm; a quarter of the growth along the warp some 2.5 mm.
  EXPECT_LE(late.weft - early.weft, 0.25 * (late.warp - early.warp));
}

TEST(StainShape, OfADenseWeftIsLongerAlongTheWeft) {
  World world = started("dense_weft", 2);
  test::run_until(world, 2.5);
  const Extents late = extents(world);
  EXPECT_GT(late.weft, 1.1 * late.warp);
}

}  // namespace
}  // namespace imbibe
