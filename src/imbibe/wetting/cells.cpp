#include "imbibe/wetting/cells.h"

#include <algorithm>
#include <numeric>

#include "imbibe/core/error.h"
#include "imbibe/core/parallel.h"
#include "imbibe/core/portable.h"
#include "imbibe/core/union_find.h"

namespace imbibe {
namespace {

constexpr Real least_share_of_parcel = 1e-3;

// sum_j (d_j/|d_j|)^2 along x and y over the 8 neighbours of a cell, from its centre.
std::array<Real, 2> direction_sums(const CellGrid& grid) {
  const Real xx = grid.pitch_x * grid.pitch_x, yy = grid.pitch_y * grid.pitch_y;
  return {2 + 4 * xx / (xx + yy), 2 + 4 * yy / (xx + yy)};
}

// Exact step of v' = a - zeta v over time t: what v and a add to the place.
struct Drag {
  Real keep = 1, from_speed = 0, from_force = 0;
};
Drag drag_over(Real resistance, Real t) {
  const Real z = resistance * t;
  if (z < 1e-4) return {1 - z, t * (1 - z / 2), t * t / 2 * (1 - z / 3)};
  const Real first = -portable::expm1(-z) / resistance;
  return {portable::exp(-z), first, (t - first) / resistance};
}

void sum_contents(const CellGrid& grid, CellContents& c) {
  std::fill(c.content_kg.begin(), c.content_kg.end(), 0);
  for (std::size_t p = 0; p < c.parcels(); ++p)
    c.content_kg[grid.cell_at(c.parcel_place[p].x, c.parcel_place[p].y)] += c.parcel_kg[p];
}

// Where a parcel that wants to go from `x` to `to` ends: inside the sheet. Stopped components of its velocity are lost.
Vec3 kept_inside(const CellGrid& grid, const Vec3& x, Vec3 to, Vec3& velocity) {
  if (to.x < grid.lower_x || to.x > grid.upper_x) to.x = std::clamp(to.x, grid.lower_x, grid.upper_x), velocity.x = 0;
  if (to.y < grid.lower_y || to.y > grid.upper_y) to.y = std::clamp(to.y, grid.lower_y, grid.upper_y), velocity.y = 0;
  if (grid.area[grid.cell_at(to.x, to.y)] > 0) return to;
  if (grid.area[grid.cell_at(to.x, x.y)] > 0) return velocity.y = 0, Vec3{to.x, x.y, 0};
  if (grid.area[grid.cell_at(x.x, to.y)] > 0) return velocity.x = 0, Vec3{x.x, to.y, 0};
  velocity = {};
  return x;
}

Real greatest_norm(std::span<const Vec3> vectors) {
  Real square = 0;
  for (const Vec3& v : vectors) square = std::max(square, squared_norm(v));
  return std::sqrt(square);
}

struct Mover {
  const CellGrid& grid;
  const CellParams& params;
  const CellSurroundings& around;
  Real gravity = greatest_norm(around.gravity);  // m/s2, the greatest of any cell
  std::vector<Real> saturation{};
  std::vector<Index> was_in{};

  void show_saturations(const CellContents& c) {
    saturation.resize(grid.cells());
    for (std::size_t i = 0; i < grid.cells(); ++i) saturation[i] = cell_saturation(grid, c, i);
  }

  // Longest sub-step: a quarter of a cell per move, and diffusion that cannot overshoot.
  Real longest(const CellContents& c, Real dt) const {
    const Real h = std::min(grid.pitch_x, grid.pitch_y);
    const Real fullest = saturation.empty() ? 0 : *std::max_element(saturation.begin(), saturation.end());
    const Real pull = params.absorption_factor * std::max(fullest, 1e-3);
    Real step = dt;
    if (pull > 0) step = std::min(step, std::max(params.resistance * h * h / (8 * pull), 0.25 * h / std::sqrt(pull)));
    const Real speed = greatest_norm(c.parcel_velocity);
    if (gravity > 0)
      step = std::min(step, std::max(0.25 * h * params.resistance / gravity, std::sqrt(0.5 * h / gravity)));
    if (speed > 0) step = std::min(step, std::max(0.25 * h / speed, dt * 1e-4));
    return step;
  }

