#include "imbibe/liquid/classes.h"

#include <gtest/gtest.h>

#include "imbibe/liquid/liquid_step.h"
#include "imbibe/liquid/source.h"

namespace imbibe {
namespace {

TEST(Classes, follow_the_colour_gradient) {
  EXPECT_EQ(particle_class(1.1f, 0.7f, 100), ParticleClass::liquid_vapour);
  EXPECT_EQ(particle_class(0.1f, 0.98f, 100), ParticleClass::inside);
  EXPECT_EQ(particle_class(0.1f, 0.98f, 0.5f), ParticleClass::liquid_solid);
  EXPECT_EQ(particle_class(0.8f, 0.6f, 0.5f), ParticleClass::liquid_vapour);  // the line is a free surface
}

TEST(Classes, of_a_resting_pool_are_its_layers) {
  // 12 x 12 x 25/3 spacings (12 layers) on a floor between four walls, after one step.
  Liquid liquid;
  const Real dx = 5e-4, half = 6 * dx;
  liquid.particle_mass = liquid.kind.density * dx * dx * dx;
  Source pool{.form = SourceForm::box, .centre = {0, 0, 25.0 / 6 * dx}, .size = {12 * dx, 12 * dx, 25.0 / 3 * dx}};
  emit(pool, liquid, 0, 1);
  const Shape shapes[] = {Plane{}, Plane{{-half, 0, 0}, {1, 0, 0}}, Plane{{half, 0, 0}, {-1, 0, 0}},
                          Plane{{0, -half, 0}, {0, 1, 0}}, Plane{{0, half, 0}, {0, -1, 0}}};
  std::vector<Wall> walls;
  for (const Shape& s : shapes) walls.push_back({&s, {}, {}, false});
  LiquidScratch scratch;
  step_liquid(liquid, {}, walls, {}, 1e-7, scratch);
  for (std::size_t i = 0; i < liquid.particles.size(); ++i) {
    const Float4& p = liquid.particles.position[i];
    const Real beside = half - std::max(std::abs(p.x), std::abs(p.y));
    if (beside < 3 * dx) continue;
    const ParticleClass wanted = p.z > 7.6 * dx   ? ParticleClass::liquid_vapour
                                 : p.z < 1 * dx ? ParticleClass::liquid_solid
                                                : ParticleClass::inside;
    EXPECT_EQ(liquid.particles.kind[i], wanted) << p.z / dx;
  }
}

}  // namespace
}  // namespace imbibe
