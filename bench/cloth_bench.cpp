// Soft cloth: sheets alone as they fall and hang, and a step of liquid and cloth together.
#include <cmath>

#include "bench.h"
#include "imbibe/cloth/cloth_step.h"
#include "imbibe/sim/step.h"

namespace imbibe::bench {
namespace {

// A square of shirting of `nodes` nodes, level at first.
Sheet square(std::int64_t nodes, Real side = 1) {
  const auto n = static_cast<Index>(std::lround(std::sqrt(static_cast<double>(nodes))));
  return make_sheet(GridSheet{.corner = {-0.5 * side, -0.5 * side, 0}, .width = side, .height = side, .columns = n, .rows = n,
                              .areal_mass = fabric_hand("shirting").areal_mass});
}

ClothParams shirting() {
  ClothParams params;
  params.hand = fabric_hand("shirting");
  return params;
}

// The first tenth of a second of its fall, in steps of 5 ms, as the world makes them without liquid, or of 0.2 ms, as it
// makes them with liquid and the peer makes them always (libWetCloth's figure in performance.md).
constexpr Real alone = 5e-3, with_liquid = 0.2e-3;  // s

void falls(benchmark::State& state, std::int64_t size, bool by_edge, Real step_s) {
  Sheet sheet = square(size);
  if (by_edge) pin_nodes(sheet, nodes_of_edge(sheet, "left"));
  else for (const char* corner : {"bottom_left", "top_left"}) pin_nodes(sheet, nodes_of_corner(sheet, corner));
  const ClothParams params = shirting();
  ClothScratch scratch;
  double substeps = 0;
  for (auto _ : state) substeps += step_cloth(sheet, params, {.measure = false}, step_s, scratch).substeps;
  report(state, {.items = static_cast<double>(size)});
  report_extra(state, "substeps", substeps / static_cast<double>(state.iterations()));
}

// Water of as many particles as the sheet has nodes, a film of three layers, 6 mm deep, that lies on a cloth held at its edges.
struct Pool {
  World world;
};
Pool pool_of(std::int64_t size) {
  Pool pool;
  World& world = pool.world;
  CellCloth cloth;
  cloth.soft.sheet = square(size, 0.3);
  for (const char* edge : {"left", "right"}) pin_nodes(cloth.soft.sheet, nodes_of_edge(cloth.soft.sheet, edge));
  cloth.soft.cloth = shirting();
  cloth.params.absorb = false;
  fit_cells(cloth);
  world.cell_cloths.push_back(std::move(cloth));
  constexpr int layers = 3;
  const int across = static_cast<int>(std::lround(std::sqrt(static_cast<double>(size) / layers)));
  const double wide = 0.12, spacing = wide / across;
  world.liquid.particle_mass = world.liquid.kind.density * spacing * spacing * spacing;
  for (int k = 0; k < layers; ++k)
    for (int j = 0; j < across; ++j)
      for (int i = 0; i < across; ++i)
        add_particle(world.liquid, {(i + 0.5) * spacing - 0.5 * wide, (j + 0.5) * spacing - 0.5 * wide, (k + 0.6) * spacing}, {});
  world.domain.include({-2, -2, -2}), world.domain.include({2, 2, 2});
  StepScratch scratch;
  for (int k = 0; k < 20; ++k) step(world, {.until = 1, .max_step = 2e-4}, scratch);
  return pool;
}

void pool_steps(benchmark::State& state, std::int64_t size) {
  World world = shared_fixture<Pool>(size, [&] { return pool_of(size); }).world;
  StepScratch scratch;
  double liquid = 0, cloth = 0, time = 0;
  for (auto _ : state) {
    const StepReport r = step(world, {.until = 1, .max_step = 2e-4}, scratch);
    liquid += r.liquid_wall_s, cloth += r.cloth_wall_s, time += r.step_s;
  }
  const auto steps = static_cast<double>(state.iterations());
  report(state, {.items = static_cast<double>(size)});
  report_stage(state, "liquid", liquid / steps);
  report_stage(state, "cloth", cloth / steps);
  report_extra(state, "step_us", 1e6 * time / steps);
}

}  // namespace

void add_cloth_benchmarks(const BenchOptions& options) {
  const auto passes = [](std::int64_t) { return 20; };
  add_family(options, "cloth/edge", {10'000, 40'000}, passes,
             [](benchmark::State& state, std::int64_t size) { falls(state, size, true, alone); });
  add_family(options, "cloth/corners", {10'000, 40'000}, passes,
             [](benchmark::State& state, std::int64_t size) { falls(state, size, false, alone); });
  add_family(options, "cloth/corners_short_steps", {40'000}, [](std::int64_t) { return 500; },
             [](benchmark::State& state, std::int64_t size) { falls(state, size, false, with_liquid); });
  add_family(options, "step/pool_on_cloth", {10'000}, passes, pool_steps);
}

}  // namespace imbibe::bench
