// Every kind of bad scene the program must refuse: one test each, with line, column, key and message.
#include "scene/scene_test_support.h"

namespace imbibe {
namespace {

using test::expect_one;
using test::problems_of;
using test::small_scene;
using test::with_line;

TEST(BadScene, TheSmallSceneItselfIsGood) { EXPECT_TRUE(problems_of(small_scene).empty()); }

TEST(BadScene, AMissingFileIsNamed) {
  try {
    read_scene("/nonexistent/scene.yaml");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("there is no file '/nonexistent/scene.yaml'"), std::string::npos);
  }
}

TEST(BadScene, AFolderIsNotAScene) {
  try {
    read_scene("/tmp");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("is a folder"), std::string::npos);
  }
}

TEST(BadScene, NotYamlGivesThePlace) { expect_one(problems_of("version: 1\ntitle: [open\n"), 3, 1, "", "is not YAML"); }

TEST(BadScene, ABinaryFileIsSaidToBeOne) {
  expect_one(problems_of(std::string("\x89PNG\0\0\0", 7)), 0, 0, "", "not a text file");
}

TEST(BadScene, AnEmptyFileIsSaidToBeEmpty) { expect_one(problems_of(""), 1, 1, "", "empty"); }

TEST(BadScene, APlainTextIsNotAScene) { expect_one(problems_of("hello\n"), 1, 1, "", "is not a scene"); }

TEST(BadScene, AnUnknownKeySuggestsTheNearest) {
  expect_one(problems_of(with_line(14, "    wrap: {fibre: cotton, diameter: 0.4 mm, density: 10 /cm}")), 14, 5,
             "textiles[0].wrap", "did you mean 'warp'?");
}

TEST(BadScene, AnUnknownKeyDeepInAListHasItsWholePath) {
  expect_one(problems_of(with_line(9, "    - {centre: [0, 0, 5 mm], volume: 50 uL, veloctiy: [0, 0, 0]}")), 9, 45,
             "liquid.drops[0].veloctiy", "did you mean 'velocity'?");
}

TEST(BadScene, ADuplicateKeyIsRefused) {
  expect_one(problems_of(with_line(3, "duration: 1 s\nduration: 2 s")), 4, 1, "duration", "already given at line 3");
}

TEST(BadScene, AWrongTypeIsNamed) {
  expect_one(problems_of(with_line(3, "duration: [1, 2]")), 3, 11, "duration", "not a list");
  expect_one(problems_of(with_line(12, "    size: 12 mm")), 12, 11, "textiles[0].size", "wants a list of 2 values");
  expect_one(problems_of(with_line(4, "air: 20 degC")), 4, 6, "air", "wants a map of keys (temperature, humidity");
  expect_one(problems_of(with_line(3, "duration: long")), 3, 11, "duration", "'long' is not a number with a unit");
  expect_one(problems_of(with_line(2, "seed: 1.5")), 2, 7, "seed", "not a whole number");
  expect_one(problems_of(with_line(2, "seed: -1")), 2, 7, "seed", "not a whole number of 0 or more");
  expect_one(problems_of(with_line(2, "output: {pictures: maybe}")), 2, 20, "output.pictures", "not true or false");
}

TEST(BadScene, AKeyWithoutAValueIsNotADefault) {
  expect_one(problems_of(with_line(3, "duration:")), 3, 1, "duration", "has no value");
  expect_one(problems_of(with_line(4, "air:")), 4, 1, "air", "has no value");
}

TEST(BadScene, AWrongCountOfValuesIsNamed) {
  expect_one(problems_of(with_line(9, "    - {centre: [0, 5 mm], volume: 50 uL}")), 9, 16, "liquid.drops[0].centre",
             "wants 3 values, has 2");
}

TEST(BadScene, AWrongUnitIsNamedWithTheWantedKind) {
  expect_one(problems_of(with_line(3, "duration: 3 mm")), 3, 11, "duration", "'mm' is not convertible to s");
  expect_one(problems_of(with_line(9, "    - {centre: [0, 0, 5 mm], volume: 50 kg}")), 9, 38, "liquid.drops[0].volume",
             "wants a number with a unit such as 'uL'");
  expect_one(problems_of(with_line(3, "duration: 3 secnds")), 3, 11, "duration", "'secnds' is not a known unit");
}

TEST(BadScene, AMissingUnitIsRefusedWhereABareNumberIsAmbiguous) {
  expect_one(problems_of(with_line(4, "air: {temperature: 20}")), 4, 20, "air.temperature", "needs a unit (degC or K)");
  expect_one(problems_of(with_line(16, "    contact_angle: 45")), 16, 20, "textiles[0].contact_angle",
             "needs a unit (deg or rad)");
}

