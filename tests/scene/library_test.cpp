#include "imbibe/scene/library.h"

#include "scene/scene_test_support.h"

namespace imbibe {
namespace {

using test::TemporaryFolder;

const char* const good_liquid =
    "name: mine\n"
    "title: My liquid\n"
    "temperature: 20 degC\n"
    "values:\n"
    "  density: {value: 900 kg/m3, source: measured, confidence: high}\n"
    "  viscosity: {value: 2 mPa s, source: measured, confidence: high}\n"
    "  surface_tension: {value: 30 mN/m, source: measured, confidence: low}\n";

TEST(Library, TheShippedLiquidsAreReadWithTheirSources) {
  const Library library = read_library({IMBIBE_SOURCE_DIR});
  const LiquidRecord* water = find_liquid(library, "water");
  ASSERT_NE(water, nullptr);
  EXPECT_NEAR(water->kind.density, 998.2, 0.05);
  EXPECT_NEAR(water->kind.viscosity, 1.002e-3, 1e-6);
  EXPECT_NEAR(water->kind.surface_tension, 0.0728, 1e-4);
  for (const LiquidRecord& record : library.liquids)
    for (const FibreValue& value : record.values) {
      EXPECT_FALSE(value.source.empty()) << record.kind.name;
      EXPECT_TRUE(value.confidence == "high" || value.confidence == "medium" || value.confidence == "low");
    }
  EXPECT_NE(find_fibre(library.fibres, "cotton"), nullptr);
}

TEST(Library, ALiquidFileGivesItsValuesInSi) {
  TemporaryFolder folder;
  const LiquidRecord record = read_liquid_file(folder.write("mine.yaml", good_liquid));
  EXPECT_EQ(record.kind.name, "mine");
  EXPECT_DOUBLE_EQ(record.kind.viscosity, 2e-3);
  EXPECT_DOUBLE_EQ(record.kind.surface_tension, 0.03);
  EXPECT_EQ(record.values[1].shown, "2 mPa s");
}

TEST(Library, AValueWithoutASourceIsRefused) {
  TemporaryFolder folder;
  std::string text = good_liquid;
  text.replace(text.find(", source: measured"), 18, "");
  try {
    read_liquid_file(folder.write("mine.yaml", text));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.problems()[0].key, "values.density.source");
    EXPECT_EQ(error.problems()[0].line, 5);
  }
}

TEST(Library, AMissingPropertyIsRefused) {
  TemporaryFolder folder;
  std::string text = good_liquid;
  text.resize(text.find("  surface_tension"));
  try {
    read_liquid_file(folder.write("mine.yaml", text));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.problems()[0].key, "values.surface_tension");
  }
}

TEST(Library, DataBesideTheSceneWinsOverTheInstalled) {
  TemporaryFolder program, user;
  std::string theirs = good_liquid;
  theirs.replace(theirs.find("900"), 3, "800");
  program.write("liquids/mine.yaml", theirs);
  user.write("liquids/mine.yaml", good_liquid);
  const auto scene = user.write("scenes/deep/scene.yaml", "version: 1\n");
  const auto folders = library_folders(scene, {program.path().string()});
  ASSERT_GE(folders.size(), 2u);
  EXPECT_EQ(folders.back(), std::filesystem::canonical(user.path()));
  EXPECT_EQ(find_liquid(read_library(folders), "mine")->kind.density, 900);
}

TEST(Library, NoDataAtAllIsSaidWithWhereToPutIt) {
  try {
    read_library({});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("IMBIBE_DATA_DIR"), std::string::npos);
  }
}

}  // namespace
}  // namespace imbibe
