// One step of the world, as a short list of named stages in physical order:
//   emit -> liquid -> cloth -> contact -> exchange and wetting -> leave -> ledger
// Two clocks: the free liquid makes SPH steps (1e-5 - 1e-3 s); the textiles make steps of their own interval, each after
// several SPH steps, or alone while no free liquid moves (resting on the face, or none left). Resting liquid still
// feeds the textile: the network takes from its footprint, and when 2 % of it is gone, or the face under it has become
// more wettable, it moves again.
#pragma once

#include "imbibe/coupling/footprint.h"
#include "imbibe/coupling/hem_drops.h"
#include "imbibe/sim/world.h"

namespace imbibe {

struct StepOptions {
  Real until = 0;              // s, do not step past this time
  Real max_step = 1e30;        // s
  Real min_step = 1e-9;        // s, a smaller one is a NumericalError
  bool rest_allowed = true;    // liquid at rest makes no SPH steps
};

// What a step did; observers print it, tests check it.
struct StepReport {
  Real step_s = 0;
  const char* step_bound = "";       // what held the step: "convective", "viscous", "capillary", "wetting", "until", ...
  bool liquid_moved = false;         // an SPH step was made (false: the network ran alone)
  bool wetting_ran = false;
  Real density_error = 0;            // mean relative density error after the pressure solve
  Real peak_density_error = 0;       // largest of one particle
  Vec3 surface_force{};              // N, of curvature on all drops that touch a wall
  int pressure_iterations = 0, divergence_iterations = 0;
  int wetting_iterations = 0;        // Newton iterations of all textiles
  std::size_t hits = 0;              // particles that would have entered a yarn and bounced
  ContactCounts contact;             // boxes and triangles tested
  std::size_t emitted = 0, absorbed = 0, released = 0, left = 0;  // particles
  bool converged = true;
  bool cloth_moved = false;
  int cloth_substeps = 0;
  double liquid_wall_s = 0, wetting_wall_s = 0, cloth_wall_s = 0;  // wall-clock seconds spent
};

// The network solver's memory for one textile. It holds on to the model that its rows were built for, so that another one
// can never stand at the same address.
struct TextileScratch {
  std::shared_ptr<const WettingModel> model;
  WettingScratch wetting;
  WeighScratch weigh;
};

// Work space kept between steps so that nothing is allocated; not state: results do not depend on it.
struct StepScratch {
  LiquidScratch liquid;
  Footprint footprint;
  std::vector<Shape> sheets;
  std::vector<Wall> walls;
  std::vector<std::vector<float>> saturation;  // per textile and node, for the face's contact angle
  std::vector<TextileScratch> textiles;
  std::vector<FaceSupply> supplies;  // of footprint and reservoirs
  std::vector<Real> taken_kg;
  std::vector<std::uint8_t> dead;
  Hem hem;                                     // of the textile that exchanges
  std::vector<Real> hem_kg;
  std::vector<ReleasedLiquid> released_elsewhere;
  std::vector<ParticleHit> hits;
  ContactScratch contact;
  std::vector<SoftSheetScratch> sheets_in_motion;  // of the cell cloths, then of the textiles (empty for fixed ones)
  std::vector<EmbeddingScratch> embeddings;        // of the textiles
};

// Emits what the sources owe at the world's time; step() does it too. For showing a world before its first step.
void emit_due(World& world);

// Throws NumericalError with the world's time and the number of whole steps behind it; the world is then half-way
// through the step that failed, and of no use but to be looked at.
StepReport step(World& world, const StepOptions& options, StepScratch& scratch);

}  // namespace imbibe
