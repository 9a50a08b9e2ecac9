// The liquid in the cells of a cloth: what parcels do under the absorption force, gravity, leaking and drying.
#include "imbibe/coupling/cell_flow.h"

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

// U for a sheet on which height rises along y as `slope`, and further as `bowl` times the distance from the middle squared.
std::vector<Real> lift_of(const CellGrid& grid, Real slope, Real bowl = 0) {
  std::vector<Real> lift;
  for (std::size_t c = 0; c < grid.cells(); ++c) {
    const Vec3 d = grid.centre(c) - 0.5 * Vec3{grid.lower_x + grid.upper_x, grid.lower_y + grid.upper_y, 0};
    lift.push_back(9.81 * (slope * grid.centre(c).y + bowl * squared_norm(d)));
  }
  return lift;
}

void pour(const CellGrid& grid, CellContents& c, int count, Real x, Real y, Real radius) {
  for (int k = 0; k < count; ++k) {
    const RandomCounter id{7, static_cast<std::uint64_t>(c.parcels()), 0};
    const Real r = radius * std::sqrt(uniform(id, 0)), angle = 2 * pi * uniform(id, 1);
    add_parcel(grid, c, x + r * std::cos(angle), y + r * std::sin(angle), parcel);
  }
}

// An even layer that is a share of what the sheet can hold.
void fill(const CellGrid& grid, CellContents& c, Real share) {
  constexpr int a_side = 60;
  const Real kg = share * grid.upper_x * grid.upper_y * grid.capacity_per_area / (a_side * a_side);
  for (int j = 0; j < a_side; ++j)
    for (int i = 0; i < a_side; ++i)
      add_parcel(grid, c, (i + 0.5) * grid.upper_x / a_side, (j + 0.5) * grid.upper_y / a_side, kg);
}

Real sum(const std::vector<Real>& values) {
  Real total = 0;
  for (const Real v : values) total += v;
  return total;
}

// One step as a cloth makes it; kg that leaked.
Real go(const CellGrid& grid, const CellParams& params, std::span<const Real> lift, Real dt, CellContents& c) {
  CellFlowScratch scratch;
  const std::vector<Real> before = c.content_kg;
  move_parcels(grid, params, lift, dt, c, scratch);
  Real out = 0;
  for (const ParcelLeak& leak : leak_parcels(grid, params, before, lift, dt, c)) out += leak.kg;
  count_contents(grid, c);
  return out;
}

// Root mean square distance from a point.
Real spread(const CellContents& c, Real x, Real y) {
  Real total = 0;
  for (const Vec3& p : c.parcel_place) total += (p.x - x) * (p.x - x) + (p.y - y) * (p.y - y);
  return std::sqrt(total / static_cast<Real>(c.parcels()));
}

Real mean_speed(const CellContents& c) {
  Real total = 0;
  for (const Vec3& v : c.parcel_velocity) total += norm(v);
  return total / static_cast<Real>(c.parcels());
}

TEST(CellStencil, AnEvenSlopeHasItsGradientAndWeightsAddUpToOneWhateverTheCellSize) {
  for (const int nodes : {9, 23, 92}) {
    const CellGrid grid = rectangular_cells(nodes, 2 * nodes, 0.2, 0.1, 0.2);  // cells that are not square
    for (std::uint64_t k = 0; k < 200; ++k) {
      const CellStencil s = stencil_at(grid, {0.2 * uniform({1, k, 0}, 0), 0.1 * uniform({1, k, 0}, 1), 0});
      Real weight = 0;
      for (std::size_t j = 0; j < s.count; ++j) weight += s.weight[j];
      EXPECT_NEAR(weight, 1, 1e-14);
    }
    for (const Vec3& place : {Vec3{0.1034, 0.0511, 0}, Vec3{0, 0.0511, 0}, Vec3{0.2, 0.1, 0}}) {  // up to the edges
      const CellStencil s = stencil_at(grid, place);
      Vec3 gradient{};
      for (std::size_t j = 0; j < s.count; ++j) {
        const Vec3 at = grid.centre(s.cell[j]);
        gradient += (3 * at.x - 2 * at.y) * Vec3{s.gradient_x[j], s.gradient_y[j], 0};
      }
      EXPECT_NEAR(gradient.x, 3, 1e-9) << nodes;
      EXPECT_NEAR(gradient.y, -2, 1e-9) << nodes;
    }
  }
}

