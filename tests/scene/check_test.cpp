#include "imbibe/scene/check.h"

#include <cstdlib>

#include "scene/scene_test_support.h"

namespace imbibe {
namespace {

namespace fs = std::filesystem;

const Library& library() {
  static const Library read = read_library({IMBIBE_SOURCE_DIR});
  return read;
}

TEST(Check, NumbersOfADropFollowFromTheirDefinitions) {
  Source source;
  source.volume = 50e-9;
  source.velocity = {0, 0, -0.3};
  Liquid water;
  water.kind = {"water", 1000, 1e-3, 0.0728};
  water.particle_mass = 50e-9 * 1000 / 2000;
  const DropNumbers n = drop_numbers(source, water, 9.81);
  const Real radius = std::cbrt(3 * 50e-9 / (4 * pi));
  EXPECT_NEAR(n.radius, radius, 1e-15);
  EXPECT_EQ(n.particles, 2000);
  EXPECT_NEAR(n.bond_number, 1000 * 9.81 * radius * radius / 0.0728, 1e-12);
  EXPECT_NEAR(n.weber_number, 1000 * 0.09 * 2 * radius / 0.0728, 1e-12);
  EXPECT_NEAR(n.capillary_number, 1e-3 * 0.3 / 0.0728, 1e-15);
}

TEST(Check, TheReportNamesWhatAnEngineerAsksFor) {
  const Scene scene = read_scene_text(test::small_scene, "test.yaml");
  const std::string report = check_report(scene, build_world(scene, library()));
  for (const char* word : {"porosity", "Bond number", "step bound", "memory", "particles", "surface tension"})
    EXPECT_NE(report.find(word), std::string::npos) << word << " is not in\n" << report;
}

TEST(Check, TheEstimateCountsWhatIsBuilt) {
  const Scene scene = read_scene_text(test::small_scene, "test.yaml");
  const World world = build_world(scene, library());
  const SceneEstimate e = estimate_scene(scene, world.liquid.kind);
  const YarnNetwork& network = world.textiles[0].fabric->network;
  // An estimate made before anything is woven: right within a tenth.
  EXPECT_NEAR(e.segments, static_cast<double>(network.segments()), 0.1 * static_cast<double>(network.segments()));
  EXPECT_NEAR(e.pores, static_cast<double>(network.pores()), 0.1 * static_cast<double>(network.pores()));
  EXPECT_NEAR(e.particles, static_cast<double>(particle_count(world.sources[0], world.liquid)), 1);
}

TEST(Check, EveryShippedSceneIsGood) {
  int scenes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(IMBIBE_SOURCE_DIR) / "scenes")) {
    if (entry.path().extension() != ".yaml") continue;
    ++scenes;
    try {
      const Scene scene = read_scene(entry.path());
      EXPECT_FALSE(scene.title.empty()) << entry.path();
      const World world = build_world(scene, library());
      EXPECT_FALSE(check_report(scene, world).empty());
      // The resolved scene runs again, and is the same.
      const std::string resolved = write_scene(scene);
      EXPECT_EQ(write_scene(read_scene_text(resolved, "resolved.yaml")), resolved) << entry.path();
    } catch (const InputError& error) {
      ADD_FAILURE() << error.what();
    }
  }
  EXPECT_GE(scenes, 25);
}

TEST(Check, TheScenesOfSeedAHaveItsTables) {
  const fs::path folder = fs::path(IMBIBE_SOURCE_DIR) / "scenes" / "seed_a";
  for (const char* name : {"fig07_wool", "fig07_polyester", "fig07_wool_untreated", "fig08_three_drops", "fig09_cone",
                           "contact_angle_20", "contact_angle_140", "fig07_wool_as_printed"}) {
    const Scene scene = read_scene(folder / (std::string(name) + ".yaml"));
    const World world = build_world(scene, library());
    EXPECT_EQ(world.textiles[0].fabric->network.segments(), 7200u) << name;
    const SceneEstimate e = estimate_scene(scene, world.liquid.kind);
    EXPECT_NEAR(e.particles, 8000, 2) << name;  // volumes are given with four digits
  }
}

TEST(Check, FixedAnglesOfTheSeriesReachTheFibres) {
  for (const int angle : {20, 45, 70, 89, 110, 140}) {
    const Scene scene = read_scene(fs::path(IMBIBE_SOURCE_DIR) / "scenes" / "seed_a" /
                                   ("contact_angle_" + std::to_string(angle) + ".yaml"));
    const World world = build_world(scene, library());
    EXPECT_NEAR(degrees(world.textiles[0].fabric->network.yarn_types[0].fibre.advancing_angle), angle, 1e-9);
  }
}

}  // namespace
}  // namespace imbibe
