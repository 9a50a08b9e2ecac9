// What can be wrong with a scene as a whole, and what a good one becomes.
#include "imbibe/scene/builder.h"

#include "imbibe/scene/placement_checks.h"
#include "scene/scene_test_support.h"

namespace imbibe {
namespace {

using test::expect_one;
using test::small_scene;
using test::with_line;

const Library& library() {
  static const Library read = read_library({IMBIBE_SOURCE_DIR});
  return read;
}

World built(const std::string& text) { return build_world(read_scene_text(text, "test.yaml"), library()); }

std::vector<Problem> problems_of_building(const std::string& text) {
  try {
    built(text);
  } catch (const InputError& error) {
    return error.problems();
  }
  return {};
}

TEST(Builder, AGoodSceneBecomesAWorld) {
  const World world = built(small_scene);
  EXPECT_EQ(world.liquid.kind.name, "water");
  EXPECT_DOUBLE_EQ(world.liquid.particle_mass, 0.205e-6);
  ASSERT_EQ(world.sources.size(), 1u);
  EXPECT_DOUBLE_EQ(world.sources[0].volume, 50e-9);
  ASSERT_EQ(world.textiles.size(), 1u);
  EXPECT_EQ(world.textiles[0].fabric->network.segments(), 2u * 12 * 12);
  EXPECT_EQ(world.textiles[0].contents.liquid_kg.size(), world.textiles[0].fabric->network.nodes());
  EXPECT_EQ(world.solids.size(), 0u);
  EXPECT_TRUE(world.domain.contains({0, 0, 5e-3}));
}

TEST(Builder, TheLedgerStartsWithTheConditionedFibres) {
  const World world = built(small_scene);
  const Textile& cloth = world.textiles[0];
  Real sorbed = 0;
  for (const Real kg : cloth.contents.sorbed_kg) sorbed += kg;
  EXPECT_GT(sorbed, 0);
  EXPECT_NEAR(world.ledger.initial_kg, sorbed, 1e-12 * sorbed);
  EXPECT_LE(mass_balance(world).error(), 1e-12);
}

TEST(Builder, AnUnknownLiquidSuggestsTheNearest) {
  expect_one(problems_of_building(with_line(6, "  kind: watr")), 6, 9, "liquid.kind.name", "did you mean 'water'?");
}

TEST(Builder, ALiquidOfItsOwnNeedsAllThreeProperties) {
  const World world = built(
      with_line(6, "  kind: {name: mine, density: 900 kg/m3, viscosity: 5 mPa s, surface_tension: 20 mN/m}"));
  EXPECT_EQ(world.liquid.kind.density, 900);
  expect_one(problems_of_building(with_line(6, "  kind: {name: mine, density: 900 kg/m3}")), 6, 16, "liquid.kind.name",
             "there is no liquid 'mine'");
  EXPECT_EQ(built(with_line(6, "  kind: {name: water, viscosity: 5 mPa s}")).liquid.kind.viscosity, 5e-3);
}

TEST(Builder, AnUnknownFibreSuggestsTheNearest) {
  const auto problems =
      problems_of_building(with_line(14, "    warp: {fibre: coton, diameter: 0.4 mm, density: 10 /cm}"));
  expect_one(problems, 14, 19, "textiles[0].warp.fibre", "cotton");
}

TEST(Builder, ADropInsideTheTextileIsRefusedWithItsDepth) {
  // 50 uL: radius 2.285 mm; the sheet reaches up to 0.4 mm.
  expect_one(problems_of_building(with_line(9, "    - {centre: [0, 0, 2 mm], volume: 50 uL}")), 9, 16,
             "liquid.drops[0].centre", "into textile 'swatch'");
  EXPECT_TRUE(problems_of_building(with_line(9, "    - {centre: [0, 0, 2.69 mm], volume: 50 uL}")).empty())
      << "a drop may lie on the cloth";
}

TEST(Builder, ADropInsideASolidIsRefused) {
  expect_one(problems_of_building(std::string(small_scene) +
                                  "solids:\n  - {name: ball, shape: {kind: sphere, centre: [0, 0, 6 mm], radius: 1 mm}}\n"),
             9, 16, "liquid.drops[0].centre", "into solid 'ball'");
}

TEST(Builder, OverlappingDropsAreRefusedUnlessOneComesLater) {
  const std::string two =
      "    - {centre: [0, 0, 5 mm], volume: 50 uL}\n    - {centre: [3 mm, 0, 5 mm], volume: 50 uL";
  expect_one(problems_of_building(with_line(9, two + "}")), 10, 16, "liquid.drops[1].centre",
             "'drop 2' overlaps 'drop 1'");
  EXPECT_TRUE(problems_of_building(with_line(9, two + ", start: 1 s}")).empty());
}

TEST(Builder, ABoxOfLiquidInsideTheTextileIsRefused) {
  expect_one(problems_of_building(with_line(8, "  boxes:\n    - {centre: [0, 0, 1 mm], size: [4 mm, 4 mm, 2 mm]}\n  drops:")),
             9, 16, "liquid.boxes[0].centre", "into textile 'swatch'");
}

TEST(Builder, ADropOutsideTheDomainIsRefused) {
  expect_one(problems_of_building(std::string(small_scene) + "domain: {upper: [10 mm, 10 mm, 6 mm]}\n"), 9, 16,
             "liquid.drops[0].centre", "not wholly inside the domain");
}

TEST(Builder, ADropSmallerThanAParticleIsRefused) {
  expect_one(problems_of_building(with_line(9, "    - {centre: [0, 0, 5 mm], volume: 0.1 uL}")), 9, 38,
             "liquid.drops[0].volume", "less than one particle");
}

TEST(Builder, TooManyParticlesAreRefusedBeforeTheyAreMade) {
  const auto problems = problems_of_building(with_line(7, "  particle_mass: 1e-15 kg"));
  ASSERT_FALSE(problems.empty());
  EXPECT_EQ(problems[0].key, "liquid.particle_mass");
  EXPECT_EQ(problems[0].line, 7);
  EXPECT_NE(problems[0].message.find("particles"), std::string::npos);
}

TEST(Builder, AClothBeyondTheMemoryIsRefusedBeforeItIsMade) {
  const auto problems = problems_of_building(with_line(12, "    size: [90 m, 90 m]"));
  ASSERT_EQ(problems.size(), 2u);  // the memory, and the room on disk
  EXPECT_EQ(problems[0].key, "textiles");
  EXPECT_NE(problems[0].message.find("of memory, more than"), std::string::npos);
}

TEST(Builder, MoreMemoryThanTheSceneAllowsIsRefused) {
  const auto problems = problems_of_building(std::string(small_scene) + "limits: {max_memory: 0.01 GB}\n");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_NE(problems[0].message.find("limits.max_memory"), std::string::npos) << problems[0].message;
}

TEST(Builder, ARunFolderLargerThanTheLimitIsRefused) {
  const auto problems =
      problems_of_building(std::string(small_scene) + "limits: {max_disk: 0.01 GB}\noutput: {every: 1 ms}\n");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].key, "output.every");
}

