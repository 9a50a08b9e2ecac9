// Seed B's cells: what parcels do under the absorption force, gravity, leaking and drying.
#include "imbibe/wetting/cells.h"

#include <gtest/gtest.h>

#include <cmath>

#include "imbibe/core/parallel.h"
#include "imbibe/core/random.h"

namespace imbibe {
namespace {

constexpr Real parcel = 2e-7;  // kg

CellGrid square(int nodes, Real size = 0.2, Real capacity = 0.2) {
  return rectangular_cells(nodes, nodes, size, size, capacity);
}

void pour(const CellGrid& grid, CellContents& c, int count, Real x, Real y, Real radius) {
  for (int k = 0; k < count; ++k) {
    const RandomCounter id{7, static_cast<std::uint64_t>(c.parcels()), 0};
    const Real r = radius * std::sqrt(uniform(id, 0)), angle = 2 * pi * uniform(id, 1);
    add_parcel(grid, c, x + r * std::cos(angle), y + r * std::sin(angle), parcel);
  }
}

// Root mean square distance from the centre.
Real spread(const CellContents& c, Real x, Real y) {
  Real sum = 0;
  for (const Vec3& p : c.parcel_place) sum += (p.x - x) * (p.x - x) + (p.y - y) * (p.y - y);
  return std::sqrt(sum / static_cast<Real>(c.parcels()));
}

TEST(Cells, AnEvenSlopeOfSaturationPullsAsItsGradientWhateverTheCellSize) {
  for (const int nodes : {9, 23, 92}) {
    CellGrid grid = rectangular_cells(nodes, 2 * nodes, 0.2, 0.1, 0.2);  // cells that are not square
    std::vector<Real> s(grid.cells());
    for (std::size_t i = 0; i < s.size(); ++i) s[i] = 3 * grid.centre(i).x - 2 * grid.centre(i).y + 1;
    const Index middle = grid.cell_at(0.1, 0.05);
    const Vec3 at = grid.centre(middle), a = absorption_force(grid, s, 0.5, middle, at.x, at.y);
    EXPECT_NEAR(a.x, -0.5 * 3, 1e-9) << nodes;  // -K grad s, rounding only
    EXPECT_NEAR(a.y, 0.5 * 2, 1e-9) << nodes;
  }
}

TEST(Cells, AreaIsThatOfTheSheet) {
  const CellGrid grid = rectangular_cells(23, 40, 0.3, 0.5, 0.1);
  Real area = 0;
  for (const Real a : grid.area) area += a;
  EXPECT_NEAR(area, 0.15, 1e-14);
}

TEST(Cells, MassIsKeptWhileItSpreadsSinksLeaksAndDries) {
  const CellGrid grid = square(23);
  CellParams params;
  params.resistance = 500;
  CellContents c = empty_contents(grid);
  pour(grid, c, 4000, 0.1, 0.1, 0.02);
  const Real start = total_kg(c);
  const std::vector<Vec3> gravity(grid.cells(), {0, -9.81, 0});
  std::vector<Real> height(grid.cells());
  for (std::size_t i = 0; i < height.size(); ++i) height[i] = grid.centre(i).y;
  Real out = 0, air = 0;
  for (int step = 0; step < 400; ++step) {
    const CellStepReport report = step_cells(grid, params, c, {gravity, height, 1e-3}, parcel, 0.005);
    for (const CellLeak& l : report.leaks) out += l.kg;
    air += report.evaporated_kg;
    Real cells = 0;
    for (const Real kg : c.content_kg) cells += kg;
    ASSERT_NEAR(total_kg(c) + out + air, start, 1e-13 * start) << step;  // rounding of sums of 4000 parcels
    ASSERT_NEAR(cells, total_kg(c), 1e-13 * start);
  }
  EXPECT_GT(out, 0);
  EXPECT_GT(air, 0);
}

TEST(Cells, ParcelsNeverLeaveTheSheet) {
  const CellGrid grid = square(12, 0.05);
  CellParams params;
  params.resistance = 2, params.leak = false;
  CellContents c = empty_contents(grid);
  pour(grid, c, 2000, 0.045, 0.005, 0.004);
  const std::vector<Vec3> gravity(grid.cells(), {6, -7, 0});
  for (int step = 0; step < 100; ++step) step_cells(grid, params, c, {gravity, {}, 0}, parcel, 0.01);
  EXPECT_EQ(c.parcels(), 2000u);
  for (const Vec3& x : c.parcel_place) {
    EXPECT_TRUE(x.x >= 0 && x.x <= 0.05 && x.y >= 0 && x.y <= 0.05) << x.x << ' ' << x.y;
  }
}

// Many parcels follow ds/dt = div(D s grad s), D = K/zeta: Barenblatt's profile.
TEST(Cells, ASpotGrowsAsThePorousMediumEquationSays) {
  const CellGrid grid = square(41);
  CellParams params;
  params.leak = false, params.residual_saturation = 0;
  CellContents c = empty_contents(grid);
  pour(grid, c, 6000, 0.1, 0.1, 0.01);
  const Real diffusivity = params.absorption_factor / params.resistance;
  // u_t = D/2 laplace(u^2): u = t^-1/2 (C - r^2/(8 D t^1/2)) in the plane; mass M = 4 pi D C^2, <r^2> = R^2/3,
  // R^2 = 8 D C t^1/2.
  const Real mass = total_kg(c) / grid.capacity_per_area, constant = std::sqrt(mass / (4 * pi * diffusivity));
  Real now = 0;
  for (const Real t : {10.0, 25.0}) {
    for (; now < t - 1e-9; now += 0.25) step_cells(grid, params, c, {}, parcel, 0.25);
    const Real radius = std::sqrt(8 * diffusivity * constant * std::sqrt(t) / 3);
    // The start has the size of 2 cells, and at the rim a cell holds a few parcels only: 5 %.
    EXPECT_NEAR(spread(c, 0.1, 0.1), radius, 0.05 * radius) << t;
  }
}

TEST(Cells, FinerCellsSpreadAlike) {
  std::vector<Real> seen;
  for (const int nodes : {23, 92}) {
    const CellGrid grid = square(nodes);
    CellParams params;
    params.leak = false;
    CellContents c = empty_contents(grid);
    pour(grid, c, 6000, 0.1, 0.1, 0.02);
    for (int step = 0; step < 40; ++step) step_cells(grid, params, c, {}, parcel, 0.2);
    seen.push_back(spread(c, 0.1, 0.1));
  }
  EXPECT_NEAR(seen[0], seen[1], 0.1 * seen[1]);  // the 10 % between 23 x 23 and 92 x 92
}

TEST(Cells, GravityCarriesLiquidDownAtItsDriftSpeed) {
  const CellGrid grid = square(33);
  CellParams params;
  params.absorption_factor = 0, params.residual_saturation = 0, params.resistance = 1000, params.leak = false;
  CellContents c = empty_contents(grid);
  add_parcel(grid, c, 0.1, 0.18, parcel);
  const std::vector<Vec3> gravity(grid.cells(), {0, -9.81, 0});
  for (int step = 0; step < 100; ++step) step_cells(grid, params, c, {gravity, {}, 0}, parcel, 0.1);
  // Starts from rest: one relaxation time 1/zeta is lost.
  EXPECT_NEAR(c.parcel_place[0].y, 0.18 - 9.81e-3 * (10 - 1e-3), 1e-9);
}

TEST(Cells, TheLeastWaterStaysWhereItIs) {
  const CellGrid grid = square(23);
  CellContents c = empty_contents(grid);
  add_parcel(grid, c, 0.1, 0.1, 0.04 * grid.capacity(grid.cell_at(0.1, 0.1)));
  const std::vector<Vec3> gravity(grid.cells(), {0, -9.81, 0});
  step_cells(grid, CellParams{}, c, {gravity, {}, 0}, parcel, 100);
  EXPECT_EQ(c.parcel_place[0], (Vec3{0.1, 0.1, 0}));
}

TEST(Cells, AnOverfullCellLeaksItsExcessAtTheLowestPointThatTheLiquidReaches) {
  const CellGrid grid = square(23);
  CellParams params;
  params.absorption_factor = 0;  // nothing is carried off
  CellContents c = empty_contents(grid);
  const Index from = grid.cell_at(0.1, 0.15);
  const int count = static_cast<int>(1.5 * grid.capacity(from) / parcel);
  for (int k = 0; k < count; ++k) add_parcel(grid, c, 0.1, 0.15, parcel);
  // A wet trail downwards, and a lower wet place that is not joined to it.
  const auto column = static_cast<Index>(grid.columns);
  for (int k = 1; k <= 6; ++k) {
    const Vec3 at = grid.centre(from - column * static_cast<Index>(k));
    for (int n = 0; n < 30; ++n) add_parcel(grid, c, at.x, at.y, parcel);
  }
  for (int n = 0; n < 30; ++n) add_parcel(grid, c, 0.02, 0.01, parcel);
  std::vector<Real> height(grid.cells());
  for (std::size_t i = 0; i < height.size(); ++i) height[i] = grid.centre(i).y;
  Real out = 0, at_leak_time = 0;
  for (int step = 0; step < 100; ++step) {
    const CellStepReport report = step_cells(grid, params, c, {{}, height, 0}, parcel, 0.01);
    for (const CellLeak& l : report.leaks) {
      EXPECT_EQ(l.from, from);
      EXPECT_EQ(l.at, from - 6 * column);
      out += l.kg;
    }
    if (step == 9) at_leak_time = out;
  }
  const Real excess = count * parcel - grid.capacity(from);
  EXPECT_NEAR(at_leak_time, excess * (1 - std::exp(-1)), 2 * parcel);  // whole parcels
  EXPECT_NEAR(out, excess, 1.01 * parcel);
  EXPECT_GT(c.content_kg[from], grid.capacity(from) * (1 - 1e-12));
}

TEST(Cells, WithoutLeakingAnOverfullCellKeepsAllUntilItHasSpread) {
  const CellGrid grid = square(23);
  CellParams params;
  params.leak = false;
  CellContents c = empty_contents(grid);
  pour(grid, c, 3000, 0.1, 0.1, 0.01);
  EXPECT_TRUE(step_cells(grid, params, c, {}, parcel, 1).leaks.empty());
  EXPECT_EQ(c.parcels(), 3000u);
}

TEST(Cells, DiffusionCarriesExcessOffBeforeItLeaks) {
  Real out[2] = {};
  for (const int fast : {0, 1}) {
    const CellGrid grid = square(23);
    CellParams params;
    params.resistance = fast ? 500 : 1e5, params.leak_time = 0.5;
    CellContents c = empty_contents(grid);
    pour(grid, c, 1500, 0.1, 0.1, 0.006);
    for (int step = 0; step < 200; ++step)
      for (const CellLeak& l : step_cells(grid, params, c, {}, parcel, 0.005).leaks) out[fast] += l.kg;
  }
  EXPECT_LT(out[1], 0.5 * out[0]);
}

TEST(Cells, DryingIsLinearDownToTheKneeThenFalls) {
  const CellGrid grid = square(3, 0.1);
  CellParams params;
  params.absorption_factor = 0;
  CellContents c = empty_contents(grid);
  const Index middle = grid.cell_at(0.05, 0.05);
  const Real capacity = grid.capacity(middle), rate = 2e-4;
  for (int k = 0; k < 10; ++k) add_parcel(grid, c, 0.05, 0.05, 0.1 * capacity);
  const Real to_knee = 0.7 * capacity / (rate * grid.area[middle]);
  Real air = step_cells(grid, params, c, {{}, {}, rate}, 0.1 * capacity, 0.5 * to_knee).evaporated_kg;
  EXPECT_NEAR(air, 0.35 * capacity, 1e-12 * capacity);
  air += step_cells(grid, params, c, {{}, {}, rate}, 0.1 * capacity, 0.5 * to_knee).evaporated_kg;
  EXPECT_NEAR(c.content_kg[middle], 0.3 * capacity, 1e-12 * capacity);
  const Real knee_time = 0.3 * capacity / (rate * grid.area[middle]);
  step_cells(grid, params, c, {{}, {}, rate}, 0.1 * capacity, knee_time);
  EXPECT_NEAR(c.content_kg[middle], 0.3 * capacity * std::exp(-1), 1e-12 * capacity);
  step_cells(grid, params, c, {{}, {}, rate}, 0.1 * capacity, 20 * knee_time);
  EXPECT_EQ(c.parcels(), 0u);  // dry to the last parcel
  EXPECT_EQ(c.content_kg[middle], 0);
}

TEST(Cells, SameBitsForAnyNumberOfThreads) {
  std::vector<Vec3> places[2];
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    const CellGrid grid = square(23);
    CellContents c = empty_contents(grid);
    pour(grid, c, 4000, 0.1, 0.1, 0.02);
    const std::vector<Vec3> gravity(grid.cells(), {0, -9.81, 0});
    for (int step = 0; step < 20; ++step) step_cells(grid, CellParams{}, c, {gravity, {}, 1e-4}, parcel, 0.01);
    places[threads - 1] = c.parcel_place;
  }
  EXPECT_EQ(places[0], places[1]);
}

}  // namespace
}  // namespace imbibe
