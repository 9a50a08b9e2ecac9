#include "bench.h"

#include <malloc.h>

#include "imbibe/core/parallel.h"

namespace imbibe::bench {

void report(benchmark::State& state, const Work& work) {
  state.counters["items"] = work.items;
  state.counters["moved"] = work.moved_bytes_per_item;
  state.counters["flops"] = work.flops_per_item;
  state.counters["held"] = work.held_bytes_per_item;
}

void report_stage(benchmark::State& state, const std::string& stage, double seconds) {
  state.counters["stage " + stage] = seconds;
}

void report_extra(benchmark::State& state, const std::string& name, double value) {
  state.counters["extra " + name] = value;
}

void add_family(const BenchOptions& options, const std::string& name, const std::vector<std::int64_t>& sizes,
                std::function<std::int64_t(std::int64_t)> passes,
                std::function<void(benchmark::State&, std::int64_t)> run) {
  for (const std::int64_t size : sizes) {
    if (static_cast<double>(size) > options.largest || static_cast<double>(size) < options.least) continue;
    for (const int threads : options.threads) {
      const std::string full = name + "/" + std::to_string(size) + "/threads:" + std::to_string(threads);
      benchmark::RegisterBenchmark(full.c_str(), [=](benchmark::State& state) {
        const ThreadLimit limit(threads);
        run(state, size);
      })->Iterations(std::max<std::int64_t>(1, passes(size)))
          ->Repetitions(options.repeat)
          ->MeasureProcessCPUTime()
          ->UseRealTime();
    }
  }
}

double allocated_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
}

}  // namespace imbibe::bench