TEST(CellFlow, MassIsKeptWhileItSpreadsSinksLeaksAndDries) {
  const CellGrid grid = square(23);
  CellParams params;
  params.resistance = 500;
  CellContents c = empty_contents(grid);
  pour(grid, c, 4000, 0.1, 0.1, 0.02);
  const Real start = total_kg(c);
  const std::vector<Real> lift = lift_of(grid, 1);
  Real out = 0, air = 0;
  for (int step = 0; step < 400; ++step) {
    out += go(grid, params, lift, 0.005, c);
    air += dry_parcels(grid, params, 1e-3, parcel, 0.005, c);
    ASSERT_NEAR(total_kg(c) + out + air, start, 1e-13 * start) << step;  // rounding of sums of 4000 parcels
    ASSERT_NEAR(sum(c.content_kg), total_kg(c), 1e-13 * start);
  }
  EXPECT_GT(out, 0);
  EXPECT_GT(air, 0);
}

TEST(CellFlow, ParcelsNeverLeaveTheSheet) {
  const CellGrid grid = square(12, 0.05);
  CellParams params;
  params.resistance = 2, params.leak = false;
  CellContents c = empty_contents(grid);
  pour(grid, c, 2000, 0.045, 0.005, 0.004);
  const std::vector<Real> lift = lift_of(grid, 1, -20);
  for (int step = 0; step < 100; ++step) go(grid, params, lift, 0.01, c);
  EXPECT_EQ(c.parcels(), 2000u);
  for (const Vec3& x : c.parcel_place)
    EXPECT_TRUE(x.x >= 0 && x.x <= 0.05 && x.y >= 0 && x.y <= 0.05) << x.x << ' ' << x.y;
}

// Many parcels follow ds/dt = div(D s grad s), D = K/zeta: Barenblatt's profile.
TEST(CellFlow, ASpotGrowsAsThePorousMediumEquationSays) {
  const CellGrid grid = square(41);
  CellParams params;
  params.leak = false, params.residual_saturation = 0;
  CellContents c = empty_contents(grid);
  pour(grid, c, 6000, 0.1, 0.1, 0.01);
  const Real diffusivity = params.absorption_factor / params.resistance;
  // u_t = D/2 laplace(u^2): u = t^-1/2 (C - r^2/(8 D t^1/2)) in the plane; mass M = 4 pi D C^2, <r^2> = R^2/3,
  // R^2 = 8 D C t^1/2.
  const Real mass = total_kg(c) / grid.capacity_per_area, constant = std::sqrt(mass / (4 * pi * diffusivity));
  const std::vector<Real> lift = lift_of(grid, 0);
  Real now = 0;
  for (const Real t : {10.0, 25.0}) {
    for (; now < t - 1e-9; now += 0.25) go(grid, params, lift, 0.25, c);
    const Real radius = std::sqrt(8 * diffusivity * constant * std::sqrt(t) / 3);
    // The start has the size of 2 cells, and at the rim a cell holds a few parcels only: 5 %.
    EXPECT_NEAR(spread(c, 0.1, 0.1), radius, 0.05 * radius) << t;
  }
}

TEST(CellFlow, FinerCellsSpreadAlike) {
  std::vector<Real> seen;
  for (const int nodes : {23, 92}) {
    const CellGrid grid = square(nodes);
    CellParams params;
    params.leak = false;
    CellContents c = empty_contents(grid);
    pour(grid, c, 6000, 0.1, 0.1, 0.02);
    const std::vector<Real> lift = lift_of(grid, 0);
    for (int step = 0; step < 40; ++step) go(grid, params, lift, 0.2, c);
    seen.push_back(spread(c, 0.1, 0.1));
  }
  EXPECT_NEAR(seen[0], seen[1], 0.1 * seen[1]);  // the 10 % between 23 x 23 and 92 x 92
}

