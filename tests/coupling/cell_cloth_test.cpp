// Seed B's cloth: what cells, sheet and liquid exchange.
#include "imbibe/coupling/cell_cloth.h"

#include <gtest/gtest.h>

#include "imbibe/geometry/sampling.h"

namespace imbibe {
namespace {

CellCloth hanging_cloth() {
  CellCloth cloth;
  cloth.soft.sheet = make_sheet(GridSheet{.corner = {0, 0, 0}, .along_v = {0, 0, 1}, .width = 0.2, .height = 0.2,
                                          .columns = 11, .rows = 11, .areal_mass = 0.2});
  pin_nodes(cloth.soft.sheet, nodes_of_edge(cloth.soft.sheet, "top"));
  fit_cells(cloth);
  return cloth;
}

Liquid liquid() {
  Liquid l;
  l.particle_mass = 1e-5;
  return l;
}

TEST(CellCloth, AnEvenLayerFillsAllCellsAlikeUpToTheEdges) {
  for (const Index nodes : {2u, 3u, 4u, 11u}) {
    CellCloth cloth;
    cloth.soft.sheet = make_sheet(GridSheet{.width = 0.2, .height = 0.2, .columns = nodes, .rows = nodes, .areal_mass = 0.2});
    fit_cells(cloth);
    Real area = 0;
    for (const Real a : cloth.grid->area) area += a;
    EXPECT_NEAR(area, 0.04, 1e-15);
    constexpr int a_side = 200;
    const Real kg = 0.04 * cloth.grid->capacity_per_area / (a_side * a_side);
    for (int j = 0; j < a_side; ++j)
      for (int i = 0; i < a_side; ++i)
        add_parcel(*cloth.grid, cloth.contents, (i + 0.5) * 0.2 / a_side, (j + 0.5) * 0.2 / a_side, kg);
    for (std::size_t c = 0; c < cloth.grid->cells(); ++c) EXPECT_NEAR(cell_saturation(*cloth.grid, cloth.contents, c), 1, 2e-3) << c;  // middles
  }
}

constexpr Real at_centre = 9.0 / 16;  // share of a parcel in a cell's middle that counts for the cell itself (cell_flow.h)

TEST(CellCloth, ContentsAndWaitingLiquidWeighOnTheirNodes) {
  CellCloth cloth = hanging_cloth();
  add_parcel(*cloth.grid, cloth.contents, 0.1, 0.1, 3e-4);
  cloth.waiting_kg[7] = 2e-4;
  weigh(cloth);
  EXPECT_NEAR(cloth.soft.sheet.added_mass[11 * 5 + 5], at_centre * 3e-4, 1e-18);
  EXPECT_EQ(cloth.soft.sheet.added_mass[7], 2e-4);
  EXPECT_NEAR(total_mass(cloth.soft.sheet), 0.04 * 0.2 + 5e-4, 1e-15);
}

TEST(CellCloth, WaterSoftensAndDampsAsItsParametersSay) {
  CellCloth cloth = hanging_cloth();
  cloth.wet = {.softening = 0.4, .damping = 0.02};
  const std::size_t cell = 11 * 5 + 5;
  add_parcel(*cloth.grid, cloth.contents, 0.1, 0.1, 0.5 * cloth.grid->capacity(cell) / at_centre);
  weigh(cloth);
  EXPECT_NEAR(cloth.soft.sheet.stiffness_factor[cell], 0.8, 1e-6);  // saturations are shown in single precision
  EXPECT_NEAR(cloth.soft.sheet.damping_added[cell], 0.01, 1e-8);
  EXPECT_EQ(cloth.soft.sheet.stiffness_factor[0], 1);
}

TEST(CellCloth, ParcelsThatMoveTakeTheirMomentumAlong) {
  CellCloth cloth = hanging_cloth();
  SoftSheetScratch scratch;
  Sheet& sheet = cloth.soft.sheet;
  find_held(cloth.soft, scratch.held);
  set_step(scratch.surface, sheet.position, sheet.position, sheet.triangles);
  for (int k = 0; k < 400; ++k) {
    const RandomCounter id{1, static_cast<std::uint64_t>(k), 0};
    add_parcel(*cloth.grid, cloth.contents, 0.08 + 0.04 * uniform(id, 0), 0.08 + 0.04 * uniform(id, 1), 1e-6);
  }
  cloth.params.resistance = 100, cloth.params.leak = false, cloth.params.drying = false;
  weigh(cloth);
  for (std::size_t n = 0; n < sheet.size(); ++n)
    if (!scratch.held[n]) sheet.velocity[n] = {0.3 * std::sin(3.0 * static_cast<Real>(n)), 0.2, std::cos(7.0 * static_cast<Real>(n))};
  const Vec3 before = momentum(sheet);
  Liquid none;
  CellExchangeReport report;
  step_cell_cloth(cloth, scratch, none, Air{}, {0, 0, -9.81}, 0.05, report);
  EXPECT_LT(norm(momentum(sheet) - cloth.soft.support_impulse - before), 1e-13 * norm(before));
}

TEST(CellCloth, WhatLeaksIsBornBelowTheLowestCellThatIsWet) {
  CellCloth cloth = hanging_cloth();
  SoftSheetScratch scratch;
  Sheet& sheet = cloth.soft.sheet;
  find_held(cloth.soft, scratch.held);
  set_step(scratch.surface, sheet.position, sheet.position, sheet.triangles);
  cloth.params.absorption_factor = 0, cloth.params.resistance = 1e8;
  const Real capacity = cloth.grid->capacity(11 * 5 + 5);
  for (int k = 0; k < 80; ++k) add_parcel(*cloth.grid, cloth.contents, 0.1, 0.1, 0.05 * capacity);
  for (int row = 0; row < 5; ++row)
    for (int k = 0; k < 4; ++k) add_parcel(*cloth.grid, cloth.contents, 0.1, 0.02 * row, 0.05 * capacity);
  Liquid water = liquid();
  water.particle_mass = 0.05 * capacity;
  CellExchangeReport report;
  const Real before = cell_kg(cloth);
  for (int step = 0; step < 60; ++step) {
    step_cell_cloth(cloth, scratch, water, Air{}, {0, 0, -9.81}, 0.02, report);
    for (Float4& x : water.particles.position) x.z -= 0.01f;  // they fall
  }
  EXPECT_GT(report.released, 10u);
  EXPECT_NEAR(cell_kg(cloth) + waiting_kg(cloth) + water.mass() + report.evaporated_kg, before, 1e-12 * before);
  for (const Float4& x : water.particles.position) {
    EXPECT_NEAR(x.x, 0.1, 0.02 + 1.01 * water.spacing());  // there, where it wets the next cell, or one spacing beside it
    EXPECT_LT(x.z, 0);                              // under the hem
  }
}

// A drop that has fallen leaves particles that hang under the sheet: they are drawn back once nothing leaks any more. One that
// stayed there would keep the liquid's clock running for as long as the cloth dries.
TEST(CellCloth, LiquidThatLiesOnItIsTakenInAndWhatHangsUnderItOnceNothingLeaks) {
  CellCloth cloth;
  cloth.soft.sheet = make_sheet(GridSheet{.width = 0.2, .height = 0.2, .columns = 11, .rows = 11, .areal_mass = 0.2});
  cloth.soft.sheet.fixed = true;
  fit_cells(cloth);
  SoftSheetScratch scratch;
  const Sheet& sheet = cloth.soft.sheet;
  find_held(cloth.soft, scratch.held);
  set_step(scratch.surface, sheet.position, sheet.position, sheet.triangles);
  Liquid water = liquid();
  const Real dx = water.spacing();
  add_particle(water, {0.1, 0.1, 0.5 * dx}, {});
  add_particle(water, {0.1, 0.1, -0.5 * dx}, {});
  add_particle(water, {0.1, 0.1, 2 * dx}, {});
  add_particle(water, {0.25, 0.1, 0}, {});  // beside it
  add_parcel(*cloth.grid, cloth.contents, 0.02, 0.02, 1.1 * cloth.grid->capacity(12) / at_centre);  // leaks, far away
  const Real before = cell_kg(cloth);
  std::vector<std::uint8_t> dead(4, 0);
  CellExchangeReport report;
  absorb_touching(cloth, scratch, water, dead, {0, 0, -9.81}, report);
  EXPECT_EQ(dead, (std::vector<std::uint8_t>{1, 0, 0, 0}));
  EXPECT_NEAR(cell_kg(cloth), before + water.particle_mass, 1e-12);
  cloth.contents = empty_contents(*cloth.grid);
  dead.assign(4, 0);
  absorb_touching(cloth, scratch, water, dead, {0, 0, -9.81}, report);
  EXPECT_EQ(dead, (std::vector<std::uint8_t>{1, 1, 0, 0}));
}

TEST(CellCloth, AFullCellBouncesUnlessToldOtherwise) {
  for (const bool bounce : {true, false}) {
    CellCloth cloth;
    cloth.soft.sheet = make_sheet(GridSheet{.width = 0.2, .height = 0.2, .columns = 11, .rows = 11, .areal_mass = 0.2});
    cloth.soft.sheet.fixed = true;
    cloth.params.bounce = bounce;
    fit_cells(cloth);
    const Index cell = 11 * 5 + 5;
    add_parcel(*cloth.grid, cloth.contents, 0.1, 0.1, cloth.grid->capacity(cell) / at_centre);
    SoftSheetScratch scratch;
    const Sheet& sheet = cloth.soft.sheet;
    find_held(cloth.soft, scratch.held);
    set_step(scratch.surface, sheet.position, sheet.position, sheet.triangles);
    Liquid water = liquid();
    add_particle(water, {0.1, 0.101, -0.01}, {0, 0, -2});
    const std::vector<Float4> before{{0.1f, 0.101f, 0.01f, 0}};
    std::vector<std::uint8_t> dead(1, 0);
    CellExchangeReport report;
    meet_particles(cloth, scratch, water, before, dead, {0, 0, -9.81}, 1, 0, report);
    EXPECT_EQ(report.bounced, bounce ? 1u : 0u);
    EXPECT_EQ(report.absorbed, bounce ? 0u : 1u);
    if (bounce) {
      EXPECT_GT(water.particles.velocity[0].z, 0);
      EXPECT_GT(water.particles.position[0].z, 0);
    }
  }
}

TEST(CellCloth, CellsOfAFreeFormSheetCoverIt) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {0.2, 0, 0}, {0, 0.3, 0}, {0.15, 0.25, 0}};
  mesh.triangles = {{0, 1, 2}, {1, 3, 2}};
  std::vector<std::array<Real, 2>> uv;
  for (const Vec3& v : mesh.vertices) uv.push_back({v.x, v.y});
  CellCloth cloth;
  cloth.soft.sheet = make_sheet(mesh, uv, 0.2);
  cloth.params.cell_size = 0.01;
  fit_cells(cloth);
  Real area = 0, expected = 0;
  for (const Real a : cloth.grid->area) area += a;
  for (const Real a : node_areas(cloth.soft.sheet)) expected += a;
  EXPECT_NEAR(area, expected, 1e-12);
}

