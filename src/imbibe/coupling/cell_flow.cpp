#include "imbibe/coupling/cell_flow.h"

#include <algorithm>

#include "imbibe/core/parallel.h"
#include "imbibe/core/portable.h"
#include "imbibe/core/union_find.h"

namespace imbibe {
namespace {

constexpr Real least_share_of_parcel = 1e-3;

// Along one axis: the three cells around x, with the spline's values and derivatives there.
struct Axis {
  std::array<int, 3> at;  // -1: beyond the edge
  std::array<Real, 3> weight, slope;
};

Axis axis_at(Real x, Real first, Real pitch, int cells, bool cut_at_centres) {
  const Real place = (x - first) / pitch;
  const int middle = static_cast<int>(std::clamp(std::floor(place + 0.5), Real{0}, static_cast<Real>(cells - 1)));
  const Real u = place - middle, below = 0.5 - u, above = 0.5 + u;
  Axis a{{middle - 1, middle, middle + 1},
         {0.5 * below * below, 0.75 - u * u, 0.5 * above * above},
         {-below / pitch, -2 * u / pitch, above / pitch}};
  if (middle > 0 && middle < cells - 1) return a;
  const std::size_t beyond = middle == 0 ? 0 : 2, inside = 2 - beyond;
  a.at[beyond] = cut_at_centres ? middle : -1;
  if (cut_at_centres) {  // what lies beyond, by a straight line, is 2 w of the edge's cell and -w of the next
    const Real w = a.weight[beyond], d = a.slope[beyond];
    a.weight[beyond] = 0, a.slope[beyond] = 0;
    a.weight[1] += 2 * w, a.slope[1] += 2 * d;
    a.weight[inside] -= w, a.slope[inside] -= d;
  }
  return a;
}

// A rectangle's cells are cut at its edges: their outermost centres lie on them.
bool is_cut_at_centres(const CellGrid& grid) { return grid.first_x == grid.lower_x && grid.first_y == grid.lower_y; }

Axis along_x(const CellGrid& grid, const Vec3& place, bool cut_at_centres) {
  return axis_at(place.x, grid.first_x, grid.pitch_x, grid.columns, cut_at_centres);
}
Axis along_y(const CellGrid& grid, const Vec3& place, bool cut_at_centres) {
  return axis_at(place.y, grid.first_y, grid.pitch_y, grid.rows, cut_at_centres);
}

// Value and gradient of what cells hold, at a place of a sheet.
struct Sample {
  Real value = 0;
  Vec3 gradient{};
};

Sample sample_ragged(const CellGrid& grid, const Vec3& place, std::span<const Real> values) {
  const CellStencil s = stencil_at(grid, place);
  Sample sum;
  for (std::size_t k = 0; k < s.count; ++k) {
    const Real v = values[s.cell[k]];
    sum.value += s.weight[k] * v;
    sum.gradient.x += v * s.gradient_x[k], sum.gradient.y += v * s.gradient_y[k];
  }
  return sum;
}

// Row by row where all the cells are there.
Sample sample(const CellGrid& grid, const Vec3& place, std::span<const Real> values) {
  if (!is_cut_at_centres(grid)) return sample_ragged(grid, place, values);
  const Axis x = along_x(grid, place, true), y = along_y(grid, place, true);
  Sample sum;
  for (std::size_t j = 0; j < 3; ++j) {
    const Real* row = values.data() + static_cast<std::ptrdiff_t>(y.at[j]) * grid.columns;
    const Real a = row[x.at[0]], b = row[x.at[1]], c = row[x.at[2]];
    const Real value = x.weight[0] * a + x.weight[1] * b + x.weight[2] * c;
    sum.value += y.weight[j] * value;
    sum.gradient.x += y.weight[j] * (x.slope[0] * a + x.slope[1] * b + x.slope[2] * c);
    sum.gradient.y += y.slope[j] * value;
  }
  return sum;
}

// Adds kg at a place to the cells that it counts for.
void count(const CellGrid& grid, const Vec3& place, Real kg, std::vector<Real>& content) {
  if (!is_cut_at_centres(grid)) {
    const CellStencil s = stencil_at(grid, place);
    for (std::size_t k = 0; k < s.count; ++k) content[s.cell[k]] += kg * s.weight[k];
    return;
  }
  const Axis x = along_x(grid, place, true), y = along_y(grid, place, true);
  for (std::size_t j = 0; j < 3; ++j) {
    Real* row = content.data() + static_cast<std::ptrdiff_t>(y.at[j]) * grid.columns;
    const Real part = kg * y.weight[j];
    for (std::size_t i = 0; i < 3; ++i) row[x.at[i]] += part * x.weight[i];
  }
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

// The steepest slope of a potential between neighbours, m/s2.
Real steepest(const CellGrid& grid, std::span<const Real> potential) {
  Real slope = 0;
  const auto columns = static_cast<std::size_t>(grid.columns);
  for (std::size_t c = 0; c < grid.cells(); ++c) {
    if ((c + 1) % columns != 0) slope = std::max(slope, std::abs(potential[c + 1] - potential[c]) / grid.pitch_x);
    if (c + columns < grid.cells()) slope = std::max(slope, std::abs(potential[c + columns] - potential[c]) / grid.pitch_y);
  }
  return slope;
}

// Longest sub-step: a quarter of a cell per move, and diffusion that cannot overshoot.
Real longest_sub_step(const CellGrid& grid, const CellParams& params, const CellContents& c, Real gravity, Real dt) {
  const Real h = std::min(grid.pitch_x, grid.pitch_y);
  Real fullest = 1e-3;
  for (std::size_t i = 0; i < grid.cells(); ++i) fullest = std::max(fullest, cell_saturation(grid, c, i));
  const Real pull = params.absorption_factor * fullest;
  Real step = dt;
  if (pull > 0) step = std::min(step, std::max(params.resistance * h * h / (8 * pull), 0.25 * h / std::sqrt(pull)));
  if (gravity > 0) step = std::min(step, std::max(0.25 * h * params.resistance / gravity, std::sqrt(0.5 * h / gravity)));
  Real square = 0;
  for (const Vec3& v : c.parcel_velocity) square = std::max(square, squared_norm(v));
  if (square > 0) step = std::min(step, std::max(0.25 * h / std::sqrt(square), dt * 1e-4));
  return step;
}

void move_once(const CellGrid& grid, const CellParams& params, std::span<const Real> potential, Real t, CellContents& c,
               std::span<const Real> saturation) {
  const Drag drag = drag_over(params.resistance, t);
  parallel_for(c.parcels(), [&](std::size_t p) {
    Vec3& x = c.parcel_place[p];
    Vec3& v = c.parcel_velocity[p];
    if (sample(grid, x, saturation).value < params.residual_saturation) {
      v = {};
      return;
    }
    const Vec3 a = -sample(grid, x, potential).gradient;
    const Vec3 to = x + drag.from_speed * v + drag.from_force * a;
    v = drag.keep * v + drag.from_speed * a;
    x = kept_inside(grid, x, to, v);
  });
  count_contents(grid, c);
}

// For each cell the lowest cell that wet cells connect it with; itself where it is dry.
std::vector<Index> lowest_reached(const CellGrid& grid, const CellContents& contents, Real wet, std::span<const Real> lift) {
  std::vector<Index> parent;
  separate_all(parent, grid.cells());
  const auto is_wet = [&](Index c) { return cell_saturation(grid, contents, c) > wet; };
  const auto lower = [&](Index a, Index b) { return lift[a] == lift[b] ? a < b : lift[a] < lift[b]; };
  const auto join = [&](Index a, Index b) {
    if (!is_wet(a) || !is_wet(b)) return;
    a = root_of(parent, a), b = root_of(parent, b);
    if (a == b) return;
    if (lower(a, b)) parent[b] = a;
    else parent[a] = b;
  };
  const auto row = static_cast<Index>(grid.columns);
  for (int j = 0; j < grid.rows; ++j)
    for (int i = 0; i < grid.columns; ++i) {
      const auto here = static_cast<Index>(j * grid.columns + i);
      const bool right = i + 1 < grid.columns, up = j + 1 < grid.rows;
      if (right) join(here, here + 1);
      if (up) join(here, here + row);
      if (up && right) join(here, here + row + 1);
      if (up && i > 0) join(here, here + row - 1);
    }
  std::vector<Index> result(grid.cells());
  for (Index i = 0; i < result.size(); ++i) result[i] = root_of(parent, i);
  return result;
}

void remove_parcels(CellContents& c, Real least_kg) {
  std::size_t kept = 0;
  for (std::size_t p = 0; p < c.parcels(); ++p) {
    if (!(c.parcel_kg[p] >= least_kg)) continue;
    c.parcel_kg[kept] = c.parcel_kg[p];
    c.parcel_place[kept] = c.parcel_place[p];
    c.parcel_velocity[kept] = c.parcel_velocity[p];
    ++kept;
  }
  c.parcel_kg.resize(kept), c.parcel_place.resize(kept), c.parcel_velocity.resize(kept);
}

}  // namespace

CellStencil stencil_at(const CellGrid& grid, const Vec3& place) {
  const bool cut_at_centres = is_cut_at_centres(grid);
  const Axis x = along_x(grid, place, cut_at_centres), y = along_y(grid, place, cut_at_centres);
  CellStencil s;
  Real sum = 0, sum_x = 0, sum_y = 0;
  for (std::size_t j = 0; j < 3; ++j)
    for (std::size_t i = 0; i < 3; ++i) {
      if (x.at[i] < 0 || y.at[j] < 0) continue;
      const auto cell = static_cast<Index>(y.at[j] * grid.columns + x.at[i]);
      if (!(grid.area[cell] > 0)) continue;
      const std::size_t k = s.count++;
      s.cell[k] = cell;
      sum += s.weight[k] = x.weight[i] * y.weight[j];
      sum_x += s.gradient_x[k] = x.slope[i] * y.weight[j];
      sum_y += s.gradient_y[k] = x.weight[i] * y.slope[j];
    }
  if (s.count == 9) return s;
  for (std::size_t k = 0; k < s.count; ++k) {  // shared by the cells that there are
    s.weight[k] /= sum;
    s.gradient_x[k] = (s.gradient_x[k] - s.weight[k] * sum_x) / sum;
    s.gradient_y[k] = (s.gradient_y[k] - s.weight[k] * sum_y) / sum;
  }
  return s;
}

void count_contents(const CellGrid& grid, CellContents& c) {
  std::fill(c.content_kg.begin(), c.content_kg.end(), 0);
  for (std::size_t p = 0; p < c.parcels(); ++p) count(grid, c.parcel_place[p], c.parcel_kg[p], c.content_kg);
}

CellStencil add_parcel(const CellGrid& grid, CellContents& contents, Real x, Real y, Real kg) {
  contents.parcel_place.push_back(grid.nearest_place(x, y));
  contents.parcel_velocity.push_back({});
  contents.parcel_kg.push_back(kg);
  const CellStencil s = stencil_at(grid, contents.parcel_place.back());
  for (std::size_t k = 0; k < s.count; ++k) contents.content_kg[s.cell[k]] += kg * s.weight[k];
  return s;
}

int move_parcels(const CellGrid& grid, const CellParams& params, std::span<const Real> lift, Real dt, CellContents& contents,
                 CellFlowScratch& scratch) {
  if (contents.parcels() == 0 || dt <= 0) return 0;
  const Real gravity = steepest(grid, lift);
  std::vector<Real>& potential = scratch.potential;
  std::vector<Real>& saturation = scratch.saturation;
  count_contents(grid, contents);
  int sub_steps = 0;
  for (Real left = dt; left > 0; ++sub_steps) {
    const Real longest = longest_sub_step(grid, params, contents, gravity, left);
    const Real t = longest >= left ? left : left / std::ceil(left / longest);
    potential.resize(grid.cells()), saturation.resize(grid.cells());
    for (std::size_t i = 0; i < grid.cells(); ++i) {
      saturation[i] = cell_saturation(grid, contents, i);
      potential[i] = params.absorption_factor * saturation[i] + lift[i];
    }
    move_once(grid, params, potential, t, contents, saturation);
    left = t >= left ? 0 : left - t;
  }
  return sub_steps;
}

std::vector<ParcelLeak> leak_parcels(const CellGrid& grid, const CellParams& params, std::span<const Real> content_before,
                                     std::span<const Real> lift, Real dt, CellContents& c) {
  std::vector<ParcelLeak> leaks;
  if (!params.leak) return leaks;
  const Real share = -portable::expm1(-dt / params.leak_time);
  std::vector<Real> part(grid.cells(), 0);  // of the content, that leaves
  bool any = false;
  for (std::size_t i = 0; i < grid.cells(); ++i) {
    const Real excess = c.content_kg[i] - grid.capacity(i), before = std::max(0.0, content_before[i] - grid.capacity(i));
    const Real carried = std::max(0.0, content_before[i] - c.content_kg[i]);
    const Real due = std::min(excess, before * share - carried);
    if (due > 0) part[i] = due / c.content_kg[i], any = true;
  }
  if (!any) return leaks;
  const std::vector<Index> lowest = lowest_reached(grid, c, params.residual_saturation, lift);
  for (Index p = 0; p < c.parcels(); ++p) {
    const Vec3& x = c.parcel_place[p];
    const Real kg = c.parcel_kg[p] * sample(grid, x, part).value;
    if (!(kg > 0)) continue;
    c.parcel_kg[p] -= kg;
    leaks.push_back({p, lowest[grid.cell_at(x.x, x.y)], kg});
  }
  return leaks;
}

Real dry_parcels(const CellGrid& grid, const CellParams& params, Real evaporation, Real parcel_kg, Real dt, CellContents& c) {
  if (!params.drying || evaporation <= 0 || c.parcels() == 0) return 0;
  std::vector<Real> keep(grid.cells(), 1);
  for (std::size_t i = 0; i < grid.cells(); ++i) {
    const Real content = c.content_kg[i];
    if (content <= 0) continue;
    const Real knee = params.critical_saturation * grid.capacity(i), full = evaporation * grid.area[i];
    // At the full rate down to the knee, then exponentially.
    const Real until_knee = std::max(0.0, content - knee) / full;
    Real left = content - full * std::min(dt, until_knee);
    if (dt > until_knee) left = knee > 0 ? left * portable::exp(-full * (dt - until_knee) / knee) : 0;
    keep[i] = left / content;
  }
  Real evaporated = 0;
  const Real least = least_share_of_parcel * parcel_kg;
  for (std::size_t p = 0; p < c.parcels(); ++p) {
    const Real was = c.parcel_kg[p];
    const Real now = was * sample(grid, c.parcel_place[p], keep).value;
    c.parcel_kg[p] = now < least ? 0 : now;
    evaporated += was - c.parcel_kg[p];
  }
  remove_parcels(c, least);
  count_contents(grid, c);
  return evaporated;
}

}  // namespace imbibe
