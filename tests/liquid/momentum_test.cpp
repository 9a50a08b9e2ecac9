// The liquid's momentum through single precision.
#include "imbibe/liquid/momentum.h"

#include <gtest/gtest.h>

#include "imbibe/core/parallel.h"
#include "imbibe/core/random.h"
#include "imbibe/liquid/liquid_step.h"
#include "imbibe/liquid/source.h"

namespace imbibe {
namespace {

std::vector<Float4> random_velocities(std::size_t count) {
  std::vector<Float4> velocity(count);
  for (std::size_t i = 0; i < count; ++i) {
    const RandomCounter random{7, i, 0};
    const auto part = [&](std::uint32_t k) { return static_cast<float>(2 * uniform(random, k) - 1); };
    velocity[i] = {part(0), part(1), part(2), 0};
  }
  return velocity;
}

TEST(Momentum, WhatIsSpreadOverManyParticlesAddsUpFarBelowSinglePrecision) {
  for (const int threads : {1, 3}) {
    const ThreadLimit limit(threads);
    std::vector<Float4> velocity = random_velocities(3000);
    const std::vector<Float4> before = velocity;
    const Vec3 missing{3e-6, -1.7e-4, 0.2};  // m/s: per particle far below, near and above half a step of single precision
    const Vec3 start = sum_speeds(velocity).velocity;
    const Vec3 left = spread_over_particles(velocity, missing);
    const Vec3 got = sum_speeds(velocity).velocity - start;
    // The slowest of 3000 random speeds up to 1 is some 3e-4: half a step there is 1.5e-11.
    EXPECT_LT(norm(left), 1e-10);
    EXPECT_LT(norm(got + left - missing), 1e-12);  // rounding of sums of 3000 doubles
    for (std::size_t i = 0; i < velocity.size(); ++i) {
      EXPECT_NEAR(velocity[i].z - before[i].z, 0.2 / 3000, 1.2e-7);  // evenly, to two steps of single precision
      EXPECT_NEAR(velocity[i].x, before[i].x, 1.2e-7);
    }
  }
}

TEST(Momentum, OnlyRoundingIsMadeUp) {
  std::vector<Float4> velocity = random_velocities(500);
  const SpeedSums before = sum_speeds(velocity);
  const Vec3 rounding{1e-5, 0, 0}, fault{1e-1, 0, 0};  // of a sum of speeds of some 500 m/s
  EXPECT_LT(norm(make_up_rounding(velocity, before, rounding, 0)), 1e-9);
  EXPECT_NEAR((sum_speeds(velocity).velocity - before.velocity).x, 1e-5, 1e-9);
  const SpeedSums now = sum_speeds(velocity);
  EXPECT_EQ(make_up_rounding(velocity, now, fault, 0), Vec3{});
  EXPECT_EQ(sum_speeds(velocity).velocity, now.velocity);
}

// A drop that falls on a floor, of water and of a syrup whose viscosity is solved implicitly.
TEST(Momentum, EveryStepOfADropGivesItsWallWhatItLoses) {
  for (const Real viscosity : {1e-3, 2.0}) {
    Liquid liquid;
    liquid.kind.viscosity = viscosity;
    liquid.particle_mass = 998.2 * 2e-4 * 2e-4 * 2e-4;
    Source drop{.centre = {0, 0, 1.1e-3}, .volume = 4e-9, .velocity = {0.1, 0, -0.4}};
    emit(drop, liquid, 0, 1);
    const Shape floor = Plane{};
    const Wall wall{&floor, {}, {}, false};
    LiquidScratch scratch;
    const Vec3 gravity{0, 0, -9.81};
    Real worst = 0;
    for (int k = 0; k < 60; ++k) {
      const SpeedSums before = sum_speeds(liquid.particles.velocity);
      const LiquidStepReport r = step_liquid(liquid, {}, std::span(&wall, 1), gravity, 1, scratch);
      const SpeedSums now = sum_speeds(liquid.particles.velocity);
      const Vec3 missing = liquid.particle_mass * (now.velocity - before.velocity) + r.wall_impulse[0] - (liquid.mass() * r.step_s) * gravity;
      worst = std::max(worst, norm(missing) / (liquid.particle_mass * now.speed));
    }
    RecordProperty("worst_" + std::to_string(viscosity), std::to_string(1e12 * worst) + "e-12");
    EXPECT_LT(worst, 1e-10) << viscosity;  // the issue asks for 1e-9 per step
  }
}

}  // namespace
}  // namespace imbibe