  void move(CellContents& c, Real t, std::vector<CellMove>& moves) {
    was_in.resize(c.parcels());
    const Drag drag = drag_over(params.resistance, t);
    parallel_for(c.parcels(), [&](std::size_t p) {
      Vec3& x = c.parcel_place[p];
      Vec3& v = c.parcel_velocity[p];
      const Index cell = was_in[p] = grid.cell_at(x.x, x.y);
      if (saturation[cell] < params.residual_saturation) {
        v = {};
        return;
      }
      Vec3 a = absorption_force(grid, saturation, params.absorption_factor, cell, x.x, x.y);
      if (!around.gravity.empty()) a += around.gravity[cell];
      const Vec3 to = x + drag.from_speed * v + drag.from_force * a;
      v = drag.keep * v + drag.from_speed * a;
      x = kept_inside(grid, x, to, v);
    });
    std::fill(c.content_kg.begin(), c.content_kg.end(), 0);
    for (std::size_t p = 0; p < c.parcels(); ++p) {
      const Index cell = grid.cell_at(c.parcel_place[p].x, c.parcel_place[p].y);
      if (cell != was_in[p]) moves.push_back({was_in[p], cell, c.parcel_kg[p]});
      c.content_kg[cell] += c.parcel_kg[p];
    }
  }
};

// For each cell the lowest cell that wet cells connect it with; itself where it is dry.
std::vector<Index> lowest_reached(const CellGrid& grid, std::span<const Real> saturation, Real wet,
                                  std::span<const Real> height) {
  std::vector<Index> parent;
  separate_all(parent, grid.cells());
  const auto lower = [&](Index a, Index b) {
    return height.empty() || height[a] == height[b] ? a < b : height[a] < height[b];
  };
  const auto join = [&](Index a, Index b) {
    if (!(saturation[a] > wet && saturation[b] > wet)) return;
    a = root_of(parent, a), b = root_of(parent, b);
    if (a == b) return;
    if (lower(a, b)) parent[b] = a;
    else parent[a] = b;
  };
  for (int j = 0; j < grid.rows; ++j)
    for (int i = 0; i < grid.columns; ++i) {
      const auto here = static_cast<Index>(j * grid.columns + i), row = static_cast<Index>(grid.columns);
      if (i + 1 < grid.columns) join(here, here + 1);
      if (j + 1 < grid.rows) {
        join(here, here + row);
        if (i + 1 < grid.columns) join(here, here + row + 1);
        if (i > 0) join(here, here + row - 1);
      }
    }
  std::vector<Index> result(grid.cells());
  for (Index i = 0; i < result.size(); ++i) result[i] = root_of(parent, i);
  return result;
}

void remove_parcels(CellContents& c, const std::vector<std::uint8_t>& gone) {
  std::size_t kept = 0;
  for (std::size_t p = 0; p < c.parcels(); ++p) {
    if (gone[p]) continue;
    c.parcel_kg[kept] = c.parcel_kg[p];
    c.parcel_place[kept] = c.parcel_place[p];
    c.parcel_velocity[kept] = c.parcel_velocity[p];
    ++kept;
  }
  c.parcel_kg.resize(kept), c.parcel_place.resize(kept), c.parcel_velocity.resize(kept);
}

// Whole parcels leave the cells that owe them, those that gravity has carried farthest first.
void leak(const Mover& mover, const std::vector<Real>& before, Real dt, CellContents& c, CellStepReport& report) {
  const CellGrid& grid = mover.grid;
  const Real share = -portable::expm1(-dt / mover.params.leak_time);
  bool any = false;
  for (std::size_t i = 0; i < grid.cells(); ++i) {
    const Real excess = c.content_kg[i] - grid.capacity(i);
    if (excess <= 0) {
      c.leak_due_kg[i] = 0;
      continue;
    }
    const Real was = std::max(0.0, before[i] - grid.capacity(i)), carried = std::max(0.0, before[i] - c.content_kg[i]);
    c.leak_due_kg[i] = std::min(excess, c.leak_due_kg[i] + std::max(0.0, was * share - carried));
    any = any || c.leak_due_kg[i] > 0;
  }
  if (!any) return;
  std::vector<std::pair<Real, Index>> order;  // how far down gravity has carried it, parcel
  for (Index p = 0; p < c.parcels(); ++p) {
    const Vec3& x = c.parcel_place[p];
    const Index cell = grid.cell_at(x.x, x.y);
    if (c.leak_due_kg[cell] < c.parcel_kg[p]) continue;
    const Vec3 g = mover.around.gravity.empty() ? Vec3{} : mover.around.gravity[cell];
    order.emplace_back(-dot(g, x), p);
  }
  if (order.empty()) return;
  std::sort(order.begin(), order.end());
  const std::vector<Index> lowest =
      lowest_reached(grid, mover.saturation, mover.params.residual_saturation, mover.around.height);
  std::vector<std::uint8_t> gone(c.parcels(), 0);
  for (const auto& [depth, p] : order) {
    const Index cell = grid.cell_at(c.parcel_place[p].x, c.parcel_place[p].y);
    if (c.leak_due_kg[cell] < c.parcel_kg[p]) continue;
    c.leak_due_kg[cell] -= c.parcel_kg[p];
    report.leaks.push_back({cell, lowest[cell], c.parcel_kg[p]});
    gone[p] = 1;
  }
  remove_parcels(c, gone);
  sum_contents(grid, c);
}

void dry(const CellGrid& grid, const CellParams& params, Real rate, Real parcel_kg, Real dt, CellContents& c,
         CellStepReport& report) {
  if (!params.drying || rate <= 0 || c.parcels() == 0) return;
  std::vector<Real> keep(grid.cells(), 1);
  for (std::size_t i = 0; i < grid.cells(); ++i) {
    const Real content = c.content_kg[i];
    if (content <= 0) continue;
    const Real knee = params.critical_saturation * grid.capacity(i), full = rate * grid.area[i];
    // At the full rate down to the knee, then exponentially.
    const Real until_knee = std::max(0.0, content - knee) / full;
    Real left = content - full * std::min(dt, until_knee);
    if (dt > until_knee) left = knee > 0 ? left * portable::exp(-full * (dt - until_knee) / knee) : 0;
    keep[i] = left / content;
  }
  std::vector<std::uint8_t> gone(c.parcels(), 0);
  bool any = false;
  for (std::size_t p = 0; p < c.parcels(); ++p) {
    const Real was = c.parcel_kg[p];
    Real now = was * keep[grid.cell_at(c.parcel_place[p].x, c.parcel_place[p].y)];
    if (now < least_share_of_parcel * parcel_kg) now = 0, gone[p] = 1, any = true;
    report.evaporated_kg += was - now;
    c.parcel_kg[p] = now;
  }
  if (any) remove_parcels(c, gone);
  sum_contents(grid, c);
}

}  // namespace

Index CellGrid::cell_at(Real x, Real y) const {
  const int i = std::clamp(static_cast<int>(std::lround((x - first_x) / pitch_x)), 0, columns - 1);
  const int j = std::clamp(static_cast<int>(std::lround((y - first_y) / pitch_y)), 0, rows - 1);
  return static_cast<Index>(j * columns + i);
}

Vec3 CellGrid::centre(std::size_t cell) const {
  const auto c = static_cast<std::size_t>(columns);
  return {first_x + pitch_x * static_cast<Real>(cell % c), first_y + pitch_y * static_cast<Real>(cell / c), 0};
}

CellGrid rectangular_cells(int columns, int rows, Real size_x, Real size_y, Real capacity_per_area) {
  IMBIBE_ASSERT(columns >= 2 && rows >= 2);
  CellGrid grid;
  grid.columns = columns, grid.rows = rows;
  grid.pitch_x = size_x / (columns - 1), grid.pitch_y = size_y / (rows - 1);
  grid.upper_x = size_x, grid.upper_y = size_y;
  grid.capacity_per_area = capacity_per_area;
  const auto share = [](int i, int n) { return i == 0 || i == n - 1 ? 0.5 : 1.0; };
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i)
      grid.area.push_back(grid.pitch_x * share(i, columns) * grid.pitch_y * share(j, rows));
  return grid;
}

