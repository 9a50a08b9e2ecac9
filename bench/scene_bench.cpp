// Whole steps of the world: a block of water landing on cloth, as many particles as segments and pores, uptake on; and
// a stain that spreads and dries when no liquid is left on the face.
#include <fmt/format.h>

#include <cmath>

#include "bench.h"
#include "imbibe/sim/step.h"
#include "textile_world.h"

namespace imbibe::bench {
namespace {

struct Landing {
  World world;
  double held = 0;
};

// A flat box of water over the whole cloth, some ten layers high.
Landing landing_of(std::int64_t size) {
  const double before = allocated_bytes();
  const double side = std::sqrt(static_cast<double>(size) / 3) / 3000, wide = 0.9 * side;
  const double spacing = wide / std::sqrt(static_cast<double>(size) / 10);
  const double height = 10 * spacing;
  Landing landing{cloth_world(size, fmt::format(R"(  particle_mass: {:.9g} kg
  boxes:
    - {{centre: [0, 0, {:.9g} m], size: [{:.9g} m, {:.9g} m, {:.9g} m], velocity: [0, 0, -0.3 m/s]}})",
                                                998.2 * spacing * spacing * spacing, 0.5 * height + 0.6e-3, wide, wide,
                                                height)),
                  0};
  StepScratch scratch;
  for (int k = 0; k < 10; ++k) step(landing.world, {.until = 1}, scratch);
  landing.held = (allocated_bytes() - before) / static_cast<double>(size);
  return landing;
}

void whole_steps(benchmark::State& state, std::int64_t size) {
  Landing& landing = shared_fixture<Landing>(size, [&] { return landing_of(size); });
  World world = landing.world;
  StepScratch scratch;
  double liquid = 0, wetting = 0, exchanges = 0;
  for (auto _ : state) {
    const StepReport r = step(world, {.until = 1}, scratch);
    liquid += r.liquid_wall_s, wetting += r.wetting_wall_s, exchanges += r.wetting_ran;
  }
  const auto steps = static_cast<double>(state.iterations());
  report(state, {.items = static_cast<double>(size), .held_bytes_per_item = landing.held});
  report_stage(state, "liquid", liquid / steps);
  report_stage(state, "exchange", wetting / steps);
  report_extra(state, "particles", static_cast<double>(world.liquid.particles.size()));
  report_extra(state, "exchanges", exchanges / steps);
}

// The quickstart's cloth with the stain of its 50 uL, the face dry: nothing but the network is left to step.
World stained_cloth() {
  return world_of(R"(version: 1
title: bench
duration: 1 h
air: {temperature: 20 degC, humidity: 65 %}
liquid: {kind: water, particle_mass: 0.012 mg}
textiles:
  - name: shirting
    size: [36 mm, 36 mm]
    weave: plain
    warp: {fibre: cotton, linear_density: 20 tex, density: 30 /cm}
    weft: {fibre: cotton, linear_density: 20 tex, density: 28 /cm}
    start: {spots: [{size: [28 mm, 28 mm], yarns: 0.95, pores: 0.05}]}
)");
}

// `size` seconds of it, without output; an item is a second of the simulated time.
void network_alone(benchmark::State& state, std::int64_t size) {
  const World& start = shared_fixture<World>(size, stained_cloth);
  const auto until = static_cast<Real>(size);
  double wall = 0, steps = 0, newton = 0;
  for (auto _ : state) {
    World world = start;
    StepScratch scratch;
    while (world.time < until) {
      const StepReport r = step(world, {.until = until}, scratch);
      ++steps, wall += r.wetting_wall_s, newton += r.wetting_iterations;
    }
  }
  const auto passes = static_cast<double>(state.iterations());
  report(state, {.items = static_cast<double>(size)});
  report_extra(state, "times_real_time", until * passes / wall);
  report_extra(state, "steps", steps / passes);
  report_extra(state, "newton", newton / passes);
}

}  // namespace

void add_scene_benchmarks(const BenchOptions& options) {
  add_family(options, "step/landing", {10'000, 100'000, 1'000'000},
             [](std::int64_t size) { return size <= 10'000 ? 30 : size <= 100'000 ? 10 : 4; }, whole_steps);
  add_family(options, "step/network_alone", {60, 3600}, [](std::int64_t) { return 1; }, network_alone);
}

}  // namespace imbibe::bench
