// A drop on layers of cloth that lie on each other.
#include <gtest/gtest.h>

#include "support/scene_runs.h"

namespace imbibe {
namespace {

// The stack is centred at z = 0, so each further layer lifts its face by half a layer (0.34 mm thick): the drop too.
Real lift(int layers) { return 0.18e-3 * (layers - 1); }

World drop_on_layers(std::vector<LayerSpec> layers) {
  Scene scene = test::small_drop();
  int count = 0;
  for (const LayerSpec& layer : layers) count += layer.count;
  scene.liquid.drops[0].centre.z += lift(count);
  scene.textiles[0].fabric.layers = std::move(layers);
  return test::build(scene, test::scenes_folder() / "small_drop.yaml");
}

Real layer_kg(const World& world, int layer) {
  const Textile& textile = world.textiles[0];
  Real sum = 0;
  for (std::size_t node = 0; node < textile.model->nodes(); ++node)
    if (textile.fabric->network.layer_of(node) == layer) sum += textile.contents.liquid_kg[node];
  return sum;
}

TEST(Layers, ADropReachesTheLowerLayerLaterAndWithLess) {
  World world = drop_on_layers({{.count = 2, .fibre = ""}});
  test::run_until(world, 0.012);
  const Real drop = world.ledger.supplied_kg;
  EXPECT_GT(layer_kg(world, 0), 1e-3 * drop);  // it has touched
  EXPECT_LT(layer_kg(world, 1), 0.05 * layer_kg(world, 0));
  Real last = layer_kg(world, 1);
  for (const Real time : {0.05, 0.1, 0.2, 0.4}) {
    test::run_until(world, time);
    EXPECT_GT(layer_kg(world, 1), last);
    EXPECT_LT(layer_kg(world, 1), layer_kg(world, 0));
    EXPECT_LE(mass_balance(world).error(), 1e-10);
    last = layer_kg(world, 1);
  }
  EXPECT_GT(last, 0.02 * drop);
}

TEST(Layers, BelowARejectingLayerTheClothStaysDry) {
  World world = drop_on_layers({{.count = 1, .fibre = ""}, {.count = 1, .fibre = "polypropylene"}, {.count = 1, .fibre = ""}});
  test::run_until(world, 0.3);
  EXPECT_GT(layer_kg(world, 0), 0.3 * world.ledger.supplied_kg);
  EXPECT_EQ(layer_kg(world, 1), 0);
  EXPECT_EQ(layer_kg(world, 2), 0);
  EXPECT_LE(mass_balance(world).error(), 1e-10);
}

TEST(Layers, UnderneathLiquidTouchesTheLowestLayer) {
  Scene scene = test::small_drop();
  scene.textiles[0].fabric.layers = {{.count = 2, .fibre = ""}};
  scene.liquid.drops[0].centre.z = -(scene.liquid.drops[0].centre.z + lift(2));
  scene.liquid.drops[0].velocity.z = 0.3;
  scene.gravity = {0, 0, 0};
  World world = test::build(scene, test::scenes_folder() / "small_drop.yaml");
  test::run_until(world, 0.012);
  EXPECT_GT(layer_kg(world, 1), 1e-3 * world.ledger.supplied_kg);
  EXPECT_LT(layer_kg(world, 0), 0.05 * layer_kg(world, 1));
}

}  // namespace
}  // namespace imbibe
