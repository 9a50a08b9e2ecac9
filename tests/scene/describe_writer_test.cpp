#include "imbibe/scene/describe_writer.h"

#include "imbibe/scene/describe_reader.h"
#include "scene/described_samples.h"
#include "scene/scene_test_support.h"

namespace imbibe {
namespace {

using test::bit_listing;

TEST(DescribeWriter, RandomScenesReadBackToTheSameBits) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Scene scene;
    test::RandomFiller filler(seed);
    describe(filler, scene);
    const std::string text = write_scene(scene);
    ReadLog log;
    const DataNode root = parse_document(text, "written", log.problems);
    Scene back;
    read_described(root, "", back, log);
    for (const Problem& p : log.problems) ADD_FAILURE() << p.text();
    ASSERT_TRUE(log.problems.empty()) << "seed " << seed << "\n" << text;
    // An unset text and an empty list are written as nothing, which is what they are.
    ASSERT_EQ(bit_listing(back), bit_listing(scene)) << "seed " << seed << "\n" << text;
    ASSERT_EQ(write_scene(back), text);
  }
}

TEST(DescribeWriter, AReadSceneIsWrittenInTheUnitsPeopleUse) {
  const Scene scene = read_scene_text(test::small_scene, "test.yaml");
  const std::string text = write_scene(scene);
  for (const char* line : {"temperature: 20 degC", "humidity: 65 %", "particle_mass: 0.205 mg", "volume: 50 uL",
                           "centre: [0 mm, 0 mm, 5 mm]", "density: 10 1/cm", "diameter: 0.4 mm"})
    EXPECT_NE(text.find(line), std::string::npos) << line << " is not in\n" << text;
}

TEST(DescribeWriter, WhatWasSetNowhereIsLeftOut) {
  const std::string text = write_scene(read_scene_text(test::small_scene, "test.yaml"));
  EXPECT_EQ(text.find("receding_angle"), std::string::npos);
  EXPECT_EQ(text.find("stripes"), std::string::npos);
}

}  // namespace
}  // namespace imbibe
