// Cost of a liquid step by stage: drops with surface tension falling on a plate, and on a sheet.
// Milliseconds per step of each stage are counters; run with one and two threads.
#include <benchmark/benchmark.h>

#include "imbibe/core/parallel.h"
#include "imbibe/liquid/liquid_step.h"
#include "imbibe/liquid/source.h"

namespace {

using namespace imbibe;

// One drop of about `particles` particles, 1.64 mL as in seed A's figure 7, just above the plate at 0.3 m/s.
Liquid drop_of(std::int64_t particles) {
  Liquid liquid;
  const Real volume = 1.64e-6, radius = std::cbrt(3 * volume / (4 * pi));
  liquid.particle_mass = liquid.kind.density * volume / static_cast<Real>(particles);
  Source source{.centre = {0, 0, radius + liquid.spacing()}, .volume = volume, .velocity = {0, 0, -0.3}};
  emit(source, liquid, 0, 1);
  return liquid;
}

void liquid_step(benchmark::State& state) {
  const ThreadLimit limit(static_cast<int>(state.range(1)));
  Liquid liquid = drop_of(state.range(0));
  const Shape plate = Box{{0, 0, -0.5e-3}, {60e-3, 60e-3, 1e-3}};
  const Wall wall{&plate, {.contact_angle = radians(70)}, {}, state.range(2) != 0};
  LiquidScratch scratch;
  const auto step = [&] { return step_liquid(liquid, {}, {&wall, 1}, {0, 0, -9.81}, 1, scratch); };
  for (int k = 0; k < 20; ++k) step();
  LiquidStepReport::Times sum;
  double pressure = 0, correction = 0, steps = 0;
  for (auto _ : state) {
    const LiquidStepReport r = step();
    sum.sort += r.times.sort, sum.walls += r.times.walls, sum.lists += r.times.lists;
    sum.density += r.times.density, sum.viscosity += r.times.viscosity, sum.surface += r.times.surface;
    sum.pressure += r.times.pressure, sum.move += r.times.move;
    pressure += r.pressure_iterations, correction += r.divergence_iterations, ++steps;
  }
  const auto ms = [&](double seconds) { return benchmark::Counter(1e3 * seconds / steps); };
  state.counters["sort"] = ms(sum.sort);
  state.counters["walls"] = ms(sum.walls);
  state.counters["lists"] = ms(sum.lists);
  state.counters["density"] = ms(sum.density);
  state.counters["viscosity"] = ms(sum.viscosity);
  state.counters["surface"] = ms(sum.surface);
  state.counters["pressure"] = ms(sum.pressure);
  state.counters["move"] = ms(sum.move);
  state.counters["iterations"] = pressure / steps;
  state.counters["corrections"] = correction / steps;
  state.counters["per_particle"] = benchmark::Counter(
      static_cast<double>(liquid.particles.size()) * steps,
      benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(liquid_step)
    ->ArgNames({"particles", "threads", "sheet"})
    ->Args({8000, 1, 0})
    ->Args({8000, 2, 0})
    ->Args({8000, 2, 1})
    ->Args({80000, 2, 0})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
