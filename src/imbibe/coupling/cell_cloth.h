// Seed B's cloth: a soft (or fixed) sheet whose nodes are cells of liquid (wetting/cells.h), and what the free liquid and
// it give each other.
//
//   arrives   a particle whose way crosses the sheet, or that lies on it: absorbed while the cell has room (a full cell
//             bounces it, or takes it when `bounce` is off), with all its mass and momentum
//   moves     parcels carry their mass, and the momentum of the nodes they leave, to the nodes they reach
//   leaks     parcels wait at the cell where they come out, as a drop that hangs there, until it has the mass at which drops
//             fall (hem_drops.h): then its particles are born, as a drop under the cloth
//   weighs    added mass of a node = contents and waiting mass of its cell;  stiffness x (1 - alpha s), damping + beta s
//
// alpha wet softening, beta s, s saturation of the cell. How the liquid moves from cell to cell, leaks and dries: cell_flow.h.
// Tested in tests/coupling/cell_cloth_test.cpp.
#pragma once

#include <memory>
#include <string>

#include "imbibe/coupling/cell_flow.h"
#include "imbibe/coupling/hem_drops.h"
#include "imbibe/coupling/release.h"
#include "imbibe/coupling/soft_sheet.h"
#include "imbibe/wetting/cells.h"
#include "imbibe/wetting/contents.h"

namespace imbibe {

struct WetClothParams {
  Real softening = 0;  // 1, alpha
  Real damping = 0;    // s, beta
};

template <class V>
void describe(V& v, WetClothParams& p) {
  v.value("softening", p.softening,
          {.min = 0, .max = 0.95, .help = "share of the stiffness lost when full: viscose 0.5, wool 0.4, nylon 0.2, cotton 0; under a "
                                          "network 0: by fibre"});
  v.value("damping", p.damping, {.unit = "s", .shown = "ms", .min = 0, .max = 1, .help = "inner damping added when full; under a network 0: by fibre"});
}

struct CellCloth {
  std::string name;
  SoftSheet soft;
  std::shared_ptr<const CellGrid> grid;
  std::shared_ptr<const std::vector<Index>> node_of_cell;  // on a grid sheet: the cell's own number
  CellParams params;
  WetClothParams wet;
  Vector3<float> colour{0.80f, 0.74f, 0.62f};  // linear RGB when dry
  CellContents contents;            // state
  std::vector<Real> waiting_kg;     // per cell: leaked, not yet a particle (state)
  std::uint64_t absorbed_particles = 0, bounces = 0, released_particles = 0, crossings = 0;  // state
};

// Sets the grid, empty contents and the map to nodes for a sheet whose params and soft part are set.
void fit_cells(CellCloth& cloth);

bool leaks(const CellCloth& cloth);        // a cell is over-full
Real cell_kg(const CellCloth& cloth);      // in cells
Real waiting_kg(const CellCloth& cloth);   // leaked, not yet free

// The drops that hang where it leaks: they add up to waiting_kg.
std::vector<HangingDrop> hanging_drops(const CellCloth& cloth);

// Contents of the cells over their capacity, per node of the sheet (for pictures and files).
std::vector<float> node_saturation(const CellCloth& cloth);

struct CellExchangeReport {
  std::size_t absorbed = 0, bounced = 0, released = 0;
  Real evaporated_kg = 0;
};

// The liquid's particles against the sheet's last step: those that crossed it are absorbed (dead[i] = 1) or thrown back.
void meet_particles(CellCloth& cloth, SoftSheetScratch& scratch, Liquid& liquid, std::span<const Float4> before,
                    std::span<std::uint8_t> dead, const Vec3& gravity, std::uint64_t seed, std::uint64_t step,
                    CellExchangeReport& report);

// Particles that lie on the sheet, within three quarters of a spacing, are absorbed while their cell has room.
void absorb_touching(CellCloth& cloth, SoftSheetScratch& scratch, Liquid& liquid, std::span<std::uint8_t> dead,
                     const Vec3& gravity, CellExchangeReport& report);

// The cells for dt, then whole particles for what has leaked, born where the liquid leaves room and no solid is.
void step_cell_cloth(CellCloth& cloth, SoftSheetScratch& scratch, Liquid& liquid, const Air& air, const Vec3& gravity,
                     Real dt, CellExchangeReport& report, const SolidAt& solid_at = {});

// Added mass, stiffness and damping of the nodes from what their cells hold.
void weigh(CellCloth& cloth);

}  // namespace imbibe
