// The liquid in the cells of a cloth: how its parcels move along the sheet, leak and dry.
//
//   content    m_c = sum_p m_p w_c(x_p),   s_c = m_c/capacity_c
//   potential  psi_c = K s_c + U_c,   U_c = -g . X_c
//   force      a = K sum_j (s_i - s_j) grad w_j(x) - sum_j U_j grad w_j(x) - zeta v = -sum_j psi_j grad w_j(x) - zeta v
//   position   x' = x + phi1 v + phi2 (a + zeta v),  phi1 = (1 - e^(-zeta dt))/zeta,  phi2 = (dt - phi1)/zeta   (exact)
//   leak       kg in dt = max(0, excess (1 - e^(-dt/tau)) - what motion carried off),  excess = content - capacity
//   drying     kg in dt = E A dt from wet cells, falling as s/s_c below the critical saturation s_c
//
// m_p kg, mass of a parcel; x_p m, its place in the sheet's material coordinates; w_c share of a parcel at x that counts as held
// by cell c: the quadratic B-spline over the cell and its 8 neighbours (sum 1; 3/4 . 3/4 at the centre of c); i the parcel's
// own cell, j its neighbours; capacity kg; psi J/kg, K m2/s2 and zeta 1/s as in wetting/cells.h; g m/s2, X_c m place of the
// cell's node in space; a m/s2; tau s; E kg/(m2 s); A m2, area of the cell.
// Source: seed B 5.3 (difference of contents, distance, factor K); grad w_j takes the place of its d_j/|d_j|^2: an even
// slope pulls as -K grad s whatever the size of the cells. With whole parcels counted in the one cell they are in, as seed B
// does, its force cannot rest: within a cell it draws all parcels to one point, and when that crosses an edge a whole cell's
// content jumps. Full cells then swing between 0.6 and 1.4 for ever. Here it is minus the gradient of an energy,
//
//   E = K/2 sum_c capacity_c s_c^2 + sum_p m_p U(x_p),   U(x) = sum_c U_c w_c(x)
//
// which drag can only lower: without supply parcels come to rest, where K s + U is the same all over the wet cloth.
// Beyond the edges of a rectangle, which are centres of cells, psi goes on by a straight line; at those of a free-form sheet its
// cells share the weights. The areas of cells are weighted alike (fit_cells), so that an even layer has an even s.
// Leaks and vapour leave the parcels of a cell in proportion to what they hold there. A leak comes out at the lowest cell that wet
// cells connect the parcel's with. Below the residual saturation the fibres hold what is there.
// Valid for any zeta >= 0 (sub-steps of a quarter of a cell and 0.125 h^2/D). Parcels only move, leak or dry; contents are their sum.
// Tested in tests/coupling/cell_flow_test.cpp.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "imbibe/wetting/cells.h"

namespace imbibe {

// The cells that a place of the sheet counts for.
struct CellStencil {
  std::size_t count = 0;
  std::array<Index, 9> cell;
  std::array<Real, 9> weight, gradient_x, gradient_y;  // 1, 1/m
};
CellStencil stencil_at(const CellGrid& grid, const Vec3& place);

// Sets content_kg from the parcels.
void count_contents(const CellGrid& grid, CellContents& contents);

// One more parcel, at the nearest place of the sheet. Returns what it counts for.
CellStencil add_parcel(const CellGrid& grid, CellContents& contents, Real x, Real y, Real kg);

// Work space; not state.
struct CellFlowScratch {
  std::vector<Vec3> place_before;              // per parcel
  std::vector<Real> content_before, saturation, potential, lift;  // per cell
  std::vector<Real> moved_kg;                  // per node
  std::vector<Vec3> moved_momentum;
};

// Parcels move for dt; `lift`: U_c per cell. Contents are counted anew. Returns the number of sub-steps.
int move_parcels(const CellGrid& grid, const CellParams& params, std::span<const Real> lift, Real dt, CellContents& contents,
                 CellFlowScratch& scratch);

// Mass that has left a parcel and comes out at a cell.
struct ParcelLeak {
  Index parcel = 0, at = 0;
  Real kg = 0;
};
// content_before: at the beginning of dt. Contents are not counted anew.
std::vector<ParcelLeak> leak_parcels(const CellGrid& grid, const CellParams& params, std::span<const Real> content_before,
                                     std::span<const Real> lift, Real dt, CellContents& contents);

// evaporation: kg/(m2 s) of sheet, both faces together. A parcel below a thousandth of parcel_kg goes to the air whole.
// Returns kg. Contents are counted anew.
Real dry_parcels(const CellGrid& grid, const CellParams& params, Real evaporation, Real parcel_kg, Real dt, CellContents& contents);

}  // namespace imbibe
