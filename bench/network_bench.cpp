// The textile's network: building the fabric and its wetting model, one implicit step of 1 s, and its stages.
#include <chrono>

#include "bench.h"
#include "imbibe/wetting/fibre_exchange.h"
#include "imbibe/wetting/wetting_step.h"
#include "textile_world.h"

namespace imbibe::bench {
namespace {

struct Cloth {
  World world;
  WettingScratch scratch;
  Contents start;
  double held = 0;
};

Cloth wet_cloth(std::int64_t nodes) {
  const double before = allocated_bytes();
  Cloth cloth{cloth_world(nodes), {}, {}, 0};
  Textile& textile = cloth.world.textiles[0];
  wet(textile);
  cloth.start = textile.contents;
  Contents contents = cloth.start;
  step_wetting(*textile.model, contents, {}, {}, cloth.world.air, {0, 0, -9.81}, 1e-3, cloth.scratch);
  cloth.held = (allocated_bytes() - before) / static_cast<double>(textile.model->nodes());
  return cloth;
}

Cloth& cloth_of(std::int64_t nodes) {
  return shared_fixture<Cloth>(nodes, [&] { return wet_cloth(nodes); });
}

double nodes_of(const Cloth& cloth) { return static_cast<double>(cloth.world.textiles[0].model->nodes()); }

void build(benchmark::State& state, std::int64_t size) {
  double nodes = 0, held = 0;
  for (auto _ : state) {
    const double before = allocated_bytes();
    const World world = cloth_world(size);
    nodes = static_cast<double>(world.textiles[0].model->nodes());
    held = (allocated_bytes() - before) / nodes;
  }
  report(state, {.items = nodes, .held_bytes_per_item = held});
}

void implicit_second(benchmark::State& state, std::int64_t size) {
  Cloth& cloth = cloth_of(size);
  Textile& textile = cloth.world.textiles[0];
  double newton = 0, linear = 0, substeps = 0, active = 0;
  for (auto _ : state) {
    Contents contents = cloth.start;
    const WettingReport r =
        step_wetting(*textile.model, contents, {}, {}, cloth.world.air, {0, 0, -9.81}, 1, cloth.scratch);
    newton = r.newton_iterations, linear = r.linear_iterations, substeps = r.substeps + r.rejected;
    active = static_cast<double>(r.active_nodes);
  }
  report(state, {.items = nodes_of(cloth), .held_bytes_per_item = cloth.held});
  report_extra(state, "newton", newton);
  report_extra(state, "linear", linear);
  report_extra(state, "substeps", substeps);
  report_extra(state, "solved_share", active / nodes_of(cloth));
}

void sorption(benchmark::State& state, std::int64_t size) {
  Cloth& cloth = cloth_of(size);
  const Textile& textile = cloth.world.textiles[0];
  Contents contents = cloth.start;
  for (auto _ : state) sorb_liquid(*textile.model, contents, 1e-3);
  report(state, {.items = nodes_of(cloth)});
}

void vapour(benchmark::State& state, std::int64_t size) {
  Cloth& cloth = cloth_of(size);
  const Textile& textile = cloth.world.textiles[0];
  Contents contents = cloth.start;
  for (auto _ : state) benchmark::DoNotOptimize(exchange_vapour(*textile.model, contents, cloth.world.air, 1e-3));
  report(state, {.items = nodes_of(cloth)});
}

}  // namespace

void add_network_benchmarks(const BenchOptions& options) {
  const std::vector<std::int64_t> sizes{10'000, 100'000, 1'000'000, 10'000'000};
  const auto once = [](std::int64_t) { return 1; };
  add_family(options, "network/build", sizes, once, build);
  add_family(options, "network/step_1s", sizes, once, implicit_second);
  const auto passes = [](std::int64_t size) { return 3'000'000 / size + 1; };
  add_family(options, "network/sorption", sizes, passes, sorption);
  add_family(options, "network/vapour", sizes, passes, vapour);
}

}  // namespace imbibe::bench
