// Every shipped scene in short form: a coarser liquid and the first milliseconds after it touches the cloth.
#include <gtest/gtest.h>

#include <filesystem>

#include "imbibe/sim/measures.h"
#include "support/scene_runs.h"

namespace imbibe {
namespace {

class ShippedScene : public testing::TestWithParam<std::string> {};

TEST_P(ShippedScene, KeepsItsBooksAndBoundsInShortForm) {
  const auto file = test::scenes_folder() / GetParam();
  Scene scene = read_scene(file);
  // An eighth of the particles halves the resolution; what is checked here does not depend on it.
  if (scene.liquid.particle_mass) *scene.liquid.particle_mass *= 8;
  const Real until = std::min(scene.duration, 0.03);  // the first drop of every scene touches within it
  World world = test::build(scene, file);
  int rows = 0;
  RunHooks hooks;
  hooks.at_output = [&](const World& now, const StepReport&) {
    ++rows;
    EXPECT_LE(mass_balance(now).error(), 1e-10);
    for (const Float4& x : now.liquid.particles.position) ASSERT_TRUE(std::isfinite(x.x + x.y + x.z));
    for (const Float4& v : now.liquid.particles.velocity) ASSERT_TRUE(std::isfinite(v.x + v.y + v.z));
    for (const Textile& textile : now.textiles)
      for (std::size_t k = 0; k < textile.fabric->network.nodes(); ++k) {
        const Real s = saturation(*textile.model, textile.contents, k);
        ASSERT_GE(s, -1e-30);  // an emptied node keeps the rounding of its last flow
        // The stated over-full share of the node: a bulging meniscus.
        ASSERT_LE(s, 1 + textile.model->overfill(k) * (1 + 1e-6) + 1e-9);
      }
  };
  run(world, {.until = until, .every = until / 4, .max_steps = 0, .step = {}}, hooks);
  EXPECT_EQ(rows, 5);
  EXPECT_DOUBLE_EQ(world.time, until);
}

std::string test_name(const testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, ShippedScene, testing::ValuesIn(test::shipped_scenes()), test_name);

}  // namespace
}  // namespace imbibe
