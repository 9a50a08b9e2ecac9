// A soft sheet and particles: momentum, energy, and that nothing gets through.
#include "imbibe/coupling/soft_sheet.h"

#include <gtest/gtest.h>

#include "imbibe/coupling/cell_cloth.h"
#include "imbibe/geometry/sampling.h"

namespace imbibe {
namespace {

SoftSheet hanging(Index nodes = 23, Real size = 0.46) {
  SoftSheet soft;
  soft.sheet = make_sheet(GridSheet{.corner = {-size / 2, -size / 2, 0}, .width = size, .height = size, .columns = nodes,
                                    .rows = nodes, .areal_mass = 0.2});
  for (const char* corner : {"bottom_left", "top_right"}) pin_nodes(soft.sheet, nodes_of_corner(soft.sheet, corner));
  return soft;
}

CellCloth cloth_of(SoftSheet soft) {
  CellCloth cloth;
  cloth.soft = std::move(soft);
  fit_cells(cloth);
  return cloth;
}

struct Sum {
  Vec3 momentum{};
  Real energy = 0;
};
Sum sum_of(const Sheet& sheet, const Liquid& liquid) {
  Sum s{momentum(sheet), kinetic_energy(sheet)};
  for (const Float4& f : liquid.particles.velocity) {
    const Vec3 v{f.x, f.y, f.z};
    s.momentum += liquid.particle_mass * v;
    s.energy += 0.5 * liquid.particle_mass * squared_norm(v);
  }
  return s;
}

// Sheet and particles moved over dt by their velocities; then they meet.
struct Shower {
  CellCloth cloth;
  SoftSheetScratch scratch;
  Liquid liquid;
  std::vector<Float4> before;
  std::vector<std::uint8_t> dead;
  CellExchangeReport report;

