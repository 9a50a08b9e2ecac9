#include "machine_limits.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <vector>

#include "imbibe/core/parallel.h"
#include "imbibe/liquid/simd.h"

namespace imbibe::bench {
namespace {

constexpr int tries = 7;

template <class Work>
double least_seconds(Work&& work) {
  double least = 1e30;
  for (int k = 0; k < tries; ++k) {
    const auto start = std::chrono::steady_clock::now();
    work();
    least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return least;
}

double triad_bandwidth() {
  constexpr std::size_t n = 24'000'000;  // 3 x 96 MB
  std::vector<float> a(n, 0.0f), b(n, 1.0f), c(n, 2.0f);
  const double seconds = least_seconds([&] {
    parallel_tiles(n, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) a[i] = b[i] + 3.0f * c[i];
    }, 65536);
    benchmark::ClobberMemory();
  });
  return 12.0 * n / seconds;
}

// Enough independent chains to hide the latency of both operations.
double arithmetic_peak(int threads) {
  constexpr int chains = 10, rounds = 400'000;
  const auto blocks = static_cast<std::size_t>(threads);
  const double seconds = least_seconds([&] {
    parallel_for(blocks, [&](std::size_t) {
      std::array<simd::Floats, chains> x;
      for (int k = 0; k < chains; ++k) x[static_cast<std::size_t>(k)] = simd::broadcast(0.1f * static_cast<float>(k));
      const simd::Floats factor = simd::broadcast(0.9999f), added = simd::broadcast(1e-4f);
      for (int r = 0; r < rounds; ++r) {
#pragma GCC unroll 10
        for (std::size_t k = 0; k < chains; ++k) x[k] = x[k] * factor + added;
      }
      simd::Floats sum{};
      for (const simd::Floats& v : x) sum += v;
      benchmark::DoNotOptimize(sum);
    }, 1);
  });
  return 2.0 * simd::lanes * chains * rounds * threads / seconds;
}

}  // namespace

MachineLimits measure_limits(int threads) {
  const ThreadLimit limit(threads);
  return {triad_bandwidth(), arithmetic_peak(threads)};
}

}  // namespace imbibe::bench
