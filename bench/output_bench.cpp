// One output of the run folder: .vtp files, checkpoint, state hash.
#include <unistd.h>

#include <filesystem>

#include "bench.h"
#include "imbibe/io/run_folder.h"
#include "imbibe/sim/checkpoint.h"
#include "imbibe/sim/state_hash.h"
#include "textile_world.h"

namespace imbibe::bench {
namespace {

struct Output {
  World world;
  std::filesystem::path folder;
  explicit Output(std::int64_t size) : world(cloth_world(size)) {
    folder = std::filesystem::temp_directory_path() / ("imbibe_bench_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder);
    for (Index k = 0; k < static_cast<Index>(size); ++k) {
      add_particle(world.liquid, 1e-3 * Vec3{k % 100 + 0.0, k / 100 % 100 + 0.0, k / 10000 + 1.0}, {});
    }
  }
  Output(Output&& other) noexcept : world(std::move(other.world)), folder(std::move(other.folder)) {
    other.folder.clear();
  }
  ~Output() {
    std::error_code none;
    if (!folder.empty()) std::filesystem::remove_all(folder, none);
  }
};

Output& output_of(std::int64_t size) {
  return shared_fixture<Output>(size, [&] { return Output(size); });
}

}  // namespace

void add_output_benchmarks(const BenchOptions& options) {
  const std::vector<std::int64_t> sizes{10'000, 100'000, 1'000'000};
  const auto passes = [](std::int64_t size) { return 100'000 / size + 1; };
  add_family(options, "output/liquid_vtp", sizes, passes, [](benchmark::State& state, std::int64_t size) {
    Output& o = output_of(size);
    for (auto _ : state) write_vtp(o.folder / "liquid.vtp", liquid_poly_data(o.world.liquid), {});
    report(state, {.items = static_cast<double>(size)});
  });
  add_family(options, "output/textile_vtp", sizes, passes, [](benchmark::State& state, std::int64_t size) {
    Output& o = output_of(size);
    const Textile& textile = o.world.textiles[0];
    for (auto _ : state) {
      const std::vector<Real> saturations = node_saturations(textile, o.world.air);
      write_vtp(o.folder / "textile.vtp", textile_poly_data(textile, saturations), {});
      write_vtp(o.folder / "pores.vtp", pore_poly_data(textile, saturations), {});
    }
    report(state, {.items = static_cast<double>(textile.model->nodes())});
  });
  add_family(options, "output/checkpoint", sizes, passes, [](benchmark::State& state, std::int64_t size) {
    Output& o = output_of(size);
    for (auto _ : state) write_checkpoint(o.folder / "checkpoint_1.h5", o.world);
    report(state, {.items = static_cast<double>(size)});
  });
  add_family(options, "output/state_hash", sizes, passes, [](benchmark::State& state, std::int64_t size) {
    Output& o = output_of(size);
    for (auto _ : state) benchmark::DoNotOptimize(state_hash(o.world));
    report(state, {.items = static_cast<double>(size)});
  });
}

}  // namespace imbibe::bench
