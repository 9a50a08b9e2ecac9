// Soft sheets, cells and pipes in scenes: what a good one becomes, and what is said of a bad one.
#include "imbibe/scene/cloth_builder.h"

#include <fmt/format.h>
#include <unistd.h>

#include "imbibe/scene/builder.h"
#include "scene/scene_test_support.h"

namespace imbibe {
namespace {

const Library& library() {
  static const Library read = read_library({IMBIBE_SOURCE_DIR});
  return read;
}

const char* const cloth_scene =
    "version: 1\n"
    "duration: 1 s\n"
    "liquid:\n"
    "  particle_mass: 30 mg\n"
    "  pipes:\n"
    "    - {radius: 20 mm, length: 60 mm, transform: {translation: [0, 0, 100 mm], rotation: [180 deg, 0 deg, 0 deg]},\n"
    "       particle_rate: 300, speed: 1 m/s}\n"
    "textiles:\n"
    "  - name: cloth\n"
    "    size: [400 mm, 200 mm]\n"
    "    areal_mass: 150 g/m2\n"
    "    sheet: {soft: {columns: 21, rows: 11, preset: silk, cloth: {hand: {shear: 60 N/m}}, pins: [{corner: top_left}, {edge: right}]}}\n"
    "    wetting: {cells: {capacity_ratio: 3}}\n";

std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

World built(const std::string& text) { return build_world(read_scene_text(text, "test.yaml"), library()); }

// The messages of all problems, "key: message" each.
std::string problems(const std::string& text) {
  try {
    built(text);
  } catch (const InputError& error) {
    std::string all;
    for (const Problem& p : error.problems()) all += p.key + ": " + p.message + "\n";
    return all;
  }
  return "none";
}

void expect_refused(const std::string& from, const std::string& to, const std::string& key, const std::string& message) {
  const std::string said = problems(with(cloth_scene, from, to));
  EXPECT_NE(said.find(key), std::string::npos) << said;
  EXPECT_NE(said.find(message), std::string::npos) << said;
}

TEST(ClothScene, AGoodSceneBecomesAClothOfCellsAndAPipe) {
  const World world = built(cloth_scene);
  ASSERT_EQ(world.cell_cloths.size(), 1u);
  const CellCloth& cloth = world.cell_cloths[0];
  EXPECT_EQ(cloth.soft.sheet.size(), 21u * 11u);
  EXPECT_EQ(cloth.soft.sheet.pins.size(), 12u);
  EXPECT_NEAR(total_mass(cloth.soft.sheet), 0.4 * 0.2 * 0.15, 1e-12);
  EXPECT_NEAR(cloth.grid->capacity_per_area, 0.45, 1e-12);
  EXPECT_FALSE(cloth.soft.sheet.fixed);
  ASSERT_EQ(world.sources.size(), 1u);
  EXPECT_NEAR(world.sources[0].velocity.z, -1, 1e-12);  // aimed down by the transform
  EXPECT_NEAR(world.sources[0].centre.z, 0.1, 1e-12);
  EXPECT_EQ(world.props.size(), 1u);
}

TEST(ClothScene, APresetGivesTheHandAndSingleValuesReplaceIt) {
  const World world = built(cloth_scene);
  const FabricHand& hand = world.cell_cloths[0].soft.cloth.hand;
  EXPECT_EQ(hand.shear, 60);
  EXPECT_EQ(hand.bending_weft, fabric_hand("silk").bending_weft);
  EXPECT_EQ(hand.areal_mass, 0.15);  // the textile's own
}

TEST(ClothScene, TheResolvedSceneBuildsTheSameWorld) {
  const Scene scene = read_scene_text(cloth_scene, "test.yaml");
  const Scene again = read_scene_text(write_scene(scene), "again.yaml");
  EXPECT_EQ(write_scene(again), write_scene(scene));
}

TEST(ClothScene, PinsThatDoNotExistAreNamed) {
  expect_refused("corner: top_left", "corner: top_leff", "sheet.soft.pins[0]", "top_left");
  expect_refused("edge: right", "edge: north", "sheet.soft.pins[1]", "north");
  expect_refused("{corner: top_left}", "{corner: top_left, edge: left}", "pins[0]", "exactly one");
  expect_refused("{corner: top_left}", "{point: [5 m, 0]}", "pins[0]", "off the cloth");
  expect_refused("{corner: top_left}", "{point: [-30 mm, 0]}", "pins[0]", "off the cloth");
}

TEST(ClothScene, KeyTimesOfAPinRise) {
  expect_refused("{corner: top_left}",
                 "{corner: top_left, motion: [{time: 1 s, displacement: [0, 0, 0]}, {time: 1 s, displacement: [0, 0, 1 mm]}]}",
                 "motion[1].time", "not after");
}

TEST(ClothScene, StiffnessesArePositive) {
  expect_refused("shear: 60 N/m", "shear: 0 N/m", "hand.shear", "outside");
  expect_refused("preset: silk", "preset: slik", "sheet.soft.preset", "silk");
}

TEST(ClothScene, CellsNeedAnArealMass) {
  const std::string text = with(with(cloth_scene, "    areal_mass: 150 g/m2\n", ""),
                                "sheet: {soft: {columns: 21, rows: 11, preset: silk, cloth: {hand: {shear: 60 N/m}}, pins: [{corner: top_left}, {edge: right}]}}",
                                "sheet: fixed");
  EXPECT_NE(problems(text).find("areal_mass"), std::string::npos);
}

TEST(ClothScene, AFixedClothOfCellsNeedsNoSoftSheet) {
  const World world = built(with(cloth_scene,
                                 "sheet: {soft: {columns: 21, rows: 11, preset: silk, cloth: {hand: {shear: 60 N/m}}, pins: [{corner: top_left}, {edge: right}]}}",
                                 "sheet: fixed"));
  EXPECT_TRUE(world.cell_cloths[0].soft.sheet.fixed);
  EXPECT_FALSE(world.cell_cloths[0].soft.moves());
}

TEST(ClothScene, APipeWiderThanTheDomainIsRefused) {
  expect_refused("textiles:\n", "domain: {lower: [-15 mm, -15 mm, -1], upper: [15 mm, 15 mm, 1]}\ntextiles:\n",
                 "liquid.pipes[0].radius", "wider than the domain");
}

TEST(ClothScene, ARateThatExceedsMemoryIsRefused) {
  expect_refused("particle_rate: 300", "particle_rate: 1e9", "liquid.particle_mass", "more than");
}

TEST(ClothScene, AJetFullerThanItsBoreIsRefused) {
  expect_refused("particle_rate: 300", "flow: 800 mL/s", "liquid.pipes[0].speed", "do not fit");
}

TEST(ClothScene, APipeWantsOneOfFlowAndRate) {
  expect_refused("particle_rate: 300, ", "", "liquid.pipes[0]", "exactly one");
  expect_refused("radius: 20 mm, ", "", "liquid.pipes[0]", "radius and length");
}

// --- free-form sheets -------------------------------------------------------------------------------------------------

std::string mesh_scene(const std::filesystem::path& file) {
  return "version: 1\nduration: 1 s\ntextiles:\n  - name: cloth\n    areal_mass: 150 g/m2\n    sheet: {soft: {mesh: '" +
         file.string() + "', uv_scale: 0.1}}\n    wetting: cells\n";
}

// A file of each test's own: tests run side by side.
std::filesystem::path mesh_file() {
  const char* test = ::testing::UnitTest::GetInstance()->current_test_info()->name();
  return std::filesystem::path(::testing::TempDir()) / fmt::format("imbibe_cloth_{}_{}.obj", test, ::getpid());
}

std::string problems_of_mesh(const std::string& obj) {
  const std::filesystem::path file = mesh_file();
  std::ofstream(file) << obj;
  return problems(mesh_scene(file));
}

const char* const square =
    "v 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nv 0 0.1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n";

TEST(ClothScene, AMeshWithUvBecomesASheet) {
  EXPECT_EQ(problems_of_mesh(square), "none");
  const World world = built(mesh_scene(mesh_file()));
  EXPECT_NEAR(total_mass(world.cell_cloths[0].soft.sheet), 0.15 * 0.01, 1e-12);
  Real area = 0;
  for (const Real a : world.cell_cloths[0].grid->area) area += a;
  EXPECT_NEAR(area, 0.01, 1e-12);
}

TEST(ClothScene, AMeshWithoutUvIsRefused) {
  EXPECT_NE(problems_of_mesh("v 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nf 1 2 3\n").find("UV"), std::string::npos);
}

TEST(ClothScene, ASeamIsRefused) {
  EXPECT_NE(problems_of_mesh(with(with(square, "vt 0 1\n", "vt 0 1\nvt 0.5 0\n"), "f 1/1 3/3 4/4", "f 1/5 3/3 4/4")).find("seam"),
            std::string::npos);
}

TEST(ClothScene, ANonManifoldMeshIsRefused) {
  const std::string said = problems_of_mesh(with(with(square, "vt 0 1\n", "vt 0 1\nv 0.05 0.05 0.1\nvt 0.5 0.9\n"),
                                                 "f 1/1 3/3 4/4", "f 1/1 3/3 4/4\nf 1/1 3/3 5/5"));
  EXPECT_NE(said.find("edge"), std::string::npos) << said;
}

TEST(ClothScene, AZeroAreaTriangleIsRefused) {
  const std::string said = problems_of_mesh(with(square, "vt 1 1\n", "vt 0.5 0\n"));
  EXPECT_NE(said.find("area"), std::string::npos) << said;
}

}  // namespace
}  // namespace imbibe
