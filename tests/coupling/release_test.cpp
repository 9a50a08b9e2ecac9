#include "imbibe/coupling/release.h"

#include <gtest/gtest.h>

#include "support/faced_cloth.h"

namespace imbibe {
namespace {

constexpr Vec3 down{0, 0, -9.81};

struct Scene : test::FacedCloth {
  Index middle_pore() const { return static_cast<Index>(fabric.network.segments() + fabric.network.pores() / 2); }
  ReleaseReport release(const std::vector<ReleasedLiquid>& released = {}, const Vec3& gravity = down,
                        const SolidAt& solid_at = {}) {
    return release_particles(fabric.network, placement, map, released, gravity, solid_at, exchange, liquid);
  }
  Real waiting() const { return test::sum(exchange.waiting_kg); }
  Real height(std::size_t particle) const { return liquid.particles.position[particle].z; }
  Real half() const { return 0.5 * fabric.network.thickness; }
};

TEST(Release, WaitingMassBecomesParticlesBelowTheSheetAtRestAndNothingIsRounded) {
  Scene s;
  s.exchange.waiting_kg[s.middle_pore()] = 1.25 * s.liquid.particle_mass;
  ASSERT_EQ(s.release().particles, 1u);
  EXPECT_NEAR(s.waiting(), 0.25 * s.liquid.particle_mass, 1e-13 * s.liquid.particle_mass);
  EXPECT_LT(s.height(0), -s.half());
  EXPECT_EQ(s.liquid.particles.velocity[0].z, 0);
}

TEST(Release, TheLowerFaceIsTheOneThatGravityPointsTo) {
  Scene s;
  s.exchange.waiting_kg[s.middle_pore()] = s.liquid.particle_mass;
  ASSERT_EQ(s.release({}, {0, 0, 9.81}).particles, 1u);
  EXPECT_GT(s.height(0), s.half());
  Scene turned;  // the sheet's face looks down
  turned.placement = {.origin = {}, .u = {1, 0, 0}, .v = {0, -1, 0}, .n = {0, 0, -1}};
  turned.exchange.waiting_kg[turned.middle_pore()] = turned.liquid.particle_mass;
  ASSERT_EQ(turned.release().particles, 1u);
  EXPECT_LT(turned.height(0), -turned.half());
}

TEST(Release, NoParticleIsBornInsideAnother) {
  Scene s;
  s.exchange.waiting_kg[s.middle_pore()] = 5 * s.liquid.particle_mass;
  s.release();
  EXPECT_EQ(s.release().particles, 0u);  // the place is taken, and nothing presses it to the upper face
  EXPECT_EQ(s.liquid.particles.size(), 1u);
}

TEST(Release, ManyParticlesAtOnceKeepTheirDistance) {
  Scene s;
  for (Real& kg : s.exchange.waiting_kg) kg = 0.4 * s.liquid.particle_mass;
  const Real before = s.waiting();
  const ReleaseReport report = s.release();
  EXPECT_GT(report.particles, 30u);
  EXPECT_NEAR(s.waiting() + report.kg, before, 1e-12 * before);
  const Real clear = 0.8 * s.liquid.spacing();
  for (std::size_t i = 0; i < s.liquid.particles.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Float4 &a = s.liquid.particles.position[i], &b = s.liquid.particles.position[j];
      EXPECT_GE(std::hypot(a.x - b.x, a.y - b.y, a.z - b.z), clear * (1 - 1e-6));  // positions in single precision
    }
}

TEST(Release, AboveASolidLiquidLeavesAtTheUpperFace) {
  Scene s;
  s.exchange.waiting_kg[s.middle_pore()] = s.liquid.particle_mass;
  ASSERT_EQ(s.release({}, down, [](const Vec3& place) { return place.z < 0; }).particles, 1u);
  EXPECT_GT(s.height(0), s.half());
}

TEST(Release, WhereLiquidHangsBelowOnlyEnoughPressureOpensTheUpperFace) {
  Scene s;
  const Real across = s.liquid.kind.density * 9.81 * s.fabric.network.thickness, mass = s.liquid.particle_mass;
  s.exchange.waiting_kg[s.middle_pore()] = mass;
  s.release();
  EXPECT_EQ(s.release({{s.middle_pore(), mass, 0.9 * across, 1e-9}}).particles, 0u);
  EXPECT_EQ(s.release({{s.middle_pore(), 0, 1.1 * across, 1e-9}}).particles, 1u);
  EXPECT_GT(s.height(1), s.half());
}

TEST(Release, SpeedIsTorricellisUpToWhatTheFlowGivesAndNoneWithoutPressure) {
  const Real density = 998.2;
  EXPECT_NEAR(release_speed(100, density, 1, 1e-9), std::sqrt(200 / density), 1e-12);
  EXPECT_NEAR(release_speed(100, density, 2e-9, 1e-7), 0.02, 1e-15);
  EXPECT_EQ(release_speed(-1, density, 1e-9, 1e-7), 0);
  EXPECT_EQ(release_speed(0, density, 1e-9, 1e-7), 0);
  EXPECT_EQ(release_speed(100, density, 0, 1e-7), 0);
}

TEST(Release, AParticleHasTheMomentumOfWhatItIsMadeOfAndNoMoreEnergyThanThePressureGave) {
  Scene s;
  const Index pore = s.middle_pore();
  const Real mass = s.liquid.particle_mass, density = s.liquid.kind.density, excess = 40;
  const Real flow = 0.5 * mouth_area(s.fabric.network, pore) * std::sqrt(2 * excess / density);
  s.exchange.waiting_kg[pore] = 0.75 * mass;  // at rest since earlier steps
  const ReleaseReport report = s.release({{pore, 0.25 * mass, excess, flow}});
  ASSERT_EQ(report.particles, 1u);
  const Real speed = flow / mouth_area(s.fabric.network, pore);
  EXPECT_NEAR(s.liquid.particles.velocity[0].z, -0.25 * speed, 1e-6 * speed);  // velocities in single precision
  EXPECT_NEAR(report.momentum.z, -0.25 * mass * speed, 1e-12 * mass * speed);
  EXPECT_NEAR(s.exchange.impulse.z, 0.25 * mass * speed, 1e-12 * mass * speed);  // the sheet takes the opposite
  const Real energy = 0.5 * norm(report.momentum) * norm(report.momentum) / mass, given = 0.25 * mass / density * excess;
  EXPECT_LT(energy, given);
}

}  // namespace
}  // namespace imbibe
