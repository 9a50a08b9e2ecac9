// One step of the free liquid: sort and neighbours, walls, density and classes, viscosity, surface tension and contact
// line, divergence-free velocity, kick, constant density, move.
//
// Stages written in their own files and called from here, in this order (each takes LiquidFields& f):
//   density.h          void compute_density(LiquidFields& f);                      colour, filling, gradient, factor
//   classes.h          void classify(LiquidFields& f, ...);                        surface set, ParticleClass
//   viscosity.h        apply_viscosity(f, params.viscosity, eta, dt, impulse)
//   surface_tension.h  void compute_surface(LiquidFields& f, ..., gamma);          f.force, m/s2
//   pressure.h         solve_divergence(f, params, dt, warm), solve_pressure(f, params, dt, warm)
#pragma once

#include <span>
#include <string>
#include <vector>

#include "imbibe/core/parameter.h"
#include "imbibe/core/types.h"
#include "imbibe/liquid/fields.h"
#include "imbibe/liquid/liquid_kind.h"
#include "imbibe/liquid/particles.h"
#include "imbibe/liquid/viscosity.h"
#include "imbibe/liquid/wall.h"

namespace imbibe {

struct LiquidParams {
  Real max_density_error = 1e-3;     // mean relative compression after the pressure solve
  Real max_divergence_error = 1e-3;  // mean relative compression per step left by the divergence solve
  int max_pressure_iterations = 100;
  int max_divergence_iterations = 100;
  Real convective_factor = 0.4;      // step <= factor dx/|u|max, and factor sqrt(dx/|a|)
  Real capillary_factor = 0.5;       // step <= factor sqrt(rho dx^3/(2 pi gamma))
  bool surface_tension = true;
  ViscosityParams viscosity;
};

template <class V>
void describe(V& v, LiquidParams& p) {
  v.value("max_density_error", p.max_density_error,
          {.min = 1e-6, .max = 0.1, .help = "largest mean compression after a step"});
  v.value("max_divergence_error", p.max_divergence_error,
          {.min = 1e-6, .max = 0.1, .help = "largest mean compression per step that the velocity may still cause"});
  v.value("max_pressure_iterations", p.max_pressure_iterations, {.min = 1, .max = 10000, .help = "limit"});
  v.value("max_divergence_iterations", p.max_divergence_iterations, {.min = 0, .max = 10000, .help = "limit"});
  v.value("convective_factor", p.convective_factor,
          {.min = 0, .max = 1, .above_min = true, .help = "largest move of a particle per step, in spacings"});
  v.value("capillary_factor", p.capillary_factor,
          {.min = 0, .max = 2, .above_min = true, .help = "of the shortest capillary wave's time"});
  v.value("surface_tension", p.surface_tension, {.help = "surface tension and contact angle act"});
  v.group("viscosity", p.viscosity, "viscosity");
}

struct LiquidStepReport {
  Real step_s = 0;                // the step made
  const char* bound = "";         // "convective", "acceleration", "viscous", "capillary" or "given"
  int pressure_iterations = 0, divergence_iterations = 0, viscosity_iterations = 0;
  Real density_error = 0;         // mean relative compression after the pressure solve
  Real peak_density_error = 0;    // largest of one particle
  Real divergence_error = 0;
  Real max_speed = 0;             // m/s after the step
  std::size_t put_back = 0;       // particles the positional safety net moved
  bool converged = true;
  std::vector<Vec3> wall_impulse;  // N s given to each wall of the step
  // Wall-clock seconds per stage, for benchmarks.
  struct Times {
    double sort = 0, lists = 0, walls = 0, density = 0, surface = 0, viscosity = 0, divergence = 0, pressure = 0,
           move = 0;
  } times;
};

// Work space kept between steps so that nothing is allocated; not state: results do not depend on it.
struct LiquidScratch {
  LiquidFields fields;
};

struct LiquidStepBound {
  Real step_s = 0;
  const char* bound = "";
};

// The longest stable step now, and what holds it.
LiquidStepBound liquid_step_bound(const Liquid& liquid, const LiquidParams& params, const Vec3& gravity);

// Advances the liquid by min(max_step, bound). Throws NumericalError when a velocity is no longer finite.
LiquidStepReport step_liquid(Liquid& liquid, const LiquidParams& params, std::span<const Wall> walls,
                             const Vec3& gravity, Real max_step, LiquidScratch& scratch);

}  // namespace imbibe