TEST(CellFlow, GravityCarriesLiquidDownAtItsDriftSpeed) {
  const CellGrid grid = square(33);
  CellParams params;
  params.absorption_factor = 0, params.residual_saturation = 0, params.resistance = 1000, params.leak = false;
  CellContents c = empty_contents(grid);
  add_parcel(grid, c, 0.1, 0.18, parcel);
  const std::vector<Real> lift = lift_of(grid, 1);
  for (int step = 0; step < 100; ++step) go(grid, params, lift, 0.1, c);
  // Starts from rest: one relaxation time 1/zeta is lost.
  EXPECT_NEAR(c.parcel_place[0].y, 0.18 - 9.81e-3 * (10 - 1e-3), 1e-9);
}

TEST(CellFlow, TheLeastWaterStaysWhereItIs) {
  const CellGrid grid = square(23);
  CellContents c = empty_contents(grid);
  add_parcel(grid, c, 0.1, 0.1, 0.04 * grid.capacity(grid.cell_at(0.1, 0.1)));
  go(grid, CellParams{}, lift_of(grid, 1), 100, c);
  EXPECT_EQ(c.parcel_place[0], (Vec3{0.1, 0.1, 0}));
}

// J/m3 of liquid times m3: what drag can only lower.
Real energy_of(const CellGrid& grid, const CellParams& params, std::span<const Real> lift, const CellContents& c) {
  Real e = 0;
  for (std::size_t i = 0; i < grid.cells(); ++i) {
    const Real s = cell_saturation(grid, c, i);
    e += grid.capacity(i) * 0.5 * params.absorption_factor * s * s + c.content_kg[i] * lift[i];
  }
  for (std::size_t p = 0; p < c.parcels(); ++p) e += 0.5 * c.parcel_kg[p] * squared_norm(c.parcel_velocity[p]);
  return e;
}

TEST(CellFlow, OverFullCellsOfABowlComeToRestWhereSuctionBalancesGravity) {
  const CellGrid grid = square(12, 0.3, 0.3);
  CellParams params;
  params.resistance = 100;
  CellContents c = empty_contents(grid);
  for (int k = 0; k < 15; ++k) pour(grid, c, 400, 0.16, 0.14, 0.06);
  for (Real& kg : c.parcel_kg) kg *= 10;  // 12 g, on cloth that holds 3.4 g there
  count_contents(grid, c);
  const std::vector<Real> lift = lift_of(grid, 0, 1.5);
  Real energy = energy_of(grid, params, lift, c), out = 0;
  for (int step = 0; step < 1000; ++step) {
    out += go(grid, params, lift, 0.02, c);
    const Real now = energy_of(grid, params, lift, c);
    ASSERT_LE(now, energy * (1 + 1e-4)) << step;  // sub-steps are explicit
    energy = now;
  }
  EXPECT_GT(out, 0);
  EXPECT_LT(mean_speed(c), 1e-3);  // parcels counted in one cell each: 17 mm/s for ever
  const std::vector<Real> at_rest = c.content_kg;
  for (int step = 0; step < 100; ++step) out += go(grid, params, lift, 0.02, c);
  Real changed = 0, least = 1e9, most = -1e9;
  for (std::size_t i = 0; i < grid.cells(); ++i) {
    const Real s = cell_saturation(grid, c, i);
    changed += std::abs(c.content_kg[i] - at_rest[i]);
    EXPECT_LE(s, 1.001);
    if (s < 0.15) continue;
    const Real potential = params.absorption_factor * s + lift[i];
    least = std::min(least, potential), most = std::max(most, potential);
  }
  EXPECT_LT(changed, 1e-3 * total_kg(c));
  EXPECT_LT(most - least, 0.05 * params.absorption_factor);  // a parcel of a twentieth of a cell
}

