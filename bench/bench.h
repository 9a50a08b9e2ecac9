// Benchmarks of `imbibe bench`: each family of one kernel or scene is registered for sizes and threads; a benchmark
// says what one pass handles (Work), and bench/table.h makes the figures of it.
//
// How time is taken: each benchmark runs `--repeat` times (3), the least time counts. Wall time and processor time of
// all threads are both kept: on a busy machine only the second says something.
#pragma once

#include <benchmark/benchmark.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace imbibe::bench {

struct BenchOptions {
  double largest = 1e6;  // greatest size
  double least = 0;
  std::vector<int> threads{1, 2};
  int repeat = 3;
};

// What one pass of a benchmark does. Flops and bytes are counted from the code, once, per item:
// additions, multiplications, square roots and divisions of the inner loop alike; bytes as they must come from memory
// when nothing but the list and the own records misses the cache (each array once per pass, neighbours cached).
struct Work {
  double items = 0;
  double moved_bytes_per_item = 0;  // 0: not counted
  double flops_per_item = 0;        // 0: not counted
  double held_bytes_per_item = 0;   // memory kept, measured from the allocator; 0: not measured
};

void report(benchmark::State& state, const Work& work);

// A stage of the pass: seconds of wall time per pass. Becomes a row of its own, name + ":" + stage.
void report_stage(benchmark::State& state, const std::string& stage, double seconds);

// Anything else worth a look, e.g. iterations per step; goes into the last column.
void report_extra(benchmark::State& state, const std::string& name, double value);

// Registers `run` as name/size/threads:n for each size within the options and each number of threads.
// passes(size): how many passes one repetition makes.
void add_family(const BenchOptions& options, const std::string& name, const std::vector<std::int64_t>& sizes,
                std::function<std::int64_t(std::int64_t size)> passes,
                std::function<void(benchmark::State&, std::int64_t size)> run);

// Bytes that the program has allocated and not freed.
double allocated_bytes();

// The last fixture built by `make`, kept while name and size stay the same: repetitions and thread counts share it.
template <class Fixture, class Make>
Fixture& shared_fixture(std::int64_t size, Make&& make) {
  static std::unique_ptr<Fixture> kept;
  static std::int64_t kept_size = -1;
  if (!kept || kept_size != size) {
    kept.reset();
    kept = std::make_unique<Fixture>(make());
    kept_size = size;
  }
  return *kept;
}

void add_neighbour_benchmarks(const BenchOptions& options);
void add_liquid_benchmarks(const BenchOptions& options);
void add_network_benchmarks(const BenchOptions& options);
void add_contact_benchmarks(const BenchOptions& options);
void add_cloth_benchmarks(const BenchOptions& options);
void add_output_benchmarks(const BenchOptions& options);
void add_scene_benchmarks(const BenchOptions& options);

}  // namespace imbibe::bench
