#include "imbibe/scene/parameter_table.h"

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "imbibe/scene/describe_reader.h"
#include "scene/scene_test_support.h"

namespace imbibe {
namespace {

TEST(ParameterTable, TheReferencePageIsCurrent) {
  const std::string page = std::string(IMBIBE_SOURCE_DIR) + "/docs/reference/parameters.md";
  std::ifstream in(page);
  ASSERT_TRUE(in) << page;
  std::stringstream text;
  text << in.rdbuf();
  EXPECT_EQ(text.str(), table_markdown(parameter_rows<Scene>()))
      << "run: ./imbibe params --markdown > docs/reference/parameters.md";
}

TEST(ParameterTable, EveryKeyHasAMeaningAndStandsOnce) {
  std::set<std::string> seen;
  for (const ParameterRow& row : parameter_rows<Scene>()) {
    EXPECT_FALSE(row.help.empty()) << row.path;
    EXPECT_TRUE(seen.insert(row.path).second) << row.path << " stands twice";
  }
  EXPECT_TRUE(seen.contains("textiles[].warp.density"));
  EXPECT_TRUE(seen.contains("textiles[].wetting.network.crossing_factor"));
}

TEST(ParameterTable, EveryDefaultLiesInItsRangeAndIsReadAsItIsPrinted) {
  for (const ParameterRow& row : parameter_rows<Scene>()) {
    if (row.kind != RowKind::value || row.fallback.empty() || row.length != 1 || row.element != "number") continue;
    DataNode node;
    node.kind = DataNode::Kind::scalar;
    node.text = row.fallback;
    Real value = 0;
    ReadLog log;
    const ParameterInfo info{.unit = row.unit.c_str(), .shown = row.shown.c_str(), .min = row.min, .max = row.max,
                             .above_min = row.above_min};
    reading::read_scalar(node, row.path, value, info, log);
    for (const Problem& p : log.problems) ADD_FAILURE() << p.text();
  }
}

TEST(ParameterTable, JsonHoldsEveryRow) {
  const auto rows = parameter_rows<Scene>();
  const auto json = nlohmann::json::parse(table_json(rows));
  ASSERT_EQ(json.size(), rows.size());
  for (const auto& item : json) {
    if (item["path"] != "air.humidity") continue;
    EXPECT_EQ(item["default"], "65 %");
    EXPECT_EQ(item["max"], 1);
    EXPECT_EQ(item["shown_unit"], "%");
  }
}

TEST(ParameterTable, TheSchemaNestsAsSceneFilesDo) {
  const auto schema = nlohmann::json::parse(table_schema(parameter_rows<Scene>(), "t"));
  const auto& textile = schema.at("properties").at("textiles").at("items");
  EXPECT_EQ(textile.at("additionalProperties"), false);
  EXPECT_TRUE(textile.at("properties").at("warp").at("properties").contains("density"));
  EXPECT_TRUE(textile.at("properties").contains("thickness"));
  // `kind: water` and `kind: {name: water}` are both right.
  EXPECT_TRUE(schema.at("properties").at("liquid").at("properties").at("kind").contains("anyOf"));
}

}  // namespace
}  // namespace imbibe
