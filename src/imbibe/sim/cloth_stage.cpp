#include "imbibe/sim/cloth_stage.h"

#include <algorithm>
#include <chrono>

#include "imbibe/sim/solid_at.h"

namespace imbibe {
namespace {

constexpr Real interval_of_moving_cloth = 5e-3;   // s: liquid inside the cloth and what it weighs follow each other
constexpr Real interval_of_leaking_cloth = 2e-2;  // s, at rest
constexpr Real interval_of_wet_cloth = 1;         // s, at rest and nothing due to leak

Real longest_step(const CellCloth& cloth) {
  if (cloth.soft.moves()) return interval_of_moving_cloth;
  if (cloth.contents.parcels() == 0 && waiting_kg(cloth) == 0) return std::numeric_limits<Real>::infinity();
  return leaks(cloth) ? interval_of_leaking_cloth : interval_of_wet_cloth;
}

Real longest_step(const Textile& textile) {
  return textile.cloth && textile.cloth->soft.moves() ? interval_of_moving_cloth : std::numeric_limits<Real>::infinity();
}

std::vector<ClothSolid> solids_of(const World& world) {
  std::vector<ClothSolid> solids;
  for (const SolidBody& body : world.solids) solids.push_back({.shape = body.shape});
  return solids;
}

// Calls visit(sheet, scratch) for all soft sheets: cell cloths, then textiles.
template <class AnyWorld, class Visit>
void each_sheet(AnyWorld& world, StepScratch& scratch, Visit&& visit) {
  scratch.sheets_in_motion.resize(world.cell_cloths.size() + world.textiles.size());
  for (std::size_t i = 0; i < world.cell_cloths.size(); ++i) visit(world.cell_cloths[i].soft, scratch.sheets_in_motion[i]);
  for (std::size_t t = 0; t < world.textiles.size(); ++t)
    if (world.textiles[t].cloth) visit(world.textiles[t].cloth->soft, sheet_of(world, t, scratch));
}

// Particles that crossed a textile's sheet are thrown back to the side they came from: the pressure holds off what is slow.
void meet_textile(World& world, std::size_t t, StepScratch& scratch, StepReport& report) {
  Textile& textile = world.textiles[t];
  const Real thickness = textile.fabric->network.thickness;
  const ImpactParams impact{.restitution = textile.contact.restitution, .scatter = 0,
                            .rest_speed = 0.5 * std::sqrt(norm(world.gravity) * world.liquid.spacing())};
  const std::size_t thrown = throw_back(textile.cloth->soft, sheet_of(world, t, scratch), world.liquid,
                                        scratch.liquid.fields.position, 0.5 * thickness, impact, world.seed, world.step);
  textile.exchange.bounces += thrown;
  report.hits += thrown;
}

}  // namespace

void ready_cloths(const World& world, StepScratch& scratch) {
  scratch.embeddings.resize(world.textiles.size());
  each_sheet(world, scratch, [](const SoftSheet& soft, SoftSheetScratch& own) {
    if (own.surface.empty()) set_step(own.surface, soft.sheet.position, soft.sheet.position, soft.sheet.triangles);
    find_held(soft, own.held);
  });
  for (std::size_t t = 0; t < world.textiles.size(); ++t)
    if (world.textiles[t].cloth) update_normals(scratch.embeddings[t], world.textiles[t].cloth->soft.sheet);
}

SoftSheetScratch& sheet_of(const World& world, std::size_t textile, StepScratch& scratch) {
  return scratch.sheets_in_motion[world.cell_cloths.size() + textile];
}

ClothPlace place_of(const World& world, std::size_t t, const StepScratch& scratch) {
  const Textile& textile = world.textiles[t];
  if (!textile.cloth) return textile.placement;
  // Far enough for the support of the liquid's kernel and for what is born beside the face.
  const Real reach = 0.5 * textile.fabric->network.thickness + 3 * world.liquid.spacing();
  return {*textile.cloth->embedding, textile.cloth->soft.sheet, scratch.embeddings[t],
          &scratch.sheets_in_motion[world.cell_cloths.size() + t].surface, reach};
}

void add_sheet_walls(const World& world, StepScratch& scratch) {
  for (std::size_t i = 0; i < world.cell_cloths.size(); ++i)
    scratch.walls.push_back(sheet_as_wall(world.cell_cloths[i].soft, scratch.sheets_in_motion[i]));
}

bool any_network_cloth_moves(const World& world) {
  return std::any_of(world.textiles.begin(), world.textiles.end(),
                     [](const Textile& textile) { return textile.cloth && textile.cloth->soft.moves(); });
}

bool any_cloth_moves(const World& world) {
  return any_network_cloth_moves(world) ||
         std::any_of(world.cell_cloths.begin(), world.cell_cloths.end(),
                     [](const CellCloth& cloth) { return cloth.soft.moves(); });
}

bool any_threads_resist(const World& world) {
  return std::any_of(world.cell_cloths.begin(), world.cell_cloths.end(),
                     [](const CellCloth& cloth) { return threads_resist(cloth.soft); }) ||
         std::any_of(world.textiles.begin(), world.textiles.end(),
                     [](const Textile& textile) { return textile.cloth && threads_resist(textile.cloth->soft); });
}

Real longest_cloth_step(const World& world) {
  Real longest = std::numeric_limits<Real>::infinity();
  for (const CellCloth& cloth : world.cell_cloths) longest = std::min(longest, longest_step(cloth));
  for (const Textile& textile : world.textiles) longest = std::min(longest, longest_step(textile));
  return longest;
}

void advance_cloths(World& world, Real dt, StepScratch& scratch, StepReport& report) {
  if (!any_soft_sheet(world)) return;
  const auto start = std::chrono::steady_clock::now();
  const std::vector<ClothSolid> solids = solids_of(world);
  each_sheet(world, scratch, [&](SoftSheet& soft, SoftSheetScratch& own) {
    report.cloth_moved = report.cloth_moved || soft.moves();
    report.cloth_substeps += advance_sheet(soft, own, world.gravity, solids, dt).substeps;
  });
  report.cloth_wall_s += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void meet_cloths(World& world, Real dt, StepScratch& scratch, StepReport& report) {
  if (!any_soft_sheet(world)) return;
  const auto start = std::chrono::steady_clock::now();
  scratch.dead.assign(world.liquid.particles.size(), 0);
  CellExchangeReport exchange;
  each_sheet(world, scratch, [&](SoftSheet& soft, SoftSheetScratch& own) {
    if (report.liquid_moved) take_wall_impulse(soft, own, world.gravity, dt);
    finish_sheet(soft, own, dt);
  });
  if (report.liquid_moved) {
    for (std::size_t i = 0; i < world.cell_cloths.size(); ++i) {
      CellCloth& cloth = world.cell_cloths[i];
      SoftSheetScratch& own = scratch.sheets_in_motion[i];
      meet_particles(cloth, own, world.liquid, scratch.liquid.fields.position, scratch.dead, world.gravity, world.seed,
                     world.step, exchange);
      absorb_touching(cloth, own, world.liquid, scratch.dead, world.gravity, exchange);
    }
    for (std::size_t t = 0; t < world.textiles.size(); ++t)
      if (world.textiles[t].cloth) meet_textile(world, t, scratch, report);
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
  ready_cloths(world, scratch);
  report.cloth_wall_s += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace imbibe
