// Liquid on a sheet that gives way: momentum, and that light cloth under heavy liquid is stable.
#include "imbibe/liquid/sheet_wall.h"

#include <gtest/gtest.h>

#include "imbibe/liquid/liquid_step.h"

namespace imbibe {
namespace {

// A free, level sheet of n x n nodes and a block of liquid on it.
struct Raft {
  MovingMesh surface;
  std::vector<Vec3> position, velocity;
  std::vector<Real> inverse_mass;
  std::vector<std::array<Index, 3>> triangles;
  SheetWall sheet;
  Liquid liquid;
  LiquidParams params;
  LiquidScratch scratch;
  Vec3 impulse{};  // N s, given to the sheet so far

  explicit Raft(Real areal_mass) {
    constexpr int n = 13;
    constexpr Real pitch = 5e-3;
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) position.push_back({pitch * (i - 6), pitch * (j - 6), 0});
    for (Index j = 0; j + 1 < n; ++j)
      for (Index i = 0; i + 1 < n; ++i) {
        const Index a = i + n * j;
        triangles.push_back({a, a + 1, a + n + 1});
        triangles.push_back({a, a + n + 1, a + n});
      }
    velocity.assign(position.size(), Vec3{});
    inverse_mass.assign(position.size(), areal_mass > 0 ? 1 / (areal_mass * pitch * pitch) : 0);
    liquid.particle_mass = 8e-6;  // 2 mm
    const Real dx = liquid.spacing();
    for (int k = 0; k < 5; ++k)
      for (int j = 0; j < 12; ++j)
        for (int i = 0; i < 12; ++i) add_particle(liquid, {dx * (i - 5.5), dx * (j - 5.5), dx * (k + 0.5)}, {});
    params.surface_tension = false;
  }
  void step(const Vec3& gravity, Real dt) {
    set_step(surface, position, position, triangles);
    sheet.surface = &surface, sheet.velocity = velocity, sheet.inverse_mass = inverse_mass;
    sheet.impulse.assign(position.size(), Vec3{});
    Wall wall;
    wall.two_sided = true, wall.sheet = &sheet;
    const LiquidStepReport report = step_liquid(liquid, params, std::span(&wall, 1), gravity, dt, scratch);
    ASSERT_EQ(report.step_s, dt);
    for (std::size_t n = 0; n < position.size(); ++n) {
      impulse += sheet.impulse[n];
      if (inverse_mass[n] == 0) continue;
      velocity[n] += inverse_mass[n] * sheet.impulse[n] + dt * gravity;
      position[n] += dt * velocity[n];
    }
  }
  Vec3 liquid_momentum() const {
    Vec3 p{};
    for (const Float4& v : liquid.particles.velocity) p += liquid.particle_mass * Vec3{v.x, v.y, v.z};
    return p;
  }
  Real greatest_speed() const {
    Real most = 0;
    for (const Float4& v : liquid.particles.velocity) most = std::max(most, norm(Vec3{v.x, v.y, v.z}));
    return most;
  }
};

TEST(SheetWall, WhatTheLiquidLosesTheSheetGets) {
  Raft raft(0.1);
  for (std::size_t n = 0; n < raft.velocity.size(); ++n) raft.velocity[n] = {0, 0, 0.3};  // it comes from below
  const Vec3 start = raft.liquid_momentum();
  for (int k = 0; k < 20; ++k) {
    raft.step({}, 2e-4);
    const Vec3 lost = start - raft.liquid_momentum();
    // The figure for the exchange of liquid and cloth (liquid/momentum.h).
    ASSERT_LT(norm(lost - raft.impulse), 1e-12 * norm(raft.impulse));
  }
  EXPECT_GT(raft.liquid_momentum().z, 0);
}

TEST(SheetWall, LiquidAndLightSheetFallTogether) {
  Raft raft(0.1);  // 10 kg/m2 of liquid lie on it
  for (int k = 0; k < 100; ++k) raft.step({0, 0, -9.81}, 2e-4);
  // Nothing holds them: both fall freely and exchange nothing but rounding.
  EXPECT_NEAR(raft.liquid_momentum().z, -9.81 * 0.02 * raft.liquid.mass(), 1e-3 * 9.81 * 0.02 * raft.liquid.mass());
  EXPECT_LT(raft.greatest_speed(), 1.1 * 9.81 * 0.02);
}

TEST(SheetWall, ALightSheetStruckByLiquidIsCarriedAlongWithoutRinging) {
  Raft raft(0.02);  // five hundred times lighter than what falls on it: explicit exchange blows up here
  for (Float4& v : raft.liquid.particles.velocity) v.z = -0.5f;
  const Real energy = 0.5 * raft.liquid.mass() * 0.25;
  for (int k = 0; k < 100; ++k) raft.step({}, 2e-4);
  Real after = 0;
  for (const Float4& v : raft.liquid.particles.velocity)
    after += 0.5 * raft.liquid.particle_mass * squared_norm(Vec3{v.x, v.y, v.z});
  EXPECT_LT(after, energy);
  EXPECT_GT(after, 0.8 * energy);  // a per cent of the mass cannot stop it
  const Index middle = 6 + 13 * 6;
  EXPECT_NEAR(raft.velocity[middle].z, -0.5, 0.1);
}

TEST(SheetWall, AThickSyrupDragsALightSheetAlongAndNoFaster) {
  for (const Real viscosity : {1.0, 1e3}) {
    Raft raft(0.02);  // friction is solved at once with the liquid's: what it gave to light nodes made them swing ever more
    raft.liquid.kind.viscosity = viscosity;
    for (Float4& v : raft.liquid.particles.velocity) v.x = 0.5f;
    const Index middle = 6 + 13 * 6;
    for (int k = 0; k < 60; ++k) {
      raft.step({}, 2e-4);
      // Never back, and no faster than the liquid but for 2 % that its pressure gives the sheet, whose nodes nothing ties.
      ASSERT_LT(std::abs(raft.velocity[middle].x - 0.25), 0.265) << viscosity << " step " << k;
    }
    EXPECT_NEAR(raft.velocity[middle].x, 0.5, 0.02) << viscosity;
    EXPECT_LT(raft.greatest_speed(), 0.51);
  }
}

TEST(SheetWall, AHeldSheetBearsTheLiquidsWeightAndLetsNothingThrough) {
  Raft raft(0);
  Vec3 before{};
  for (int k = 0; k < 60; ++k) {
    if (k == 20) before = raft.impulse;
    raft.step({0, 0, -9.81}, 5e-4);
  }
  // The block begins to spread at its sides, which takes some of the load off: 25 %.
  const Real weight = raft.liquid.mass() * 9.81 * 40 * 5e-4;
  EXPECT_NEAR((raft.impulse - before).z, -weight, 0.25 * weight);
  for (const Float4& x : raft.liquid.particles.position) {
    if (std::abs(x.x) < 0.025f && std::abs(x.y) < 0.025f) {
      EXPECT_GT(x.z, -0.05 * raft.liquid.spacing());  // centres may touch: what would cross, the swept contact stops
    }
  }
}

}  // namespace
}  // namespace imbibe