CellContents empty_contents(const CellGrid& grid) {
  CellContents c;
  c.content_kg.assign(grid.cells(), 0);
  c.leak_due_kg.assign(grid.cells(), 0);
  return c;
}

void add_parcel(const CellGrid& grid, CellContents& contents, Real x, Real y, Real kg) {
  const Index cell = grid.cell_at(x, y);
  if (grid.area[cell] > 0) {
    contents.parcel_place.push_back({std::clamp(x, grid.lower_x, grid.upper_x), std::clamp(y, grid.lower_y, grid.upper_y), 0});
  } else {  // beside a ragged edge: into the nearest cell of the sheet
    Index best = no_index;
    Real nearest = std::numeric_limits<Real>::infinity();
    for (Index i = 0; i < grid.cells(); ++i) {
      const Real square = squared_norm(grid.centre(i) - Vec3{x, y, 0});
      if (grid.area[i] > 0 && square < nearest) nearest = square, best = i;
    }
    IMBIBE_ASSERT(best != no_index);
    contents.parcel_place.push_back(grid.centre(best));
  }
  contents.parcel_velocity.push_back({});
  contents.parcel_kg.push_back(kg);
  const Vec3& at = contents.parcel_place.back();
  contents.content_kg[grid.cell_at(at.x, at.y)] += kg;
}

