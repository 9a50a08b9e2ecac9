// Pipes: rate, aim, places.
#include <gtest/gtest.h>

#include "imbibe/liquid/source.h"

namespace imbibe {
namespace {

Source pipe() {
  Source s;
  s.form = SourceForm::pipe;
  s.centre = {0.1, 0.2, 0.3};
  s.velocity = {0.6, 0, -0.8};
  s.radius = 0.02, s.length = 0.05;
  s.interval = 1.0 / 300, s.count = 601;
  return s;
}

Liquid liquid() {
  Liquid l;
  l.particle_mass = 8e-6;
  return l;
}

TEST(Pipe, LetsGoAtItsRateWhateverTheSteps) {
  for (const Real step : {1e-3, 7e-3, 0.1}) {
    Source s = pipe();
    Liquid l = liquid();
    Real now = 0;
    while (now < 1 - 1e-9) {
      emit(s, l, now, now + 1e-9);
      for (Float4& x : l.particles.position) x.z -= static_cast<float>(step);  // they fly on
      now += step;
    }
    EXPECT_NEAR(static_cast<double>(l.particles.size()), 300, 300 * step + 2) << step;
    EXPECT_NEAR(s.supplied_kg, static_cast<Real>(l.particles.size()) * l.particle_mass, 1e-15);  // a sum of 300
  }
}

TEST(Pipe, EveryParticleStartsInsideTheBoreWithTheJetsVelocity) {
  Source s = pipe();
  Liquid l = liquid();
  emit(s, l, 0, 2);
  ASSERT_GT(l.particles.size(), 100u);
  const Vec3 axis{0.6, 0, -0.8};
  for (std::size_t i = 0; i < l.particles.size(); ++i) {
    const Float4 &x = l.particles.position[i], &v = l.particles.velocity[i];
    const Vec3 d = Vec3{x.x, x.y, x.z} - s.centre;
    EXPECT_LE(norm(d - dot(d, axis) * axis), 0.02 + 1e-6);
    EXPECT_NEAR(v.x, 0.6, 1e-6);
    EXPECT_NEAR(v.z, -0.8, 1e-6);
  }
}

TEST(Pipe, NoTwoParticlesStartInOnePlace) {
  Source s = pipe();
  Liquid l = liquid();
  emit(s, l, 0, 2);
  for (std::size_t i = 0; i < l.particles.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Float4 &a = l.particles.position[i], &b = l.particles.position[j];
      EXPECT_GT(norm(Vec3{a.x - b.x, a.y - b.y, a.z - b.z}), 0.79 * l.spacing());
    }
}

TEST(Pipe, TheSameSeedGivesTheSameJet) {
  Source a = pipe(), b = pipe(), c = pipe();
  c.seed = 2;
  Liquid la = liquid(), lb = liquid(), lc = liquid();
  emit(a, la, 0, 0.1), emit(b, lb, 0, 0.1), emit(c, lc, 0, 0.1);
  ASSERT_EQ(la.particles.size(), lb.particles.size());
  EXPECT_EQ(la.particles.position[5].x, lb.particles.position[5].x);
  EXPECT_NE(la.particles.position[5].x, lc.particles.position[5].x);
}

// The lattice around the mouth, 0.9 spacings wide, leaves gaps of 0.78 at most.
TEST(Pipe, AMouthInLiquidGivesItsFlowWhenSubmergedAndWaitsOtherwise) {
  for (const bool submerged : {true, false}) {
    Source s = pipe();
    s.submerged = submerged, s.radius = 0.003, s.length = 0.005;
    Liquid l = liquid();
    const Real dx = l.spacing();
    const Vec3 middle = s.centre - 0.5 * s.length * normalized(s.velocity);
    for (int x = -6; x <= 6; ++x)
      for (int y = -6; y <= 6; ++y)
        for (int z = -6; z <= 6; ++z) add_particle(l, middle + 0.9 * dx * Vec3{1.0 * x, 1.0 * y, 1.0 * z}, {});
    const std::size_t old = l.particles.size();
    const EmitReport r = emit(s, l, 0, 0.05);
    EXPECT_EQ(r.waiting, !submerged);
    EXPECT_EQ(l.particles.size() - old, submerged ? 15u : 0u);  // 300 per second
    for (std::size_t i = old; i < l.particles.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const Float4 &a = l.particles.position[i], &b = l.particles.position[j];
        EXPECT_GT(norm(Vec3{a.x - b.x, a.y - b.y, a.z - b.z}), (submerged ? 0.39 : 0.79) * dx);
      }
  }
}

}  // namespace
}  // namespace imbibe
