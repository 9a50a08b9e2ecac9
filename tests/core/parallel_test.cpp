#include "imbibe/core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

#include "imbibe/core/random.h"

namespace imbibe {
namespace {

Real term(std::size_t i) { return uniform({.seed = 1, .id = i, .step = 0}) * std::pow(10.0, static_cast<Real>(i % 17)); }

Real sum_of_terms(std::size_t count) {
  return parallel_sum(count, [](std::size_t begin, std::size_t end) {
    Real part = 0;
    for (std::size_t i = begin; i < end; ++i) part += term(i);
    return part;
  });
}

TEST(Parallel, EveryItemIsVisitedExactlyOnceAtAnyCountAndTile) {
  for (const std::size_t count : {0u, 1u, 511u, 512u, 513u, 10000u}) {
    for (const std::size_t tile : {std::size_t{1}, std::size_t{7}, default_tile}) {
      std::vector<std::atomic<int>> visits(count);
      parallel_for(count, [&](std::size_t i) { ++visits[i]; }, tile);
      for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(visits[i], 1) << i << " of " << count << " by " << tile;
    }
  }
}

TEST(Parallel, ASumHasTheSameBitsForOneTwoAndThreeThreads) {
  // Terms over 17 decades: another order of adding would show in the last bits.
  Real backwards = 0, forwards = 0;
  for (std::size_t i = 0; i < 100000; ++i) forwards += term(i), backwards += term(99999 - i);
  ASSERT_NE(forwards, backwards);
  std::vector<Real> sums;
  for (const int threads : {1, 2, 3, 0}) {
    const ThreadLimit limit(threads);
    for (int repeat = 0; repeat < 20; ++repeat) sums.push_back(sum_of_terms(100000));
  }
  for (const Real sum : sums) EXPECT_EQ(sum, sums[0]);
  EXPECT_NEAR(sums[0], forwards, 1e-12 * forwards);
}

TEST(Parallel, AMaximumIsThatOfASimpleLoopAndAtLeastTheGivenLowest) {
  Real expected = 0;
  for (std::size_t i = 0; i < 5000; ++i) expected = std::max(expected, term(i));
  const auto part = [](std::size_t begin, std::size_t end) {
    Real most = 0;
    for (std::size_t i = begin; i < end; ++i) most = std::max(most, term(i));
    return most;
  };
  EXPECT_EQ(parallel_max(std::size_t{5000}, Real(0), part), expected);
  EXPECT_EQ(parallel_max(std::size_t{5000}, 1e30, part), 1e30);
  EXPECT_EQ(parallel_max(std::size_t{0}, Real(-3), part), -3);
}

TEST(Parallel, ALimitHoldsWhileItLivesAndNoLonger) {
  const int before = available_threads();
  {
    const ThreadLimit limit(1);
    EXPECT_EQ(available_threads(), 1);
  }
  EXPECT_EQ(available_threads(), before);
}

TEST(Parallel, AnExceptionOfOneItemReachesTheCaller) {
  const auto body = [](std::size_t i) {
    if (i == 7777) throw std::runtime_error("item 7777");
  };
  EXPECT_THROW(parallel_for(std::size_t{10000}, body), std::runtime_error);
}

}  // namespace
}  // namespace imbibe
