#include "imbibe/live/controls.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "imbibe/scene/builder.h"

namespace imbibe::live {
namespace {

Scene scene() { return read_scene(std::filesystem::path(IMBIBE_SOURCE_DIR) / "scenes/quickstart/drop_on_cotton.yaml"); }

TEST(Controls, NameOnlyWhatIsDescribedAndEverythingThatIs) {
  const auto bare = [](std::string path) {
    for (std::size_t at; (at = path.find('[')) != std::string::npos;) path.erase(at, path.find(']', at) - at + 1);
    return path;
  };
  std::set<std::string> described, shown;
  for (const ParameterRow& row : parameter_rows<Scene>())
    if (row.kind == RowKind::value || row.kind == RowKind::choice) described.insert(bare(row.path));
  for (const Control& control : controls_of(scene()))
    if (control.row.kind != RowKind::group) shown.insert(bare(control.row.path));
  EXPECT_TRUE(std::includes(described.begin(), described.end(), shown.begin(), shown.end()));
  for (const char* path : {"air.humidity", "textiles.contact_angle", "textiles.warp.fibre", "liquid.kind.viscosity",
                           "textiles.wetting.network.crossing_factor", "liquid.drops.volume"})
    EXPECT_TRUE(shown.contains(path)) << path;
}

TEST(Controls, ValuesAndRangesAreInTheShownUnit) {
  const auto controls = controls_of(scene());
  const auto find = [&](const std::string& path) {
    return *std::find_if(controls.begin(), controls.end(), [&](const Control& c) { return c.row.path == path; });
  };
  EXPECT_NEAR(find("air.temperature").numbers.at(0), 20, 1e-9);
  EXPECT_NEAR(find("air.humidity").numbers.at(0), 65, 1e-9);
  EXPECT_NEAR(find("textiles[0].contact_angle").high, 180, 1e-9);
  EXPECT_TRUE(find("textiles[0].contact_angle").numbers.empty());  // not given: each fibre's own
  EXPECT_NEAR(find("textiles[0].size").numbers.at(1), 36, 1e-9);
  EXPECT_EQ(find("textiles[0].size").effect, Effect::restart);
  EXPECT_EQ(find("textiles[0].contact_angle").effect, Effect::next_step);
}

TEST(Controls, WhatOneTurnsFirstTakesEffectAtTheNextStep) {
  std::set<std::string> described;
  for (const ParameterRow& row : parameter_rows<Scene>()) described.insert(row.path);
  for (std::string path :
       {"textiles[].contact_angle", "textiles[].warp_contact_angle", "textiles[].weft_contact_angle", "textiles[].warp.fibre", "textiles[].weft.fibre", "textiles[].regain", "air.humidity", "air.temperature",
        "liquid.kind.surface_tension", "liquid.kind.viscosity", "textiles[].wetting.network.crossing_factor",
        "textiles[].wetting.network.evaporation", "gravity", "liquid.droppers[].volume", "liquid.droppers[].interval",
        "liquid.droppers[].centre", "liquid.pipes[].particle_rate", "textiles[].wetting.cells.absorb",
        "textiles[].wetting.cells.leak", "textiles[].wetting.cells.bounce", "textiles[].sheet.soft.cloth.hand.stretch_weft",
        "textiles[].sheet.soft.cloth.air.wind", "solids[].contact_angle"}) {
    EXPECT_TRUE(described.contains(path)) << path;
    for (std::size_t at; (at = path.find("[]")) != std::string::npos;) path.replace(at, 2, "[0]");
    EXPECT_EQ(effect_of(path), Effect::next_step) << path;
  }
}

TEST(Controls, EveryOneThatIsLiveCanBeSetToItsOwnValue) {
  const Library library = read_library({IMBIBE_SOURCE_DIR});
  Scene s = scene();
  s.liquid.particle_mass = 1e-6;  // few particles: this is about keys
  World world = build_world(s, library);
  std::vector<std::string> all;
  for (const Control& control : controls_of(s))
    if (control.row.kind != RowKind::group && control.effect == Effect::next_step && !control.row.fallback.empty())
      all.push_back(control.row.path + "=" + control.row.fallback);
  EXPECT_GT(all.size(), 50u);
  EXPECT_NO_THROW(apply_change(s, world, library, all));
}

TEST(Controls, ClothOfCellsHasNoneOfYarnsAndOneOfYarnsNoneOfCells) {
  const Library library = read_library({IMBIBE_SOURCE_DIR});
  for (const bool cells : {false, true}) {
    const std::filesystem::path folder = std::filesystem::path(IMBIBE_SOURCE_DIR) / "scenes/cloth";
    const Scene s = read_scene(folder / (cells ? "drop_on_hammock.yaml" : "network_on_hammock.yaml"));
    std::set<std::string> paths;
    for (const auto& row : nlohmann::json::parse(controls_json(s, build_world(s, library), library))) paths.insert(row["path"]);
    for (const char* path : {"textiles[0].warp", "textiles[0].warp.fibre", "textiles[0].regain", "textiles[0].wetting.network.evaporation"})
      EXPECT_EQ(paths.contains(path), !cells) << path;
    EXPECT_EQ(paths.contains("textiles[0].wetting.cells.absorb"), cells);
    EXPECT_TRUE(paths.contains("textiles[0].contact_angle"));
    EXPECT_TRUE(paths.contains("textiles[0].sheet.soft.cloth.hand.stretch_weft"));
  }
}

TEST(Controls, AngleThatIsNotGivenShowsTheFibresOwn) {
  const Library library = read_library({IMBIBE_SOURCE_DIR});
  const Scene s = scene();
  const World world = build_world(s, library);
  const auto rows = nlohmann::json::parse(controls_json(s, world, library));
  const auto angle = std::find_if(rows.begin(), rows.end(), [](const auto& r) { return r["path"] == "textiles[0].contact_angle"; });
  ASSERT_NE(angle, rows.end());
  EXPECT_NEAR((*angle)["stands_for"].get<Real>(), degrees(world.textiles[0].model->fibres[0].advancing_angle), 1e-9);
}

}  // namespace
}  // namespace imbibe::live
