#include "imbibe/sim/cloth_stage.h"

#include <algorithm>
#include <chrono>

#include "imbibe/sim/solid_at.h"

namespace imbibe {
namespace {

constexpr Real interval_of_moving_cloth = 5e-3;   // s: liquid inside the cloth and what it weighs follow each other
constexpr Real interval_of_leaking_cloth = 2e-2;  // s, at rest
constexpr Real interval_of_wet_cloth = 1;         // s, at rest and nothing due to leak

bool leaks(const CellCloth& cloth) {
  for (std::size_t c = 0; c < cloth.grid->cells(); ++c)
    if (cloth.contents.content_kg[c] > cloth.grid->capacity(c)) return true;
  return std::any_of(cloth.waiting_kg.begin(), cloth.waiting_kg.end(), [](Real kg) { return kg > 0; });
}

Real longest_step(const CellCloth& cloth) {
  if (cloth.soft.moves()) return interval_of_moving_cloth;
  if (cloth.contents.parcels() == 0 && waiting_kg(cloth) == 0) return std::numeric_limits<Real>::infinity();
  return leaks(cloth) ? interval_of_leaking_cloth : interval_of_wet_cloth;
}

std::vector<ClothSolid> solids_of(const World& world) {
  std::vector<ClothSolid> solids;
  for (const SolidBody& body : world.solids) solids.push_back({.shape = body.shape});
  return solids;
}

}  // namespace

void add_sheet_walls(const World& world, StepScratch& scratch) {
  scratch.sheets_in_motion.resize(world.cell_cloths.size());
  for (std::size_t i = 0; i < world.cell_cloths.size(); ++i)
    scratch.walls.push_back(sheet_as_wall(world.cell_cloths[i].soft, scratch.sheets_in_motion[i]));
}

bool any_cloth_moves(const World& world) {
  return std::any_of(world.cell_cloths.begin(), world.cell_cloths.end(),
                     [](const CellCloth& cloth) { return cloth.soft.moves(); });
}

Real longest_cloth_step(const World& world) {
  Real longest = std::numeric_limits<Real>::infinity();
  for (const CellCloth& cloth : world.cell_cloths) longest = std::min(longest, longest_step(cloth));
  return longest;
}

void advance_cloths(World& world, Real dt, StepScratch& scratch, StepReport& report) {
  if (world.cell_cloths.empty()) return;
  const auto start = std::chrono::steady_clock::now();
  scratch.sheets_in_motion.resize(world.cell_cloths.size());
  const std::vector<ClothSolid> solids = solids_of(world);
  for (std::size_t i = 0; i < world.cell_cloths.size(); ++i) {
    SoftSheet& soft = world.cell_cloths[i].soft;
    report.cloth_moved = report.cloth_moved || soft.moves();
    report.cloth_substeps += advance_sheet(soft, scratch.sheets_in_motion[i], world.gravity, solids, dt).substeps;
  }
  report.cloth_wall_s += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void meet_cloths(World& world, Real dt, StepScratch& scratch, StepReport& report) {
  if (world.cell_cloths.empty()) return;
  const auto start = std::chrono::steady_clock::now();
  scratch.dead.assign(world.liquid.particles.size(), 0);
  CellExchangeReport exchange;
  for (std::size_t i = 0; i < world.cell_cloths.size(); ++i) {
    CellCloth& cloth = world.cell_cloths[i];
    SoftSheetScratch& own = scratch.sheets_in_motion[i];
    if (report.liquid_moved) take_wall_impulse(cloth.soft, own, world.gravity, dt);
    finish_sheet(cloth.soft, own, dt);
    if (!report.liquid_moved) continue;
    meet_particles(cloth, own, world.liquid, scratch.liquid.fields.position, scratch.dead, world.gravity, world.seed,
                   world.step, exchange);
    absorb_touching(cloth, own, world.liquid, scratch.dead, world.gravity, exchange);
  }
  remove_particles(world.liquid.particles, scratch.dead);
  for (std::size_t i = 0; i < world.cell_cloths.size(); ++i)
    step_cell_cloth(world.cell_cloths[i], scratch.sheets_in_motion[i], world.liquid, world.air, world.gravity, dt, exchange,
                    [&](const Vec3& place) { return solid_at(world, no_index, place); });
  world.ledger.evaporated_kg += exchange.evaporated_kg;
  report.absorbed += exchange.absorbed, report.released += exchange.released, report.hits += exchange.bounced;
  if (exchange.released > 0 || (report.cloth_moved && world.pace.resting)) {
    world.pace.resting = false;
    world.pace.calm_since = -1;
  }
  report.cloth_wall_s += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace imbibe
