// Seed B's cells. What their liquid does: tests/coupling/cell_flow_test.cpp.
#include "imbibe/wetting/cells.h"

#include <gtest/gtest.h>

namespace imbibe {
namespace {

TEST(Cells, AreaIsThatOfTheSheet) {
  const CellGrid grid = rectangular_cells(23, 40, 0.3, 0.5, 0.1);
  Real area = 0;
  for (const Real a : grid.area) area += a;
  EXPECT_NEAR(area, 0.15, 1e-14);
}

TEST(Cells, APlaceBesideTheSheetIsBroughtOntoIt) {
  CellGrid grid = rectangular_cells(11, 11, 0.1, 0.1, 0.2);
  EXPECT_EQ(grid.nearest_place(0.033, 0.047), (Vec3{0.033, 0.047, 0}));
  EXPECT_EQ(grid.nearest_place(-0.02, 0.2), (Vec3{0, 0.1, 0}));
  grid.area[grid.cell_at(0.1, 0.1)] = 0;  // a corner cut off
  const Vec3 place = grid.nearest_place(0.102, 0.099);
  EXPECT_EQ(place, grid.centre(grid.cell_at(0.1, 0.09)));
}

}  // namespace
}  // namespace imbibe