Real total_kg(const CellContents& contents) {
  return std::accumulate(contents.parcel_kg.begin(), contents.parcel_kg.end(), Real{0});
}

Vec3 absorption_force(const CellGrid& grid, std::span<const Real> saturation, Real factor, Index cell, Real x, Real y) {
  const int column = static_cast<int>(cell) % grid.columns, row = static_cast<int>(cell) / grid.columns;
  Vec3 sum{};
  for (int j = std::max(row - 1, 0); j <= std::min(row + 1, grid.rows - 1); ++j)
    for (int i = std::max(column - 1, 0); i <= std::min(column + 1, grid.columns - 1); ++i) {
      const auto other = static_cast<std::size_t>(j * grid.columns + i);
      if (other == cell || !(grid.area[other] > 0)) continue;
      const Vec3 d{grid.first_x + grid.pitch_x * i - x, grid.first_y + grid.pitch_y * j - y, 0};
      sum += ((saturation[cell] - saturation[other]) / squared_norm(d)) * d;
    }
  const std::array<Real, 2> m = direction_sums(grid);
  return {factor * sum.x / m[0], factor * sum.y / m[1], 0};
}

CellStepReport step_cells(const CellGrid& grid, const CellParams& params, CellContents& contents,
                          const CellSurroundings& around, Real parcel_kg, Real dt) {
  CellStepReport report;
  if (contents.parcels() == 0 || dt <= 0) return report;
  const std::vector<Real> before = contents.content_kg;
  Mover mover{grid, params, around};
  for (Real left = dt; left > 0;) {
    mover.show_saturations(contents);
    const Real longest = mover.longest(contents, left);
    const Real t = longest >= left ? left : left / std::ceil(left / longest);
    mover.move(contents, t, report.moves);
    left = t >= left ? 0 : left - t;
    ++report.sub_steps;
  }
  mover.show_saturations(contents);
  if (params.leak) leak(mover, before, dt, contents, report);
  dry(grid, params, around.evaporation, parcel_kg, dt, contents, report);
  return report;
}

}  // namespace imbibe
