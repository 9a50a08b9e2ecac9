// The cells of a sheet: their grid, area and nodes.
#include <algorithm>
#include <numeric>

#include "imbibe/coupling/cell_cloth.h"

namespace imbibe {
namespace {

Bounds material_bounds(const Sheet& sheet) {
  Bounds b;
  for (std::size_t n = 0; n < sheet.size(); ++n) b.include({sheet.u[n], sheet.v[n], 0});
  return b;
}

// Area of the sheet in each cell of a free-form sheet: every triangle is cut into small ones, each counted at its middle, first
// for the cell it lies in, which tells the cells that there are, then with the weights of contents (cell_flow.h).
template <class Visit>
void each_small_triangle(const Sheet& sheet, Visit&& visit) {
  constexpr int cuts = 8;
  for (const auto& t : sheet.triangles) {
    const Vec3 a{sheet.u[t[0]], sheet.v[t[0]], 0}, b{sheet.u[t[1]], sheet.v[t[1]], 0}, c{sheet.u[t[2]], sheet.v[t[2]], 0};
    const Real part = 0.5 * norm(cross(b - a, c - a)) / (cuts * cuts);
    for (int i = 0; i < cuts; ++i)
      for (int j = 0; j < 2 * (cuts - i) - 1; ++j) {
        const Real third = j % 2 == 0 ? 1.0 / 3 : 2.0 / 3;
        const Real x = (i + third) / cuts, y = (j / 2 + third) / cuts;
        const Vec3 p = a + x * (b - a) + y * (c - a);
        visit(p, part);
      }
  }
}

void find_areas(const Sheet& sheet, CellGrid& grid) {
  grid.area.assign(static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows), 0);
  each_small_triangle(sheet, [&](const Vec3& p, Real part) { grid.area[grid.cell_at(p.x, p.y)] += part; });
  std::vector<Real> weighted(grid.area.size(), 0);
  each_small_triangle(sheet, [&](const Vec3& p, Real part) {
    const CellStencil s = stencil_at(grid, p);
    for (std::size_t k = 0; k < s.count; ++k) weighted[s.cell[k]] += s.weight[k] * part;
  });
  grid.area = std::move(weighted);
}

// What the weights of a rectangle's outermost cells cover of an edge: 1/2 + 1/24 of a cell, and so much less beside it.
Real edge_share(int i, int cells) {
  constexpr Real more = 1.0 / 24;
  const bool first = i == 0, last = i == cells - 1;
  return 1 - (first || last ? 0.5 - more : 0) - (i == 1 ? more : 0) - (i == cells - 2 ? more : 0);
}

CellGrid grid_cells(const Sheet& sheet, Real capacity_per_area) {
  const Bounds b = material_bounds(sheet);
  CellGrid grid = rectangular_cells(static_cast<int>(sheet.columns), static_cast<int>(sheet.rows), b.size().x, b.size().y, capacity_per_area);
  for (int j = 0; j < grid.rows; ++j)
    for (int i = 0; i < grid.columns; ++i)
      grid.area[static_cast<std::size_t>(j * grid.columns + i)] =
          grid.pitch_x * edge_share(i, grid.columns) * grid.pitch_y * edge_share(j, grid.rows);
  return grid;
}

CellGrid free_form_cells(const Sheet& sheet, std::optional<Real> size, Real capacity_per_area) {
  const Bounds b = material_bounds(sheet);
  Real area = 0;
  for (const Real a : node_areas(sheet)) area += a;
  const Real pitch = size.value_or(std::sqrt(area / static_cast<Real>(sheet.size())));
  CellGrid grid;
  const auto fit = [&](Real length) { return std::max(2, static_cast<int>(std::lround(length / pitch))); };
  grid.columns = fit(b.size().x), grid.rows = fit(b.size().y);
  grid.pitch_x = b.size().x / grid.columns, grid.pitch_y = b.size().y / grid.rows;
  grid.first_x = b.lower.x + 0.5 * grid.pitch_x, grid.first_y = b.lower.y + 0.5 * grid.pitch_y;
  grid.lower_x = b.lower.x, grid.lower_y = b.lower.y, grid.upper_x = b.upper.x, grid.upper_y = b.upper.y;
  grid.capacity_per_area = capacity_per_area;
  find_areas(sheet, grid);
  return grid;
}

}  // namespace

void fit_cells(CellCloth& cloth) {
  const Sheet& sheet = cloth.soft.sheet;
  const Real capacity = cloth.params.capacity.value_or(cloth.params.capacity_ratio * sheet.areal_mass);
  std::vector<Index> nodes;
  if (sheet.is_grid()) {
    cloth.grid = std::make_shared<const CellGrid>(grid_cells(sheet, capacity));
    nodes.resize(sheet.size());
    std::iota(nodes.begin(), nodes.end(), Index{0});
  } else {
    cloth.grid = std::make_shared<const CellGrid>(free_form_cells(sheet, cloth.params.cell_size, capacity));
    for (Index c = 0; c < cloth.grid->cells(); ++c) {
      const Vec3 at = cloth.grid->centre(c);
      nodes.push_back(cloth.grid->area[c] > 0 ? node_nearest(sheet, at.x, at.y) : Index{0});
    }
  }
  cloth.node_of_cell = std::make_shared<const std::vector<Index>>(std::move(nodes));
  cloth.contents = empty_contents(*cloth.grid);
  cloth.waiting_kg.assign(cloth.grid->cells(), 0);
}

}  // namespace imbibe
