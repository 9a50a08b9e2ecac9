// Droplets of some ten particles, less than anything can be resolved with: what a splash leaves beside a drop. They need not
// have an angle, but they must come down to a wall and lie there.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "imbibe/liquid/liquid_step.h"
#include "imbibe/liquid/source.h"

namespace imbibe {
namespace {

struct Droplet {
  Liquid liquid;
  Shape plane = Plane{};
  Wall wall{&plane, {}, {}, false};
  LiquidParams params;
  LiquidScratch scratch;

  Droplet(int particles, Real height) {
    liquid.particle_mass = 0.012e-6;
    wall.material.contact_angle = 60 * pi / 180;
    Source drop;
    drop.volume = particles * liquid.particle_mass / liquid.kind.density;
    drop.centre = {0, 0, height};
    emit(drop, liquid, 0, 1);
  }
  void run(Real seconds) {
    for (Real time = 0; time < seconds;) time += step_liquid(liquid, params, {&wall, 1}, {0, 0, -9.81}, 1, scratch).step_s;
  }
  std::vector<Real> heights() const {
    std::vector<Real> z;
    for (const Float4& x : liquid.particles.position) z.push_back(x.z / liquid.spacing());
    return z;
  }
};

TEST(Droplet, comes_down_to_a_wall_and_does_not_hover_over_it) {
  for (const int particles : {10, 13, 16}) {
    Droplet d(particles, 0.45e-3);
    ASSERT_NEAR(d.liquid.particles.size(), particles, 1);
    d.run(60e-3);
    // Its particles lie in one or two layers; droplets that hovered had the lowest one and a half spacings high and their mean at two.
    const std::vector<Real> z = d.heights();
    Real mean = 0;
    for (const Real height : z) mean += height / static_cast<Real>(z.size());
    std::printf("  %d particles: lowest %.2f, mean %.2f spacings high\n", particles, *std::min_element(z.begin(), z.end()), mean);
    EXPECT_LT(mean, 1.3) << particles;
  }
}

}  // namespace
}  // namespace imbibe
