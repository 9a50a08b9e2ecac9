#include "imbibe/core/random.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <set>
#include <vector>

namespace imbibe {
namespace {

TEST(Random, ANumberDependsOnItsCounterAloneNotOnTheOrderOfCalls) {
  std::vector<Real> forwards, backwards;
  for (std::uint64_t i = 0; i < 100; ++i) forwards.push_back(uniform({.seed = 3, .id = i, .step = 9}, 2));
  for (std::uint64_t i = 100; i-- > 0;) backwards.push_back(uniform({.seed = 3, .id = i, .step = 9}, 2));
  for (std::size_t i = 0; i < 100; ++i) EXPECT_EQ(forwards[i], backwards[99 - i]);
}

TEST(Random, NumbersFillTheUnitIntervalEvenly) {
  constexpr int bins = 100, samples = 100000;
  std::array<int, bins> counts{};
  for (std::uint64_t i = 0; i < samples; ++i) {
    const Real u = uniform({.seed = 1, .id = i, .step = 0});
    ASSERT_GE(u, 0);
    ASSERT_LT(u, 1);
    ++counts[static_cast<std::size_t>(u * bins)];
  }
  Real chi_squared = 0;
  const Real expected = static_cast<Real>(samples) / bins;
  for (const int count : counts) chi_squared += (count - expected) * (count - expected) / expected;
  // 99 degrees of freedom: 149 is passed by chance once in 1000 sequences, and this one is fixed. Below 62 is as rare.
  EXPECT_LT(chi_squared, 149);
  EXPECT_GT(chi_squared, 62);
}

// Correlation of u(counter) with u(next counter); standard error 1/sqrt(samples) = 0.0045; bound: four of them.
Real correlation(RandomCounter a, RandomCounter b, std::uint64_t stream_a, std::uint64_t stream_b) {
  constexpr std::uint64_t samples = 50000;
  Real sum = 0;
  for (std::uint64_t i = 0; i < samples; ++i) {
    a.step = i, b.step = i;
    sum += (uniform(a, stream_a) - 0.5) * (uniform(b, stream_b) - 0.5) * 12;
  }
  return sum / samples;
}

TEST(Random, NeighbouringSeedsIdsAndStreamsAreIndependent) {
  const RandomCounter base{.seed = 5, .id = 6, .step = 0};
  EXPECT_LT(std::abs(correlation(base, {.seed = 6, .id = 6, .step = 0}, 0, 0)), 0.018);
  EXPECT_LT(std::abs(correlation(base, {.seed = 5, .id = 7, .step = 0}, 0, 0)), 0.018);
  EXPECT_LT(std::abs(correlation(base, base, 0, 1)), 0.018);
}

TEST(Random, SwappingSeedAndIdGivesOtherNumbers) {
  EXPECT_NE(random_bits({.seed = 1, .id = 2, .step = 3}), random_bits({.seed = 2, .id = 1, .step = 3}));
  EXPECT_NE(random_bits({.seed = 1, .id = 2, .step = 3}), random_bits({.seed = 1, .id = 3, .step = 2}));
}

TEST(Random, EachBitOfTheCounterChangesHalfOfTheResult) {
  Real flipped = 0;
  constexpr int tries = 64 * 50;
  for (std::uint64_t id = 0; id < 50; ++id) {
    for (int bit = 0; bit < 64; ++bit) {
      const auto a = random_bits({.seed = 1, .id = id, .step = 0});
      const auto b = random_bits({.seed = 1, .id = id ^ (std::uint64_t{1} << bit), .step = 0});
      flipped += std::popcount(a ^ b);
    }
  }
  // 32 of 64 bits, standard error 4 / sqrt(3200) = 0.07; bound: four of them.
  EXPECT_NEAR(flipped / tries, 32, 0.28);
}

}  // namespace
}  // namespace imbibe
