// One step of the free liquid. Stages in order, each in its own file over the arrays of fields.h:
//
//   neighbours.h       sort_particles, build_lists
//   boundary.h         sample_walls
//   density.h          compute_density         colour, filling, their gradient, density error
//   gradient_correction.h  correct_gradients   of the pressure's operator, for the disorder of the particles
//   surface_tension.h  compute_surface         force of the surface and of the contact line, particle classes
//   viscosity.h        apply_viscosity         with what contact lines ask for; before the surface's stage but for thick liquid with tension
//   damping.h          damp_small_scales       (with surface tension)
//   (kick)             velocity += dt (gravity + force)
//   pressure.h         project_velocity        once for a displacement that undoes density errors, once for a velocity
//                                              without compression
//   (move)             position += dt velocity, then keep_outside
//
// Symplectic Euler; step bounds in liquid_step_bound. Tested in tests/liquid/liquid_step_test.cpp.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "imbibe/core/parameter.h"
#include "imbibe/core/types.h"
#include "imbibe/liquid/fields.h"
#include "imbibe/liquid/liquid_kind.h"
#include "imbibe/liquid/particles.h"
#include "imbibe/liquid/pressure.h"
#include "imbibe/liquid/surface_tension.h"
#include "imbibe/liquid/viscosity.h"
#include "imbibe/liquid/wall.h"

namespace imbibe {

struct LiquidParams {
  Real convective_factor = 0.4;      // step <= factor dx/|u|max, and factor for |a|
  Real capillary_factor = 0.5;       // step <= factor sqrt(rho dx^3/(2 pi gamma))
  Real support = support_over_spacing;  // H/dx; 2 has 32 neighbours at half the cost, too few for surface tension
  Real position_correction = 0.5;     // part of the density error undone per step by moving particles; 0: by velocity
  Real max_density_error = 3e-4;     // mean relative error that this correction may leave of the part
  bool surface_tension = true;
  ViscosityParams viscosity;
  SurfaceParams surface;
  PressureParams pressure;
};

template <class V>
void describe(V& v, LiquidParams& p) {
  v.value("convective_factor", p.convective_factor,
          {.min = 0, .max = 1, .above_min = true, .help = "largest move of a particle per step, in spacings"});
  v.value("capillary_factor", p.capillary_factor,
          {.min = 0, .max = 2, .above_min = true, .help = "longest step, in shortest capillary times"});
  v.value("support", p.support,
          {.min = 1.9, .max = 4, .help = "reach of the kernel in spacings: 2 has 32 neighbours and half the cost of 2.5, "
                                       "for liquid without surface tension"});
  v.value("position_correction", p.position_correction,
          {.min = 0, .max = 1, .help = "part of the density error undone per step by moving particles without giving "
                                       "them velocity; 0: the error fades through the velocity (pressure.density_time)"});
  v.value("max_density_error", p.max_density_error,
          {.min = 1e-6, .max = 0.1, .help = "mean relative density error that the correction may leave"});
  v.value("surface_tension", p.surface_tension, {.help = "surface tension and contact angle act"});
  v.group("viscosity", p.viscosity, "viscosity");
  v.group("surface", p.surface, "surface tension and contact angle");
  v.group("pressure", p.pressure, "incompressible pressure");
}

struct LiquidStepReport {
  Real step_s = 0;                // the step made
  const char* bound = "";         // "convective", "gravity", "capillary" or "given"
  int pressure_iterations = 0;    // of the velocity
  int divergence_iterations = 0;  // of the position correction
  int viscosity_iterations = 0;   // 0: explicit
  Real density_error = 0;         // mean |relative density error| at the start of the step
  Real compression = 0;           // mean of what the kernel sum has above 1 there, the usual measure of such solvers
  Real peak_density_error = 0;    // largest compression of one particle there
  Real remaining_density_error = 0;  // mean that the position correction left, predicted
  Real divergence_error = 0;      // mean relative compression per step that the projection left
  std::size_t surface_particles = 0;
  Vec3 surface_force{};           // N, net force of the curvature part
  Real max_speed = 0;             // m/s after the step
  std::size_t put_back = 0;       // particles the positional safety net moved
  bool converged = true;
  // N s given to each wall of the step: all of it (pressure, friction, the pull of contact lines), so that the liquid's
  // momentum changes by gravity less these; and its part by pressure and impact alone, p A under a drop, which drives
  // liquid into pores.
  std::vector<Vec3> wall_impulse, wall_pressure_impulse;
  // Wall-clock seconds per stage, for benchmarks.
  struct Times {
    double sort = 0, walls = 0, lists = 0, density = 0, viscosity = 0, surface = 0, pressure = 0, move = 0;
  } times;
};

// Work space kept between steps so that nothing is allocated; not state: results do not depend on it.
struct LiquidScratch {
  LiquidFields fields;
  SurfaceScratch surface;
  SheetContacts sheets;
  std::vector<SheetWall*> sheet_walls;  // per wall; null for the others
  std::vector<float> sliver_warm, sliver_warm_shift;  // warm starts of a step that is cut short
};

struct LiquidStepBound {
  Real step_s = 0;
  const char* bound = "";
};

// The shortest capillary time sqrt(rho dx^3/(2 pi gamma)), s; infinite without surface tension.
Real shortest_capillary_time(const Liquid& liquid, const LiquidParams& params);

// The longest stable step now, and what holds it.
LiquidStepBound liquid_step_bound(const Liquid& liquid, const LiquidParams& params, const Vec3& gravity);

// Advances the liquid by min(max_step, bound). Throws NumericalError when a velocity is no longer finite.
LiquidStepReport step_liquid(Liquid& liquid, const LiquidParams& params, std::span<const Wall> walls,
                             const Vec3& gravity, Real max_step, LiquidScratch& scratch);

}  // namespace imbibe
