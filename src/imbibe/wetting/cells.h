// Seed B's wetting: a cloth whose nodes are cells that hold parcels of liquid. The cells and what they hold; how the
// parcels move, leak and dry is coupling/cell_flow.h.
//
//   s = content/capacity,   capacity = capacity_ratio x dry mass (or kg/m2 given) x area of the cell
//
// K absorption factor, m2/s2 (suction over density: 0.5 kPa in water is 0.5); zeta resistance, 1/s (viscosity x voids over
// permeability x density: 1e-10 m2 is 1e4); K/zeta is a diffusivity, m2/s, whatever the size of the cells; tau leak time, s.
// Source: "Wet cloth" (seed B) sections 5.3 and 5.6; Huber et al. 2D automaton behind it. Resistance, residual and drying
// are ours: the report names them as missing. Assumes motion along the sheet is slow: parcels carry the sheet's momentum.
// Tested in tests/wetting/cells_test.cpp.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "imbibe/core/parameter.h"
#include "imbibe/core/types.h"

namespace imbibe {

struct CellParams {
  bool absorb = true, leak = true, bounce = true;
  Real absorption_factor = 0.5;       // m2/s2, K
  Real resistance = 1e4;              // 1/s, zeta
  Real capacity_ratio = 2;            // kg liquid per kg dry cloth
  std::optional<Real> capacity;       // kg/m2, in place of the ratio
  Real residual_saturation = 0.05;    // 1
  Real leak_time = 0.1;               // s, tau
  Real drop_neck = 2e-3;              // m, coupling/hem_drops.h
  bool drying = true;
  Real critical_saturation = 0.3;     // 1, s_c
  Real restitution = 0.3;             // 1, of a bounce
  Real scatter = 0.35;                // rad, greatest random turn of a bounce
  std::optional<Real> cell_size;      // m, on a free-form sheet; a rectangular one has a cell at each node
};

template <class V>
void describe(V& v, CellParams& p) {
  v.value("absorb", p.absorb, {.help = "the cloth takes up what hits it (off: seed B figure 6)"});
  v.value("leak", p.leak, {.help = "over-full cells let liquid go at the lowest point it reaches (off: figure 7)"});
  v.value("bounce", p.bounce, {.help = "full cells throw back what hits them (off: they take it, figure 8)"});
  v.value("absorption_factor", p.absorption_factor,
          {.unit = "m2/s2", .min = 0, .max = 1e4,
           .help = "pull towards emptier cells: suction over density, 0.5 for 0.5 kPa in water"});
  v.value("resistance", p.resistance,
          {.unit = "1/s", .min = 0, .max = 1e9, .help = "drag on liquid inside the cloth; factor/resistance is a diffusivity"});
  v.value("capacity_ratio", p.capacity_ratio,
          {.min = 0, .max = 100, .above_min = true, .help = "liquid that the cloth can hold, per dry mass"});
  v.value("capacity", p.capacity,
          {.unit = "kg/m2", .shown = "g/m2", .min = 0, .max = 1000, .above_min = true,
           .help = "liquid that the cloth can hold per area, in place of capacity_ratio"});
  v.value("residual_saturation", p.residual_saturation,
          {.min = 0, .max = 0.9, .help = "share of the capacity that the fibres hold where it is"});
  v.value("leak_time", p.leak_time,
          {.unit = "s", .min = 0, .max = 1e4, .above_min = true, .help = "time in which an over-full cell leaks its excess"});
  v.value("drop_neck", p.drop_neck,
          {.unit = "m", .shown = "mm", .min = 0, .max = 0.1,
           .help = "radius of the neck of drops that hang where it leaks: they fall at 0.6 2 pi r gamma/g; 0: at once"});
  v.value("drying", p.drying, {.help = "liquid evaporates from both faces"});
  v.value("critical_saturation", p.critical_saturation,
          {.min = 0, .max = 1, .help = "below it drying slows in proportion to what is left"});
  v.value("restitution", p.restitution, {.min = 0, .max = 1, .help = "share of the speed that a bounce keeps"});
  v.value("scatter", p.scatter,
          {.unit = "rad", .shown = "deg", .min = 0, .max = 1.5, .help = "greatest random turn of a bounce"});
  v.value("cell_size", p.cell_size,
          {.unit = "m", .shown = "mm", .min = 0, .above_min = true,
           .help = "edge of a cell on a free-form sheet; default: as many cells as nodes"});
}

// Cells in rows over the material rectangle of a sheet; a cell without area is outside a free-form sheet. Immutable.
struct CellGrid {
  int columns = 0, rows = 0;
  Real pitch_x = 0, pitch_y = 0;      // m
  Real first_x = 0, first_y = 0;      // m, centre of cell 0
  Real lower_x = 0, lower_y = 0, upper_x = 0, upper_y = 0;  // m, edges of the sheet
  std::vector<Real> area;             // m2 per cell, row by row
  Real capacity_per_area = 0;         // kg/m2
  std::size_t cells() const { return area.size(); }
  Index cell_at(Real x, Real y) const;
  Vec3 nearest_place(Real x, Real y) const;  // of the sheet; beside a ragged edge the centre of the nearest cell
  Real capacity(std::size_t cell) const { return capacity_per_area * area[cell]; }
  Vec3 centre(std::size_t cell) const;  // z = 0
};

// columns x rows nodes over a rectangle with a corner at (0, 0): a cell around each node, cut at the edges.
CellGrid rectangular_cells(int columns, int rows, Real size_x, Real size_y, Real capacity_per_area);

// State. Parcels in the order of their arrival.
struct CellContents {
  std::vector<Real> parcel_kg;
  std::vector<Vec3> parcel_place;     // m, material, z = 0
  std::vector<Vec3> parcel_velocity;  // m/s, material
  std::vector<Real> content_kg;       // per cell: the sum of its shares in parcels
  std::size_t parcels() const { return parcel_kg.size(); }
};

CellContents empty_contents(const CellGrid& grid);
Real total_kg(const CellContents& contents);
inline Real cell_saturation(const CellGrid& grid, const CellContents& contents, std::size_t cell) {
  return grid.area[cell] > 0 ? contents.content_kg[cell] / grid.capacity(cell) : 0;
}

}  // namespace imbibe
