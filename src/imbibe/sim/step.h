// One step of the world, as a short list of named stages in physical order.
#pragma once

#include "imbibe/sim/world.h"

namespace imbibe {

struct StepOptions {
  Real until = 0;              // s, do not step past this time
  Real max_step = 1e30;        // s
  Real min_step = 1e-9;        // s, a smaller one is a NumericalError
  bool network_alone = true;   // let the network take long steps once no free liquid moves
};

// What a step did; observers print it, tests check it.
struct StepReport {
  Real step_s = 0;
  const char* step_bound = "";       // what held the step: "convective", "viscous", "capillary", "wetting", "until", ...
  bool liquid_moved = false;         // an SPH step was made (false: the network ran alone)
  Real density_error = 0;            // mean relative density error after the pressure solve
  Real peak_density_error = 0;       // largest of one particle
  int pressure_iterations = 0, divergence_iterations = 0;
  int wetting_iterations = 0;        // Newton iterations of all textiles
  std::size_t absorbed = 0, released = 0, bounced = 0;  // particles
  bool converged = true;
};

StepReport step(World& world, const StepOptions& options);

}  // namespace imbibe
