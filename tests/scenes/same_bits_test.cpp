// The same scene gives the same bits: twice, for any number of threads, and from a copy in the middle.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "imbibe/core/parallel.h"
#include "imbibe/sim/checkpoint.h"
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

// Every shipped scene with a 64th of its particles, over its first milliseconds: by 1, 2, 3 and 8 threads, and through a
// checkpoint half-way.
class SameBitsOf : public testing::TestWithParam<std::string> {};

TEST_P(SameBitsOf, AShippedSceneForAnyNumberOfThreadsAndThroughACheckpoint) {
  const auto file = test::scenes_folder() / GetParam();
  Scene scene = read_scene(file);
  if (scene.liquid.particle_mass) *scene.liquid.particle_mass *= 64;
  for (PipeSpec& pipe : scene.liquid.pipes)
    if (pipe.particle_rate) *pipe.particle_rate /= 64;  // the same flow
  const Real end = std::min(scene.duration, 0.012);
  // Steps land on multiples of `every`, so a stop at one of them is a stop between two steps of the unbroken run.
  const auto run_to = [&](World& world, Real until) {
    run(world, {.until = until, .every = end / 4, .max_steps = 0, .step = {}}, {});
  };
  std::uint64_t whole = 0;
  for (const int threads : {1, 2, 3, 8}) {
    const ThreadLimit limit(threads);
    World world = test::build(scene, file);
    run_to(world, end);
    if (threads == 1) whole = state_hash(world);
    EXPECT_EQ(state_hash(world), whole) << threads << " threads";
  }
  World before = test::build(scene, file), after = test::build(scene, file);
  run_to(before, end / 2);
  const auto checkpoint = std::filesystem::path(testing::TempDir()) / ("same_bits_" + std::to_string(::getpid()) + ".h5");
  write_checkpoint(checkpoint, before);
  read_checkpoint(checkpoint, after);
  std::filesystem::remove(checkpoint);
  run_to(after, end);
  EXPECT_EQ(state_hash(after), whole) << "through a checkpoint";
}

std::string test_name(const testing::TestParamInfo<std::string>& scene) {
  std::string name = scene.param;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, SameBitsOf, testing::ValuesIn(test::shipped_scenes()), test_name);

}  // namespace
}  // namespace imbibe
