// Counter-based random numbers: a pure function of (seed, id, step, stream), so results do not depend on threads or
// on the order of calls. Mixing: SplitMix64 finaliser (Steele, Lea & Flood, OOPSLA 2014), applied per counter word.
#pragma once

#include "imbibe/core/types.h"

namespace imbibe {

struct RandomCounter {
  std::uint64_t seed = 0;
  std::uint64_t id = 0;
  std::uint64_t step = 0;
};

constexpr std::uint64_t mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

constexpr std::uint64_t random_bits(const RandomCounter& c, std::uint64_t stream = 0) {
  return mixed(mixed(mixed(mixed(c.seed) ^ c.id) ^ c.step) ^ stream);
}

// Uniform in [0, 1).
constexpr Real uniform(const RandomCounter& c, std::uint64_t stream = 0) {
  return static_cast<Real>(random_bits(c, stream) >> 11) * 0x1.0p-53;
}

}  // namespace imbibe
