// The same scene gives the same bits: twice, for any number of threads, and from a copy in the middle.
#include <gtest/gtest.h>

#include "imbibe/core/parallel.h"
#include "imbibe/sim/state_hash.h"
#include "support/scene_runs.h"

namespace imbibe {
namespace {

std::uint64_t hash_with(int threads) {
  const ThreadLimit limit(threads);
  World world = test::build_small_drop();
  test::run_until(world, 0.02);
  return state_hash(world);
}

TEST(SameBits, ForOneTwoThreeAndEightThreads) {
  const std::uint64_t one = hash_with(1);
  EXPECT_EQ(hash_with(2), one);
  EXPECT_EQ(hash_with(3), one);
  EXPECT_EQ(hash_with(8), one);
}

TEST(SameBits, FromACopyOfTheWorldWithFreshWorkSpace) {
  World whole = test::build_small_drop();
  test::run_until(whole, 0.01);
  World copy = whole;
  StepOptions options;
  options.until = 1;
  StepScratch scratch;
  for (int i = 0; i < 40; ++i) {
    step(whole, options, scratch);
    StepScratch fresh;  // the copy finds no help from earlier steps
    step(copy, options, fresh);
    ASSERT_EQ(state_hash(whole), state_hash(copy)) << "step " << i;
  }
}

}  // namespace
}  // namespace imbibe
