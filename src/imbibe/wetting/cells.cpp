#include "imbibe/wetting/cells.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "imbibe/core/error.h"

namespace imbibe {
Index CellGrid::cell_at(Real x, Real y) const {
  const int i = std::clamp(static_cast<int>(std::lround((x - first_x) / pitch_x)), 0, columns - 1);
  const int j = std::clamp(static_cast<int>(std::lround((y - first_y) / pitch_y)), 0, rows - 1);
  return static_cast<Index>(j * columns + i);
}

Vec3 CellGrid::centre(std::size_t cell) const {
  const auto c = static_cast<std::size_t>(columns);
  return {first_x + pitch_x * static_cast<Real>(cell % c), first_y + pitch_y * static_cast<Real>(cell / c), 0};
}

Vec3 CellGrid::nearest_place(Real x, Real y) const {
  if (area[cell_at(x, y)] > 0) return {std::clamp(x, lower_x, upper_x), std::clamp(y, lower_y, upper_y), 0};
  Index best = no_index;
  Real nearest = std::numeric_limits<Real>::infinity();
  for (Index i = 0; i < cells(); ++i) {
    const Real square = squared_norm(centre(i) - Vec3{x, y, 0});
    if (area[i] > 0 && square < nearest) nearest = square, best = i;
  }
  IMBIBE_ASSERT(best != no_index);
  return centre(best);
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
  return c;
}

Real total_kg(const CellContents& contents) {
  return std::accumulate(contents.parcel_kg.begin(), contents.parcel_kg.end(), Real{0});
}

}  // namespace imbibe
