#include "imbibe/liquid/liquid_step.h"

#include <chrono>
#include <utility>

#include "imbibe/core/error.h"
#include "imbibe/liquid/damping.h"
#include "imbibe/liquid/density.h"
#include "imbibe/liquid/gradient_correction.h"
#include "imbibe/liquid/momentum.h"

namespace imbibe {

namespace {

using Clock = std::chrono::steady_clock;

// Seconds since the last call.
class StageTimer {
 public:
  double lap() {
    const Clock::time_point now = Clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  Clock::time_point last_ = Clock::now();
};

// sqrt(g x height of the liquid): what a column of it reaches, and the speed at which particles under its pressure
// change places.
Real fall_speed(const Liquid& liquid, const Vec3& gravity) {
  const std::vector<Float4>& x = liquid.particles.position;
  const auto highest = [&](const Vec3& up) {
    const Real lowest = -std::numeric_limits<Real>::infinity();
    return parallel_max(x.size(), lowest, [&](std::size_t begin, std::size_t end) {
      Real most = lowest;
      for (std::size_t i = begin; i < end; ++i) most = std::max(most, dot(up, Vec3{x[i].x, x[i].y, x[i].z}));
      return most;
    });
  };
  return x.empty() ? 0 : std::sqrt(std::max(0.0, highest(gravity) + highest(-gravity)));
}

Real greatest_speed(std::span<const Float4> velocity) {
  const float square = parallel_max(velocity.size(), 0.0f, [&](std::size_t begin, std::size_t end) {
    float most = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const Float4& u = velocity[i];
      const float s = u.x * u.x + u.y * u.y + u.z * u.z;
      most = std::max(most, std::isfinite(s) ? s : std::numeric_limits<float>::infinity());
    }
    return most;
  });
  return std::sqrt(static_cast<Real>(square));
}

void kick(LiquidFields& f, const Vec3& gravity, Real dt) {
  const Vec3f g(gravity);
  const auto step = static_cast<float>(dt);
  parallel_for(f.count, [&](std::size_t i) {
    Float4& u = f.velocity[i];
    const Float4& a = f.force[i];
    u = {u.x + step * (g.x + a.x), u.y + step * (g.y + a.y), u.z + step * (g.z + a.z), 0};
  });
}

// f.shift (free until find_shift): gravity, the surface's force and the averaged pressure, which in a steady flow is the
// pressure.
void expect_accelerations(LiquidFields& f, const Particles& p, const Vec3& gravity) {
  pressure_response(f, p.pressure);
  const Vec3f g(gravity);
  parallel_for(f.count, [&](std::size_t i) {
    const Float4 &surface = f.force[i], &a = f.acceleration[i];
    f.shift[i] = {g.x + surface.x + a.x, g.y + surface.y + a.y, g.z + surface.z + a.z, 0};
  });
}

// The displacement that would undo the density errors, as a velocity over dt in f.shift: the same projection as for the
// velocity, for liquid at rest. It moves particles but is not part of their velocity, so it gives them no energy. Plain
// gradients: what counts here is by how much the kernel sum changes.
PressureReport find_shift(LiquidFields& f, const LiquidParams& params, Real dt, std::vector<float>& warm) {
  f.shift.swap(f.velocity);
  f.velocity.assign(f.shift.size(), Float4{});
  PressureParams goal = params.pressure;
  goal.tolerance = params.max_density_error;
  const bool corrected = std::exchange(f.corrected, false);
  const PressureReport report = project_velocity(f, goal, dt, params.position_correction, warm);
  f.corrected = corrected;
  f.shift.swap(f.velocity);
  return report;
}

// The soft sheets among the walls, ready for the solve; null without any.
SheetContacts* take_sheets(LiquidFields& f, std::span<const Wall> walls, Real particle_mass, Real dt,
                          LiquidScratch& scratch) {
  scratch.sheet_walls.assign(walls.size(), nullptr);
  bool any = false;
  for (std::size_t k = 0; k < walls.size(); ++k)
    if (walls[k].sheet != nullptr) scratch.sheet_walls[k] = walls[k].sheet, any = true;
  if (!any) return nullptr;
  collect_feet(f.boundary, f.feet);
  scratch.sheets.begin(f.feet, scratch.sheet_walls, particle_mass, dt);
  return &scratch.sheets;
}

// Positions and results back into the particles. f.position still holds the positions before the move.
void move(LiquidFields& f, Particles& p, Real dt, bool shifts) {
  const auto step = static_cast<float>(dt);
  constexpr float newest = 0.2f;  // of the averaged pressure: a few steps' memory
  const float farthest = 0.2f * f.spacing;
  parallel_for(f.count, [&](std::size_t i) {
    const Float4 &x = f.position[i], &u = f.velocity[i];
    Vec3f way = step * Vec3f{u.x, u.y, u.z};
    if (shifts) {
      const Vec3f shift = step * Vec3f{f.shift[i].x, f.shift[i].y, f.shift[i].z};
      way += std::min(1.0f, farthest / std::max(norm(shift), 1e-30f)) * shift;
    }
    p.position[i] = {x.x + way.x, x.y + way.y, x.z + way.z, 0};
    p.velocity[i] = {u.x, u.y, u.z, 0};
    p.density[i] = f.filling[i] * f.rest_density;
    p.pressure[i] += newest * (f.pressure[i] - p.pressure[i]);
  });
}

// The velocities' sum is what gravity and the walls have left of it (momentum.h). Returns what could not be stored, N s.
Vec3 keep_momentum(const Liquid& liquid, const LiquidFields& f, const SpeedSums& before, const Vec3& gravity, Real dt,
                   std::span<const Vec3> wall_impulse, std::span<Float4> velocity) {
  const Real count = static_cast<Real>(f.count);
  Vec3 given = (count * dt) * gravity;
  for (const Vec3& impulse : wall_impulse) given -= impulse / liquid.particle_mass;
  const Real pushed = parallel_sum(f.count, [&](std::size_t begin, std::size_t end) {
    Real sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += norm(Vec3(f.force[i].x, f.force[i].y, f.force[i].z));
    return sum;
  });
  return liquid.particle_mass * make_up_rounding(velocity, before, given, dt * (pushed + count * norm(gravity)));
}

// Some 1e-12 of the step's impulses, to the node under the first particle on a soft sheet.
void give_rest(const LiquidFields& f, std::span<const Wall> walls, const Vec3& rest, std::vector<Vec3>& wall_impulse) {
  if (f.feet.empty()) return;
  const SheetFoot& foot = *f.feet.front();
  walls[foot.wall].sheet->impulse[foot.node[0]] += rest;
  wall_impulse[foot.wall] += rest;
}

// The time in which something can happen over one spacing: a density error that fades in a few of these neither builds
// up under a flow nor heats the liquid by being kicked out at once.
Real shortest_time(const Liquid& liquid, const LiquidParams& params, const Vec3& gravity) {
  const Real dx = liquid.spacing(), speed = greatest_speed(liquid.particles.velocity);
  Real shortest = shortest_capillary_time(liquid, params);
  if (norm(gravity) > 0) shortest = std::min(shortest, std::sqrt(dx / norm(gravity)));
  if (speed > 0) shortest = std::min(shortest, 2 * dx / speed);
  return shortest;
}

}  // namespace

Real shortest_capillary_time(const Liquid& liquid, const LiquidParams& params) {
  if (!params.surface_tension || liquid.kind.surface_tension <= 0) return std::numeric_limits<Real>::infinity();
  const Real dx = liquid.spacing();
  return std::sqrt(liquid.kind.density * dx * dx * dx / (2 * pi * liquid.kind.surface_tension));
}

LiquidStepBound liquid_step_bound(const Liquid& liquid, const LiquidParams& params, const Vec3& gravity) {
  const Real dx = liquid.spacing();
  LiquidStepBound bound{std::numeric_limits<Real>::infinity(), "given"};
  const auto limit = [&](Real step, const char* name) {
    if (step < bound.step_s) bound = {step, name};
  };
  const Real speed = greatest_speed(liquid.particles.velocity);
  if (speed > 0) limit(params.convective_factor * dx / speed, "convective");
  if (norm(gravity) > 0) {
    limit(params.convective_factor * dx / (fall_speed(liquid, gravity) + std::sqrt(norm(gravity) * dx)), "gravity");
  }
  limit(params.capillary_factor * shortest_capillary_time(liquid, params), "capillary");
  return bound;
}

LiquidStepReport step_liquid(Liquid& liquid, const LiquidParams& params, std::span<const Wall> walls,
                             const Vec3& gravity, Real max_step, LiquidScratch& scratch) {
  LiquidStepReport report;
  report.wall_impulse.assign(walls.size(), {});
  report.wall_pressure_impulse.assign(walls.size(), {});
  LiquidStepBound bound{max_step, "given"};
  if (liquid.particles.size() > 0) bound = liquid_step_bound(liquid, params, gravity);
  const bool sliver = max_step < 0.5 * bound.step_s;
  if (max_step < bound.step_s) bound = {max_step, "given"};
  report.step_s = bound.step_s;
  report.bound = bound.bound;
  if (liquid.particles.size() == 0) return report;
  if (bound.step_s == 0) throw NumericalError(0, 0, "liquid", "a velocity is not finite");
  IMBIBE_ASSERT(std::isfinite(bound.step_s) && bound.step_s > 0);

  const Real dt = bound.step_s, capillary_time = shortest_capillary_time(liquid, params);
  const bool tension = std::isfinite(capillary_time);
  const LiquidKind& kind = liquid.kind;
  LiquidFields& f = scratch.fields;
  Particles& particles = liquid.particles;
  StageTimer timer;
  const SpeedSums speeds_before = sum_speeds(particles.velocity);

  sort_particles(f.neighbours, particles, Kernel(params.support * liquid.spacing()));
  begin_fields(f, liquid);
  report.times.sort = timer.lap();
  sample_walls(f.boundary, f.position, f.count, walls, f.neighbours.kernel);
  report.times.walls = timer.lap();
  build_lists(f.neighbours, f.position, f.boundary.side);
  report.times.lists = timer.lap();
  compute_density(f);
  if (params.pressure.corrected_gradients && !tension) correct_gradients(f, params.pressure.spray_filling);
  report.times.density = timer.lap();

  ViscosityAt viscosity{kind.viscosity, kind.viscosity};
  if (tension) {
    viscosity.walls =
        kind.density * least_viscosity(params.surface, kind.surface_tension, kind.density, liquid.spacing());
    // Away from walls a part of it: with none a free drop of water of 14 spacings feeds on its own displacements.
    viscosity.bulk = std::max(viscosity.bulk, 0.3 * viscosity.walls);
  }
  const Real thickest = std::max(viscosity.bulk, viscosity.walls) / kind.density;
  const auto viscosity_acts = [&](const std::vector<Float4>* expected) {
    const ViscosityReport viscous = apply_viscosity(f, params.viscosity, viscosity, dt, walls, report.wall_impulse, expected);
    report.viscosity_iterations = viscous.iterations;
    if (tension) damp_small_scales(f, static_cast<float>(std::min(0.5, params.surface.damping * dt / capillary_time)));
    report.times.viscosity = timer.lap();
    return viscous.converged;
  };
  // Implicit viscosity wants to know the surface's force; else the line's friction acts on a velocity that viscosity has
  // smoothed, or a film that draws together leaves a hundredth of its particles behind.
  // Without tension the old way too, for now: it hides part of what long steps take from a vortex (decision 10, "forces go in").
  const bool surface_first =
      tension && viscosity_is_implicit(params.viscosity, thickest, f.neighbours.kernel.support, dt);
  bool viscosity_converged = surface_first || viscosity_acts(nullptr);
  const SurfaceReport surface = compute_surface(f, params.surface, tension ? kind.surface_tension : 0, walls, dt,
                                                scratch.surface, particles.kind, report.wall_impulse);
  report.surface_particles = surface.surface_particles;
  report.surface_force = surface.net_force;
  report.times.surface = timer.lap();

  if (surface_first) {
    expect_accelerations(f, particles, gravity);
    viscosity_converged = viscosity_acts(&f.shift);
  }
  kick(f, gravity, dt);
  const Real relaxation = dt / (params.pressure.density_time * shortest_time(liquid, params, gravity));
  const bool shifts = params.position_correction > 0;
  // A step cut far below the usual one has pressures of impulse / dt, a start for the next step that its solver does not
  // come back from: such a step starts warm, but leaves the starts of the others as they were.
  std::vector<float>& warm_shift =
      sliver ? scratch.sliver_warm_shift = particles.warm_divergence : particles.warm_divergence;
  std::vector<float>& warm_pressure = sliver ? scratch.sliver_warm = particles.warm_pressure : particles.warm_pressure;
  if (shifts) {
    const PressureReport shift = find_shift(f, params, dt, warm_shift);
    report.divergence_iterations = shift.iterations;
    report.remaining_density_error = shift.residual;
  }
  SheetContacts* const sheets = take_sheets(f, walls, liquid.particle_mass, dt, scratch);
  const PressureReport pressure =
      project_velocity(f, params.pressure, dt, shifts ? 0 : std::min(1.0, relaxation), warm_pressure, sheets);
  add_wall_impulse(f.boundary, f.wall_push, liquid.particle_mass * dt, report.wall_pressure_impulse);
  report.pressure_iterations = pressure.iterations;
  report.density_error = pressure.density_error;
  report.compression = pressure.compression;
  report.peak_density_error = pressure.peak_density_error;
  report.divergence_error = pressure.residual;
  report.converged = pressure.converged && viscosity_converged;
  report.times.pressure = timer.lap();

  move(f, particles, dt, shifts);
  report.put_back = keep_outside(f.boundary, f.position, particles.position, particles.velocity, f.count, walls,
                                 liquid.spacing(), liquid.particle_mass, report.wall_pressure_impulse);
  for (std::size_t k = 0; k < walls.size(); ++k) report.wall_impulse[k] += report.wall_pressure_impulse[k];
  if (sheets != nullptr) give_feet_impulses(f.boundary, walls, report.wall_impulse);
  const Vec3 rest = keep_momentum(liquid, f, speeds_before, gravity, dt, report.wall_impulse, particles.velocity);
  if (sheets != nullptr) give_rest(f, walls, rest, report.wall_impulse);
  report.max_speed = greatest_speed(particles.velocity);
  if (!std::isfinite(report.max_speed)) throw NumericalError(0, 0, "liquid", "a velocity is not finite");
  report.times.move = timer.lap();
  return report;
}

}  // namespace imbibe