TEST(CellCloth, WhatLeaksIsBornInNoSolidAndOnNoOtherParticle) {
  CellCloth cloth = hanging_cloth();
  SoftSheetScratch scratch;
  Sheet& sheet = cloth.soft.sheet;
  find_held(cloth.soft, scratch.held);
  set_step(scratch.surface, sheet.position, sheet.position, sheet.triangles);
  Liquid water = liquid();
  const Real dx = water.spacing();
  cloth.waiting_kg[5] = 40 * water.particle_mass;
  cloth.params.absorb = false;  // nothing is drawn back
  weigh(cloth);
  CellExchangeReport report;
  step_cell_cloth(cloth, scratch, water, Air{}, {0, 0, -9.81}, 1e-3, report, [](const Vec3&) { return true; });
  EXPECT_EQ(water.particles.size(), 0u);
  EXPECT_NEAR(waiting_kg(cloth), 40 * water.particle_mass, 1e-12 * water.particle_mass);
  // A solid on one side of the hem.
  const auto solid = [](const Vec3& place) { return place.y > 0; };
  for (int k = 0; k < 3; ++k) step_cell_cloth(cloth, scratch, water, Air{}, {0, 0, -9.81}, 1e-3, report, solid);
  EXPECT_GT(water.particles.size(), 3u);
  EXPECT_NEAR(waiting_kg(cloth) + water.mass(), 40 * water.particle_mass, 1e-12 * water.particle_mass);
  for (std::size_t i = 0; i < water.particles.size(); ++i) {
    const Float4& a = water.particles.position[i];
    EXPECT_LE(a.y, 0);
    for (std::size_t j = 0; j < i; ++j) {
      const Float4& b = water.particles.position[j];
      EXPECT_GE(norm(Vec3{a.x - b.x, a.y - b.y, a.z - b.z}), 0.8 * dx * (1 - 1e-6));  // places in single precision
    }
  }
}

