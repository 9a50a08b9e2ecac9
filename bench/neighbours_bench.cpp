// Sorting and neighbour lists of a jittered block, as a step does them: sort by cell, permute every array, lists.
#include <chrono>
#include <cmath>

#include "bench.h"
#include "imbibe/core/random.h"
#include "imbibe/liquid/fields.h"

namespace imbibe::bench {
namespace {

struct Block {
  Liquid liquid;
  LiquidFields fields;
  double held = 0;
};

Block block_of(std::int64_t size) {
  const double before = allocated_bytes();
  Block block;
  const auto side = static_cast<Index>(std::ceil(std::cbrt(static_cast<double>(size)) - 1e-9));
  const Real dx = 1e-3;
  block.liquid.particle_mass = block.liquid.kind.density * dx * dx * dx;
  for (Index k = 0; k < static_cast<Index>(size); ++k) {
    const auto jitter = [&](std::uint64_t axis) { return 0.2 * (uniform({.seed = 1, .id = k}, axis) - 0.5); };
    add_particle(block.liquid, dx * Vec3{k % side + jitter(0), k / side % side + jitter(1), k / side / side + jitter(2)},
                 {});
  }
  block.held = allocated_bytes() - before;
  return block;
}

void search(benchmark::State& state, std::int64_t size, Real support) {
  Block& block = shared_fixture<Block>(size, [&] { return block_of(size); });
  const Kernel kernel(support * block.liquid.spacing());
  LiquidFields& f = block.fields;
  double sort = 0;
  const auto pass = [&] {
    const auto start = std::chrono::steady_clock::now();
    sort_particles(f.neighbours, block.liquid.particles, kernel);
    begin_fields(f, block.liquid);
    sort += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    build_lists(f.neighbours, f.position, {});
  };
  pass();
  sort = 0;
  for (auto _ : state) pass();
  double slots = 0;
  for (std::size_t i = 0; i < f.count; i += simd::lanes) slots += static_cast<double>(f.neighbours.slice(i).slots);
  slots *= simd::lanes / static_cast<double>(size);
  const double neighbours = 4.19 * support * support * support;
  // Lists out (id and slope), 27 cells of candidates each some 8 operations.
  report(state, {.items = static_cast<double>(size),
                 .moved_bytes_per_item = 8 * slots + 100,
                 .flops_per_item = 8 * 27 * support * support * support + 9 * slots,
                 .held_bytes_per_item = 0});
  report_stage(state, "sort", sort / static_cast<double>(state.iterations()));
  report_extra(state, "slots", slots);
  report_extra(state, "neighbours", neighbours - 1);
}

}  // namespace

void add_neighbour_benchmarks(const BenchOptions& options) {
  const std::vector<std::int64_t> sizes{8000, 97336, 1'000'000, 10'000'000};
  const auto passes = [](std::int64_t size) { return 2'000'000 / size + 1; };
  add_family(options, "neighbours/search_4r", sizes, passes,
             [](benchmark::State& state, std::int64_t size) { search(state, size, 2); });
  add_family(options, "neighbours/search", sizes, passes,
             [](benchmark::State& state, std::int64_t size) { search(state, size, support_over_spacing); });
}

}  // namespace imbibe::bench