  explicit Shower(CellCloth c, std::size_t particles, std::uint64_t seed = 3) : cloth(std::move(c)) {
    liquid.particle_mass = 3e-5;
    for (std::size_t i = 0; i < particles; ++i) {
      const RandomCounter id{seed, i, 0};
      const Vec3 x = random_in({{-0.2, -0.2, -0.03}, {0.2, 0.2, 0.03}}, id);
      add_particle(liquid, x, (3 * uniform(id, 5)) * random_direction(id, 6));
    }
    Sheet& sheet = cloth.soft.sheet;
    for (std::size_t n = 0; n < sheet.size(); ++n)
      sheet.velocity[n] = {0.1, 0, 0.5 * std::sin(9.0 * sheet.u[n]) * std::cos(7.0 * sheet.v[n])};
    find_held(cloth.soft, scratch.held);
    for (std::size_t n = 0; n < sheet.size(); ++n)
      if (scratch.held[n]) sheet.velocity[n] = {};
  }
  void meet(Real dt, std::uint64_t step = 0) {
    Sheet& sheet = cloth.soft.sheet;
    const std::vector<Vec3> start = sheet.position;
    for (std::size_t n = 0; n < sheet.size(); ++n) sheet.position[n] += dt * sheet.velocity[n];
    set_step(scratch.surface, start, sheet.position, sheet.triangles);
    before = liquid.particles.position;
    for (std::size_t i = 0; i < liquid.particles.size(); ++i) {
      Float4& x = liquid.particles.position[i];
      const Float4& v = liquid.particles.velocity[i];
      x = {static_cast<float>(x.x + dt * v.x), static_cast<float>(x.y + dt * v.y), static_cast<float>(x.z + dt * v.z), 0};
    }
    dead.assign(liquid.particles.size(), 0);
    meet_particles(cloth, scratch, liquid, before, dead, {0, 0, -9.81}, 1, step, report);
  }
};

TEST(SoftSheet, WhatParticlesLoseTheSheetAndItsSupportsGet) {
  for (const bool absorb : {false, true}) {
    CellCloth cloth = cloth_of(hanging());
    cloth.params.absorb = absorb;
    Shower shower(std::move(cloth), 4000);
    const Sum start = sum_of(shower.cloth.soft.sheet, shower.liquid);
    shower.meet(0.01);
    remove_particles(shower.liquid.particles, shower.dead);
    weigh(shower.cloth);
    const Sum end = sum_of(shower.cloth.soft.sheet, shower.liquid);
    const Vec3 lost = end.momentum - start.momentum - shower.cloth.soft.support_impulse;
    EXPECT_GT(absorb ? shower.report.absorbed : shower.report.bounced, 400u);
    EXPECT_LT(norm(lost), 1e-12 * norm(start.momentum));  // rounding of doubles
    EXPECT_LE(end.energy, start.energy);                  // with every particle's impact
  }
}

TEST(SoftSheet, ABounceKeepsEnergyWhenElasticAndNeverAddsAny) {
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const RandomCounter id{11, i, 0};
    const Vec3 n = random_direction(id, 0), v = 3 * random_direction(id, 2), surface = 2 * random_direction(id, 4);
    const Real m = 1e-5, inverse = 1e5 * uniform(id, 6);  // sheets from infinitely heavy to as light as the particle
    ImpactParams params{.restitution = i % 2 == 0 ? 1.0 : uniform(id, 7), .rest_speed = 0};
    const Vec3 after = velocity_after_impact(v, surface, n, m, inverse, params, id);
    if (dot(v - surface, n) >= 0) {
      EXPECT_EQ(after, v);
      continue;
    }
    const Vec3 sheet_after = surface - (m * inverse) * (after - v);
    EXPECT_GE(dot(after - sheet_after, n), -1e-12);  // they part
    const Real own = inverse > 0 ? 1 / inverse : 0;
    const Real before_energy = 0.5 * m * squared_norm(v) + 0.5 * own * squared_norm(surface);
    const Real after_energy = 0.5 * m * squared_norm(after) + 0.5 * own * squared_norm(sheet_after);
    EXPECT_LE(after_energy, before_energy * (1 + 1e-12));
    if (params.restitution == 1 && inverse > 0) {
      EXPECT_NEAR(after_energy, before_energy, 1e-12 * before_energy);
    }
  }
}

TEST(SoftSheet, WithoutScatterAHeldSheetMirrorsAsSeedBWritesIt) {
  const Vec3 v{1, 2, -3}, n = normalized(Vec3{0.2, 0, 1});
  const Vec3 after = velocity_after_impact(v, {}, n, 1e-5, 0, {.restitution = 1, .scatter = 0}, {});
  EXPECT_LT(norm(after - (v - 2 * dot(v, n) * n)), 1e-14);
}

TEST(SoftSheet, AnAbsorbedParticleSharesItsMomentumWithItsNode) {
  SoftSheet soft = hanging();
  std::vector<std::uint8_t> held;
  find_held(soft, held);
  const Index node = 23 * 11 + 11;
  soft.sheet.velocity[node] = {0.3, 0, 0.1};
  const Real m = soft.sheet.mass(node);
  merge_into_node(soft, held, node, 2e-4, {0, 0, -2});
  EXPECT_LT(norm(soft.sheet.velocity[node] - (m * Vec3{0.3, 0, 0.1} + 2e-4 * Vec3{0, 0, -2}) / (m + 2e-4)), 1e-15);
}

TEST(SoftSheet, InSixtyStepsOfAFlappingSheetNoParticleCrossesUncounted) {
  // A sheet that flaps as it is told, larger than where particles are; each side's particles stay on theirs.
  SoftSheet soft = hanging(31, 0.8);
  soft.sheet.pins.clear();
  soft.sheet.fixed = true;  // moved by hand
  CellCloth cloth = cloth_of(std::move(soft));
  cloth.params.absorb = false;
  constexpr std::size_t count = 3000;
  Shower shower(std::move(cloth), count, 17);
  Sheet& sheet = shower.cloth.soft.sheet;
  std::vector<int> side(count, 0);
  std::size_t crossed = 0;
  for (int step = 0; step < 60; ++step) {
    for (std::size_t n = 0; n < sheet.size(); ++n)
      sheet.velocity[n] = {0, 0, 2.5 * std::cos(14.0 * sheet.u[n] + 9.0 * sheet.v[n] - 0.9 * step)};
    shower.meet(0.01, static_cast<std::uint64_t>(step));
    for (std::size_t i = 0; i < count; ++i) {
      Float4 &x = shower.liquid.particles.position[i], &v = shower.liquid.particles.velocity[i];
      if (std::abs(x.x) > 0.3f) v.x = -std::copysign(std::abs(v.x), x.x);
      if (std::abs(x.y) > 0.3f) v.y = -std::copysign(std::abs(v.y), x.y);
      if (std::abs(x.z) > 0.3f) v.z = -std::copysign(std::abs(v.z), x.z);
      // Its side as the sheet is now: by the nearest point, which owes nothing to the sweep.
      const NearestOnSheet near = nearest_on(shower.scratch.surface, {x.x, x.y, x.z});
      const int now = near.side > 0 ? 1 : -1;
      if (side[i] != 0 && now != side[i]) ++crossed;
      side[i] = now;
    }
  }
  EXPECT_EQ(crossed, 0u);
  EXPECT_GT(shower.cloth.crossings, 4000u);
}

// A sheet without weight whose corners take what a liquid gives it: the load of `newtons` down, shared by both.
void load_step(SoftSheet& soft, SoftSheetScratch& scratch, Real newtons, Real dt) {
  advance_sheet(soft, scratch, {}, {}, dt);
  sheet_as_wall(soft, scratch);
  for (const Pin& pin : soft.sheet.pins) scratch.wall.impulse[pin.node] = {0, 0, -0.5 * newtons * dt};
  take_wall_impulse(soft, scratch, {}, dt);
  finish_sheet(soft, scratch, dt);
}

TEST(SoftSheet, RestHoldsItAndBooksWhatItStops) {
  SoftSheet soft = hanging();
  SoftSheetScratch scratch;
  soft.cloth.air.density = 0;
  for (std::size_t n = 0; n < soft.sheet.size(); ++n) soft.sheet.velocity[n] = {1e-4, 0, 2e-4};
  find_held(soft, scratch.held);
  for (std::size_t n = 0; n < soft.sheet.size(); ++n)
    if (scratch.held[n]) soft.sheet.velocity[n] = {};
  const Vec3 start = momentum(soft.sheet);
  for (int k = 0; k < 120 && !soft.at_rest; ++k) load_step(soft, scratch, 0, 5e-3);
  ASSERT_TRUE(soft.at_rest);
  EXPECT_EQ(norm(momentum(soft.sheet)), 0);
  EXPECT_LT(norm(momentum(soft.sheet) - soft.support_impulse - start), 1e-12 * norm(start));  // rounding
  // Held: impacts leave it where it is, and its supports get them.
  const Vec3 taken = soft.support_impulse, impulse{0, 0, -1e-5};
  give_impulse(soft, scratch.held, SurfacePoint{.triangle = 300, .weight = {0.2, 0.3, 0.5}}, impulse);
  EXPECT_EQ(kinetic_energy(soft.sheet), 0);
  EXPECT_LT(norm(soft.support_impulse - taken + impulse), 1e-20);
}

TEST(SoftSheet, ItRestsUnderASteadyLoadAndWakesWhenTheLoadChanges) {
  SoftSheet soft = hanging();
  SoftSheetScratch scratch;
  soft.cloth.air.density = 0;
  const Real load = 0.05;  // N, an eighth of its weight on earth
  for (int k = 0; k < 200; ++k) load_step(soft, scratch, load, 5e-3);
  ASSERT_TRUE(soft.at_rest);
  for (int k = 0; k < 400; ++k) load_step(soft, scratch, load * (1 + 1e-3 * (k % 3 - 1)), 5e-3);  // the pressure flickers
  EXPECT_TRUE(soft.at_rest);
  for (int k = 0; k < 20 && soft.at_rest; ++k) load_step(soft, scratch, 1.5 * load, 5e-3);
  EXPECT_FALSE(soft.at_rest);
}

TEST(SoftSheet, TheWeightOfARestingSheetIsItsSupports) {
  SoftSheet soft = hanging();
  SoftSheetScratch scratch;
  soft.at_rest = true;
  const Vec3 gravity{0, 0, -1.6};
  for (int k = 0; k < 10; ++k) advance_sheet(soft, scratch, gravity, {}, 5e-3);
  EXPECT_LT(norm(soft.support_impulse + (0.05 * total_mass(soft.sheet)) * gravity), 1e-15);
}

TEST(SoftSheet, AFixedSheetIsAWallThatStandsWhoeverSetItsSurface) {
  SoftSheet soft = hanging();
  soft.sheet.fixed = true;
  SoftSheetScratch scratch;
  set_step(scratch.surface, soft.sheet.position, soft.sheet.position, soft.sheet.triangles);
  advance_sheet(soft, scratch, {0, 0, -9.81}, {}, 1e-3);
  const Wall wall = sheet_as_wall(soft, scratch);
  ASSERT_EQ(wall.sheet->velocity.size(), soft.sheet.size());
  for (const Vec3& v : wall.sheet->velocity) EXPECT_EQ(v, Vec3{});
}

}  // namespace
}  // namespace imbibe