TEST(CellCloth, DropsFallFromTheHemAtTheMassOfTate) {
  // Water comes to five nodes of the hem that lie within a drop's width of each other: one drop.
  CellCloth cloth;
  cloth.soft.sheet = make_sheet(GridSheet{.corner = {0, 0, 0}, .along_v = {0, 0, 1}, .width = 0.02, .height = 0.02,
                                          .columns = 41, .rows = 41, .areal_mass = 0.2});
  pin_nodes(cloth.soft.sheet, nodes_of_edge(cloth.soft.sheet, "top"));
  fit_cells(cloth);
  SoftSheetScratch scratch;
  Sheet& sheet = cloth.soft.sheet;
  find_held(cloth.soft, scratch.held);
  set_step(scratch.surface, sheet.position, sheet.position, sheet.triangles);
  Liquid water = liquid();
  water.particle_mass = 2e-6;
  const Real expected = falling_drop_kg(2e-3, water.kind.surface_tension, 9.81);
  EXPECT_NEAR(expected, 0.6 * 2 * pi * 2e-3 * 0.0728 / 9.81, 0.01 * expected);  // 56 mg of water
  cloth.params.absorb = false;  // nothing is drawn back
  CellExchangeReport report;
  Real given = 0;
  std::vector<Real> drops;
  for (int step = 0; step < 400; ++step) {
    for (Index c = 18; c < 23; ++c) cloth.waiting_kg[c] += 1e-7, given += 1e-7;
    const std::size_t before = water.particles.size();
    step_cell_cloth(cloth, scratch, water, Air{}, {0, 0, -9.81}, 1e-3, report);
    if (water.particles.size() > before) drops.push_back(water.particle_mass * static_cast<Real>(water.particles.size() - before));
    for (std::size_t i = before; i < water.particles.size(); ++i) {
      EXPECT_LT(water.particles.position[i].z, -0.5 * water.spacing());
      EXPECT_NEAR(water.particles.position[i].x, 0.01, 4e-3);
    }
    for (Float4& x : water.particles.position) x.z -= 0.02f;  // they fall
  }
  ASSERT_GE(drops.size(), 3u);
  for (const Real kg : drops) EXPECT_NEAR(kg, expected, water.particle_mass);  // whole particles
  EXPECT_NEAR(water.mass() + waiting_kg(cloth), given, 1e-12 * given);
}