TEST(Builder, ATextilesContactAngleReplacesThatOfItsFibres) {
  const World world = built(with_line(16, "    contact_angle: 20 deg"));
  for (const YarnType& type : world.textiles[0].fabric->network.yarn_types) {
    EXPECT_DOUBLE_EQ(type.fibre.advancing_angle, radians(20));
    EXPECT_LE(type.fibre.receding_angle, type.fibre.advancing_angle);
  }
}

TEST(Builder, ATurnedSheetHasItsFaceWhereWeftCrossWarpPoints) {
  const World world = built(with_line(16, "    centre: [0, 0, -5 mm]\n    weft_direction: [0, 2, 0]\n    warp_direction: [-3, 0, 0]"));
  const Placement& p = world.textiles[0].placement;
  EXPECT_EQ(p.n, Vec3(0, 0, 1));
  const Bounds b = bounds_of_sheet(world.textiles[0]);
  EXPECT_NEAR(b.centre().z, -5e-3, 1e-15);
  // Half thickness 0.4 mm: a point 1 mm above the mid-plane is 0.6 mm away.
  EXPECT_NEAR(distance_to_sheet(world.textiles[0], {0, 0, -4e-3}), 0.6e-3, 1e-12);
}

TEST(Builder, ProblemsOfClothAndSolidsComeTogether) {
  const auto problems = problems_of_building(
      with_line(14, "    warp: {fibre: coton, diameter: 0.4 mm, density: 10 /cm}") +
      "solids:\n  - {name: m, shape: {kind: mesh, file: nowhere.obj}}\n");
  EXPECT_EQ(problems.size(), 2u);
}

TEST(Builder, AMeshWithAHoleIsRefused) {
  test::TemporaryFolder folder;
  folder.write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\n");
  const auto file = folder.write("scene.yaml", std::string(small_scene) +
                                                   "solids:\n  - {name: m, shape: {kind: mesh, file: open.obj}}\n");
  try {
    build_world(read_scene(file), library());
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("open.obj"), std::string::npos) << error.what();
  }
}

TEST(Builder, AMeshWithABadIndexIsRefusedWithItsLine) {
  test::TemporaryFolder folder;
  folder.write("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
  const auto file = folder.write("scene.yaml", std::string(small_scene) +
                                                   "solids:\n  - {name: m, shape: {kind: mesh, file: bad.obj}}\n");
  try {
    build_world(read_scene(file), library());
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.problems()[0].line, 4) << error.what();
  }
}

TEST(Builder, BuildingTwiceGivesTheSameWorld) {
  const World a = built(small_scene), b = built(small_scene);
  EXPECT_EQ(a.textiles[0].contents.sorbed_kg, b.textiles[0].contents.sorbed_kg);
  EXPECT_EQ(a.ledger.initial_kg, b.ledger.initial_kg);
}

// Weaves and drafts: the fabric's own problems arrive with the scene's place.
TEST(Builder, AnEmptyWeaveIsRefused) {
  const auto problems = problems_of_building(with_line(13, "    weave: ''"));
  ASSERT_FALSE(problems.empty());
  EXPECT_EQ(problems[0].line, 13);
  EXPECT_EQ(problems[0].key, "textiles[0].weave");
}

TEST(Builder, RaggedWeaveRowsAreRefused) {
  const auto problems = problems_of_building(with_line(13, "    weave_rows: ['101', '01']"));
  ASSERT_FALSE(problems.empty());
  EXPECT_EQ(problems[0].line, 13);
  EXPECT_EQ(problems[0].key.rfind("textiles[0].weave", 0), 0u) << problems[0].text();
}

TEST(Builder, AMalformedDraftIsReportedInItsOwnFile) {
  test::TemporaryFolder folder;
  folder.write("bad.wif", "[WIF]\nVersion=1.1\n[WEAVING]\nShafts=many\n");
  std::string text = small_scene;
  text.replace(text.find("weave: plain"), 12, "weave: bad.wif");
  const auto file = folder.write("scene.yaml", text);
  try {
    build_world(read_scene(file), library());
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("bad.wif"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace imbibe
