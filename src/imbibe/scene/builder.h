// From a scene to the World that runs. Everything that can be wrong with a scene beyond single keys is found here,
// with the place of the key that causes it, and thrown once: unknown liquid or fibre, a drop inside cloth or solid,
// overlapping drops, more particles, memory or disk than the limits or the machine allow (estimated before anything
// is allocated). Tested in tests/scene/builder_test.cpp.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "imbibe/scene/library.h"
#include "imbibe/scene/scene.h"
#include "imbibe/sim/run.h"
#include "imbibe/sim/world.h"

namespace imbibe {

// The world that a changed scene goes on from (scene/live_change.h).
struct RunningWorld {
  const Scene& scene;
  const World& world;
  // Brings the new world's sources to where the running ones are, before placements are checked: what has fallen already
  // needs no room.
  std::function<void(World&)> continue_sources;
};

// What a scene will need, from its counts alone.
struct SceneEstimate {
  double particles = 0;          // at most, all drops of all droppers
  double segments = 0, pores = 0, edges = 0;
  double memory_bytes = 0;
  double disk_bytes = 0;         // of the run folder
  double outputs = 0;
  Real spacing = 0;              // m, of the particles
  Real capillary_step = 0;       // s, bound of the SPH step by capillary waves; infinity without liquid
};

// The liquid that `liquid.kind` means. Problems are appended.
LiquidKind liquid_of(const Scene& scene, const Library& library, std::vector<Problem>& problems);

SceneEstimate estimate_scene(const Scene& scene, const LiquidKind& kind);

// bytes, of the machine or of the control group (container) that the program runs in; 0 where the system does not say.
double machine_memory();

// bytes that a run of the scene may take: limits.max_memory, or 80 % of the machine's.
double allowed_memory(const Scene& scene);

// The drops, boxes and droppers of the scene as sources.
std::vector<Source> sources_of(const Scene& scene);
// The pipes of the scene, after the others: sources and what is drawn of them. Throws InputError.
void add_pipes(const Scene& scene, World& world);

// How to step it: to the scene's end, with its output times and limits.
RunPlan run_plan(const Scene& scene);

// `running`, when given: a world that the new one goes on from. Fabrics, models and meshes that are the same are shared
// with it (equal to the bit to what would be built).
World build_world(const Scene& scene, const Library& library, const RunningWorld* running = nullptr);

}  // namespace imbibe
