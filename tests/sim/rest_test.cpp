#include "imbibe/sim/rest.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "imbibe/sim/run.h"
#include "imbibe/sim/step.h"

namespace imbibe {
namespace {

constexpr int side = 6, layers = 4, pool_particles = side * side * layers;

// A block of liquid that fills a trough of five boxes, level from the start.
World calm_pool() {
  World world;
  world.liquid.particle_mass = 1e-6;  // spacing 1 mm
  world.liquid_params.surface_tension = false;
  const Real dx = world.liquid.spacing(), half = 0.5 * side * dx;
  const auto wall = [&](const Vec3& centre, const Vec3& size) {
    SolidBody body;
    body.shape = Box{centre, size};
    world.solids.push_back(body);
  };
  wall({0, 0, -0.01}, {0.1, 0.1, 0.02});
  for (const Real sign : {-1.0, 1.0}) {
    wall({sign * (half + 0.01), 0, 0.02}, {0.02, 0.1, 0.04});
    wall({0, sign * (half + 0.01), 0.02}, {0.1, 0.02, 0.04});
  }
  const auto at = [&](int i) { return (i + 0.5) * dx; };
  for (int k = 0; k < layers; ++k)
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) add_particle(world.liquid, {at(i) - half, at(j) - half, at(k)}, {});
  world.domain.include({-1, -1, -30});
  world.domain.include({1, 1, 1});
  return world;
}

TEST(Rest, BlobsAreFoundWithWhatHoldsThemAndTheirVelocity) {
  World world = calm_pool();
  const Real dx = world.liquid.spacing();
  for (int k = 0; k < 27; ++k)
    add_particle(world.liquid, Vec3{0.06, 0, 0.5} + dx * Vec3{Real(k % 3), Real(k / 3 % 3), Real(k / 9)}, {});
  StepScratch scratch;
  step(world, {.until = 1e-4}, scratch);
  std::vector<Blob> blobs = find_blobs(scratch.liquid.fields, world.liquid.particles);
  ASSERT_EQ(blobs.size(), 2u);
  if (blobs[0].particles == 27) std::swap(blobs[0], blobs[1]);
  EXPECT_EQ(blobs[0].particles, pool_particles);
  EXPECT_EQ(blobs[1].particles, 27u);
  EXPECT_TRUE(blobs[0].held);
  EXPECT_FALSE(blobs[1].held);
  // Free fall; pressure acts inside the droplet only. Velocities are in single precision.
  EXPECT_NEAR(blobs[1].velocity.z, -9.81 * world.time, 1e-5 * 9.81 * world.time);
}

TEST(Rest, AParticleJustLetGoIsNotFrozenInTheAirBesideLiquidThatRests) {
  World world = calm_pool();
  StepScratch scratch;
  while (!world.pace.resting && world.time < 1) step(world, {.until = 1}, scratch);
  ASSERT_TRUE(world.pace.resting);
  // As the step does when the textile gives off a particle: so near that centre and extents of all the liquid hardly
  // change, two spacings above the pool.
  const Real dx = world.liquid.spacing(), height = (layers + 1.5) * dx;
  const Index id = add_particle(world.liquid, {0, 0, height}, {});
  world.pace.resting = false;
  const Real start = world.time, fall = 5e-3, longest = 1e-4;
  while (world.time < start + fall) step(world, {.until = start + fall, .max_step = longest}, scratch);
  EXPECT_FALSE(world.pace.resting);
  const Particles& p = world.liquid.particles;
  const auto at = static_cast<std::size_t>(std::find(p.id.begin(), p.id.end(), id) - p.id.begin());
  // Not exactly free fall: the pool lies within its support radius and its density correction moves the particle by up to a
  // third of the fall either way, by how the pool's top layer lies. Frozen would be 0.
  EXPECT_LT(p.position[at].z, height - 0.5 * 0.5 * 9.81 * fall * fall);
}

}  // namespace
}  // namespace imbibe