TEST(CellFlow, AnOverfullPlaceLeaksItsExcessAtTheLowestPointThatTheLiquidReaches) {
  const CellGrid grid = square(23);
  CellParams params;
  params.absorption_factor = 0, params.resistance = 1e8;  // nothing is carried off
  CellContents c = empty_contents(grid);
  const Index top = grid.cell_at(0.1, 0.15);
  const auto column = static_cast<Index>(grid.columns);
  const Real capacity = grid.capacity(top);
  const auto put = [&](Index cell, Real share) {
    for (int k = 0; k < 20; ++k) add_parcel(grid, c, grid.centre(cell).x, grid.centre(cell).y, share * capacity / 20);
  };
  put(top, 2.5);
  for (Index k = 1; k <= 6; ++k) put(top - k * column, 0.3);  // a wet trail downwards
  put(grid.cell_at(0.02, 0.01), 0.3);                         // a lower wet place that is not joined to it
  const std::vector<Real> lift = lift_of(grid, 1);
  const Real excess = c.content_kg[top] - capacity;
  ASSERT_GT(excess, 0.2 * capacity);
  for (int step = 0; step < 200; ++step) {
    const std::vector<Real> before = c.content_kg;
    Real out = 0;
    for (const ParcelLeak& leak : leak_parcels(grid, params, before, lift, 0.01, c)) {
      EXPECT_GE(leak.at, top - 7 * column - 1);  // weights wet one cell more around
      EXPECT_LE(leak.at, top - 6 * column + 1);
      out += leak.kg;
    }
    if (step == 0) { EXPECT_NEAR(out, excess * (1 - std::exp(-0.1)), 1e-12 * excess); }
    count_contents(grid, c);
  }
  EXPECT_NEAR(c.content_kg[top], capacity, 1e-2 * excess);
  EXPECT_GE(c.content_kg[top], capacity * (1 - 1e-12));
}

TEST(CellFlow, WithoutLeakingAnOverfullCellKeepsAllUntilItHasSpread) {
  const CellGrid grid = square(23);
  CellParams params;
  params.leak = false;
  CellContents c = empty_contents(grid);
  pour(grid, c, 3000, 0.1, 0.1, 0.01);
  EXPECT_EQ(go(grid, params, lift_of(grid, 0), 1, c), 0);
  EXPECT_EQ(c.parcels(), 3000u);
}

TEST(CellFlow, DiffusionCarriesExcessOffBeforeItLeaks) {
  Real out[2] = {};
  for (const int fast : {0, 1}) {
    const CellGrid grid = square(23);
    CellParams params;
    params.resistance = fast ? 500 : 1e5, params.leak_time = 0.5;
    CellContents c = empty_contents(grid);
    pour(grid, c, 1500, 0.1, 0.1, 0.006);
    for (int step = 0; step < 200; ++step) out[fast] += go(grid, params, lift_of(grid, 0), 0.005, c);
  }
  EXPECT_GT(out[0], 0);
  EXPECT_LT(out[1], 0.5 * out[0]);
}

TEST(CellFlow, DryingIsLinearDownToTheKneeThenFalls) {
  // Cells away from the edges of a sheet: 7 x 7 of 11 x 11.
  const CellGrid grid = square(11, 0.1);
  const CellParams params;
  CellContents c = empty_contents(grid);
  fill(grid, c, 1);
  const auto middle = [&] { return cell_saturation(grid, c, 5 * 11 + 5); };
  const Real rate = 2e-4, to_knee = 0.7 * 0.2 / rate, start = middle();
  EXPECT_NEAR(start, 1, 1e-3);
  Real kg = total_kg(c), air = dry_parcels(grid, params, rate, 1e-12, 0.5 * to_knee, c);
  EXPECT_NEAR(air, kg - total_kg(c), 1e-12 * kg);
  EXPECT_NEAR(middle(), start - 0.35, 1e-3);
  dry_parcels(grid, params, rate, 1e-12, 0.5 * to_knee, c);
  EXPECT_NEAR(middle(), start - 0.7, 1e-3);
  const Real knee_time = 0.3 * 0.2 / rate, knee = middle();
  dry_parcels(grid, params, rate, 1e-12, knee_time, c);
  EXPECT_NEAR(middle(), knee * std::exp(-1), 1e-3);
  dry_parcels(grid, params, rate, 1e-9, 20 * knee_time, c);
  EXPECT_EQ(c.parcels(), 0u);  // dry to the last parcel
  EXPECT_EQ(sum(c.content_kg), 0);
}

TEST(CellFlow, SameBitsForAnyNumberOfThreads) {
  std::vector<Vec3> places[2];
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    const CellGrid grid = square(23);
    CellContents c = empty_contents(grid);
    pour(grid, c, 4000, 0.1, 0.1, 0.02);
    for (int step = 0; step < 20; ++step) {
      go(grid, CellParams{}, lift_of(grid, 1), 0.01, c);
      dry_parcels(grid, CellParams{}, 1e-4, parcel, 0.01, c);
    }
    places[threads - 1] = c.parcel_place;
  }
  EXPECT_EQ(places[0], places[1]);
}

}  // namespace
}  // namespace imbibe