TEST(BadScene, AValueOutOfRangeNamesValueAndRangeAndIsNotClamped) {
  expect_one(problems_of(with_line(4, "air: {humidity: 120 %}")), 4, 17, "air.humidity",
             "120 % is outside [0 %, 100 %]");
  expect_one(problems_of(with_line(16, "    contact_angle: 190 deg")), 16, 20, "textiles[0].contact_angle",
             "190 deg is outside [0 deg, 180 deg]");
  expect_one(problems_of(with_line(1, "version: 2")), 1, 10, "version", "2 is outside [1, 1]");
}

TEST(BadScene, NanAndInfinityAreRefused) {
  for (const char* value : {".nan", ".inf", "-.inf", "nan", "inf", "-Infinity", "1e999", ".NaN s", "nan s"}) {
    const auto problems = problems_of(with_line(3, std::string("duration: ") + value));
    ASSERT_EQ(problems.size(), 1u) << value;
    EXPECT_EQ(problems[0].key, "duration");
    EXPECT_EQ(problems[0].line, 3);
  }
  expect_one(problems_of(with_line(3, "duration: .nan")), 3, 11, "duration", "is not a finite number");
}

TEST(BadScene, ZeroAndNegativeSizesAreRefused) {
  expect_one(problems_of(with_line(12, "    size: [0 mm, 12 mm]")), 12, 12, "textiles[0].size[0]", "0 mm is outside (0 mm, ");
}

TEST(BadScene, NegativeVolumeAndDurationAreRefused) {
  expect_one(problems_of(with_line(9, "    - {centre: [0, 0, 5 mm], volume: -50 uL}")), 9, 38,
             "liquid.drops[0].volume", "-50 uL is outside (0 uL, ");
  expect_one(problems_of(with_line(3, "duration: 0 s")), 3, 11, "duration", "0 s is outside (0 s, ");
}

TEST(BadScene, AMissingRequiredKeyIsNamed) {
  expect_one(problems_of(with_line(3, "seed: 1")), 1, 1, "duration", "is missing");
  expect_one(problems_of(with_line(9, "    - {centre: [0, 0, 5 mm]}")), 9, 7, "liquid.drops[0].volume", "is missing");
  expect_one(problems_of(with_line(7, "")), 6, 3, "liquid.particle_mass", "is missing");
}

TEST(BadScene, AWordThatIsNoChoiceListsTheChoices) {
  expect_one(problems_of(with_line(17, "    wetting: {network: {model: phisical}}")), 17, 32,
             "textiles[0].wetting.network.model", "did you mean 'physical'?");
}

TEST(BadScene, TwoTextilesOfOneNameAreRefused) {
  expect_one(problems_of(std::string(small_scene) +
                         "  - name: swatch\n"
                         "    centre: [0, 0, -20 mm]\n"),
             18, 11, "textiles[1].name", "already the name");
}

TEST(BadScene, DirectionsThatAreNotSquareAreRefused) {
  expect_one(problems_of(with_line(16, "    warp_direction: [1, 0, 0]")), 16, 21, "textiles[0].warp_direction",
             "not square");
}

TEST(BadScene, AnIncompleteSolidNamesWhatIsMissing) {
  const auto problems = problems_of(std::string(small_scene) + "solids:\n  - {shape: {kind: sphere, radius: 3 mm}}\n");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].line, 19);
  EXPECT_EQ(problems[0].key.rfind("solids[0].shape", 0), 0u) << problems[0].key;
}

TEST(BadScene, AllProblemsOfAFileComeInOneGo) {
  const auto problems = problems_of(
      "version: 1\n"
      "duration: 3 mm\n"
      "durations: 4\n"
      "air: {humidity: 120 %, temperature: 20}\n"
      "textiles:\n"
      "  - {size: [1, -1 mm], sheet: loose, warp: {fibre: [cotton]}}\n");
  std::vector<std::string> keys;
  for (const Problem& p : problems) keys.push_back(p.key);
  const std::vector<std::string> wanted = {"duration",         "air.temperature",        "air.humidity", "textiles[0].size[1]",
                                           "textiles[0].warp.fibre", "textiles[0].sheet.kind", "durations"};
  EXPECT_EQ(keys, wanted);
}

TEST(BadScene, AMessageReadsLikeACompilers) {
  const auto problems = problems_of(with_line(4, "air: {humidity: 120 %}"));
  EXPECT_EQ(problems[0].text(), "test.yaml:4:17: error: air.humidity: 120 % is outside [0 %, 100 %]");
}

TEST(BadScene, AnOverrideGoesThroughTheSameChecks) {
  const auto problems = problems_of(small_scene, {"textiles[0].warp.densty=10 /cm"});
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].text(),
            "--set: error: textiles[0].warp.densty: unknown key; did you mean 'density'?");
  EXPECT_EQ(problems_of(small_scene, {"air.humidity=120 %"})[0].text(),
            "--set: error: air.humidity: 120 % is outside [0 %, 100 %]");
}

}  // namespace
}  // namespace imbibe