TEST(CellCloth, ADropThatHangsIsDrawnBackIntoCellsThatHaveRoom) {
  CellCloth cloth = hanging_cloth();
  SoftSheetScratch scratch;
  find_held(cloth.soft, scratch.held);
  Liquid water = liquid();
  cloth.waiting_kg[5] = 3e-5;
  CellExchangeReport report;
  step_cell_cloth(cloth, scratch, water, Air{}, {0, 0, -9.81}, 1e-3, report);
  EXPECT_EQ(waiting_kg(cloth), 0);
  EXPECT_NEAR(cell_kg(cloth), 3e-5, 1e-18);
}

// A square cloth of 0.2 kg/m2 that holds three times its mass and does not move, by as many nodes a side.
CellCloth fixed_square(Real side, Index nodes, SoftSheetScratch& scratch) {
  CellCloth cloth;
  cloth.soft.sheet = make_sheet(GridSheet{.width = side, .height = side, .columns = nodes, .rows = nodes, .areal_mass = 0.2});
  cloth.soft.sheet.fixed = true;
  cloth.params.capacity_ratio = 3;
  fit_cells(cloth);
  find_held(cloth.soft, scratch.held);
  set_step(scratch.surface, cloth.soft.sheet.position, cloth.soft.sheet.position, cloth.soft.sheet.triangles);
  return cloth;
}

