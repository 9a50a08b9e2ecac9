// Sample points of one pixel: the (0,2)-sequence (van der Corput and Sobol), scrambled per pixel and purpose by a
// counter-based hash. Well spread for every power of two of samples, a pure function of its arguments.
#pragma once

#include <cstdint>

#include "imbibe/core/random.h"

namespace imbibe {

struct Pair {
  float u = 0, v = 0;  // [0, 1)
};

class PixelSamples {
 public:
  PixelSamples(std::uint64_t pixel, std::uint32_t sample) : pixel_(pixel), sample_(sample) {}

  Pair pair(std::uint64_t purpose) const {
    const std::uint64_t scramble = random_bits({0x1b1be, pixel_, purpose});
    // Shuffles the order within every aligned group of 16, so that two purposes of one sample are not in step.
    const std::uint32_t i = sample_ ^ (static_cast<std::uint32_t>(mixed(scramble)) & 15u);
    return {unit(reversed(i) ^ static_cast<std::uint32_t>(scramble)),
            unit(sobol(i) ^ static_cast<std::uint32_t>(scramble >> 32))};
  }

 private:
  static float unit(std::uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1.0p-24f; }
  static std::uint32_t reversed(std::uint32_t x) {
    x = (x << 16) | (x >> 16);
    x = ((x & 0x00ff00ffu) << 8) | ((x & 0xff00ff00u) >> 8);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x & 0xf0f0f0f0u) >> 4);
    x = ((x & 0x33333333u) << 2) | ((x & 0xccccccccu) >> 2);
    return ((x & 0x55555555u) << 1) | ((x & 0xaaaaaaaau) >> 1);
  }
  static std::uint32_t sobol(std::uint32_t i) {
    std::uint32_t result = 0;
    for (std::uint32_t column = 1u << 31; i; i >>= 1, column ^= column >> 1)
      if (i & 1) result ^= column;
    return result;
  }

  std::uint64_t pixel_;
  std::uint32_t sample_;
};

}  // namespace imbibe