Liquid coarse_liquid() {
  Liquid water = liquid();
  water.particle_mass = 2e-5;
  return water;
}

TEST(CellCloth, WhatACoarseParticleGivesDoesNotDependOnTheSizeOfTheCells) {
  // A particle of 20 mg on cells that hold 260 mg, 16 mg and 4 mg, 4.5 mg on its own cross-section: it is taken, and fills
  // those under it alike.
  for (const Index nodes : {23u, 92u, 185u}) {
    SoftSheetScratch scratch;
    CellCloth cloth = fixed_square(0.46, nodes, scratch);
    Liquid water = coarse_liquid();
    add_particle(water, {0.2312, 0.2291, 0.3 * water.spacing()}, {});
    std::vector<std::uint8_t> dead(1, 0);
    CellExchangeReport report;
    absorb_touching(cloth, scratch, water, dead, {0, 0, -9.81}, report);
    EXPECT_EQ(dead[0], 1);
    EXPECT_NEAR(cell_kg(cloth), 2e-5, 1e-17);
    // It fills to a quarter; by parcels of a twentieth of a cell, at most 64 of them, some cells get more.
    for (std::size_t c = 0; c < cloth.grid->cells(); ++c) EXPECT_LT(cell_saturation(*cloth.grid, cloth.contents, c), 0.9);
  }
}

TEST(CellCloth, WhatRainFillsOfAClothDoesNotDependOnTheSizeOfItsCells) {
  // Three times what it can hold, in particles of 20 mg, evenly at random, on cells of 20, 5 and 2.5 mm without any flow. What a
  // particle adds where it is taken is about a quarter: cells end full in the mean, within a part of that.
  Real coarse = 0;
  for (const Index nodes : {7u, 25u, 49u}) {
    SoftSheetScratch scratch;
    CellCloth cloth = fixed_square(0.12, nodes, scratch);
    Liquid water = coarse_liquid();
    for (std::uint64_t k = 0; k < 1296; ++k)
      add_particle(water, {0.12 * uniform({5, k, 0}, 0), 0.12 * uniform({5, k, 0}, 1), 0.3 * water.spacing()}, {});
    std::vector<std::uint8_t> dead(water.particles.size(), 0);
    CellExchangeReport report;
    absorb_touching(cloth, scratch, water, dead, {0, 0, -9.81}, report);
    const Real filled = cell_kg(cloth) / (0.12 * 0.12 * 0.6);
    EXPECT_NEAR(filled, 1.06, 0.06) << nodes;
    if (coarse == 0) coarse = filled;
    EXPECT_NEAR(filled / coarse, 1, 0.06) << nodes;  // 1.06 and 1.12: particles are as large as fine cells
  }
}

}  // namespace
}  // namespace imbibe
