#include "imbibe/io/run_folder.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "imbibe/core/error.h"
#include "imbibe/sim/checkpoint.h"
#include "imbibe/sim/state_hash.h"
#include "io/limited_file_size.h"
#include "io/small_world.h"
#include "io/temporary_folder.h"

namespace imbibe {
namespace {

using testing::small_world;
using testing::TemporaryFolder;
using testing::text_of;
namespace fs = std::filesystem;

RunSetup setup() {
  RunSetup s;
  s.command = "imbibe run scene.yaml --set a='b c'";
  s.title = "A drop on cotton";
  s.scene_yaml = "version: 1\n";
  s.seed = 5;
  s.threads = 2;
  s.until_s = 1;
  s.fabrics = {{"swatch", "porosity 0.686"}};
  return s;
}

nlohmann::json run_json(const fs::path& folder) {
  return nlohmann::json::parse(text_of(folder / "run.json"));
}

std::vector<Real> times_in(const fs::path& pvd) {
  std::vector<Real> times;
  for (const PvdEntry& entry : read_pvd(pvd)) {
    times.push_back(entry.time_s);
    EXPECT_TRUE(fs::exists(pvd.parent_path() / entry.file)) << entry.file;
  }
  return times;
}

bool has_part_files(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".part") return true;
  }
  return false;
}

// Output at 0, 0.1, ... up to `last`, starting after `first`.
void make_outputs(RunFolder& folder, World& world, int first, int last) {
  for (int i = first; i <= last; ++i) {
    world.time = 0.1 * i;
    world.step = static_cast<std::uint64_t>(100 * i);
    folder.write_output(world, {});
  }
}

TEST(RunFolder, explains_itself_from_the_first_moment_and_is_complete_at_the_end) {
  const TemporaryFolder parent;
  const fs::path path = parent / "deep/run";
  World world = small_world();
  RunFolder folder(path, setup(), ExistingFolder::refuse, world);
  EXPECT_TRUE(text_of(path / "scene.yaml").ends_with("\nversion: 1\n")) << "behind a comment that says whose it is";
  EXPECT_EQ(run_json(path)["status"], "running");
  make_outputs(folder, world, 0, 2);
  folder.write_checkpoint(world);
  folder.note("Taken up by the yarns.");
  folder.log("a line");
  folder.finish(world, RunStatus::done);

  const nlohmann::json run = run_json(path);
  EXPECT_EQ(run["status"], "done");
  EXPECT_EQ(run["command"], setup().command);
  EXPECT_EQ(run["seed"], 5);
  EXPECT_EQ(run["threads"], 2);
  EXPECT_EQ(run["steps"], 200);
  EXPECT_EQ(run["outputs"], 3);
  EXPECT_EQ(run["state_hash"], state_hash_text(world));
  EXPECT_EQ(run["ledger"]["free_kg"], mass_balance(world).free);
  EXPECT_EQ(run["fabrics"][0]["numbers"], "porosity 0.686");
  EXPECT_EQ(run["notes"][0], "Taken up by the yarns.");
  EXPECT_GE(run["wall_s"], 0);
  EXPECT_FALSE(run["version"].get<std::string>().empty());
  EXPECT_GT(run["machine"]["memory_bytes"], 0);

  const std::vector<Real> times{0, 0.1, 0.2};
  EXPECT_EQ(read_series(path / "series.csv").column("time_s"), times);
  for (const char* pvd : {"liquid.pvd", "textile_swatch.pvd", "textile_swatch_pores.pvd"}) {
    EXPECT_EQ(times_in(path / pvd), times) << pvd;
  }
  EXPECT_TRUE(fs::exists(path / "liquid_000002.vtp"));
  EXPECT_TRUE(fs::exists(path / "checkpoint_000000200.h5"));
  EXPECT_NE(text_of(path / "log.txt").find("a line"), std::string::npos);
  EXPECT_FALSE(has_part_files(path));
}

TEST(RunFolder, that_is_not_empty_is_refused_and_left_alone) {
  const TemporaryFolder parent;
  write_whole_file(parent / "mine.txt", "precious");
  const World world = small_world();
  EXPECT_THROW(RunFolder(parent.path(), setup(), ExistingFolder::refuse, world), InputError);
  EXPECT_THROW(RunFolder(parent.path(), setup(), ExistingFolder::overwrite, world), InputError);
  EXPECT_THROW(RunFolder(parent.path(), setup(), ExistingFolder::resume, world), InputError);
  EXPECT_THROW(RunFolder(parent / "mine.txt", setup(), ExistingFolder::refuse, world), InputError);
  EXPECT_EQ(testing::files_in(parent.path()), 1u);
  EXPECT_EQ(text_of(parent / "mine.txt"), "precious");
}

TEST(RunFolder, overwritten_loses_the_earlier_run_and_nothing_else) {
  const TemporaryFolder parent;
  World world = small_world();
  {
    RunFolder folder(parent.path(), setup(), ExistingFolder::refuse, world);
    make_outputs(folder, world, 0, 5);
    folder.write_checkpoint(world);
  }
  fs::create_directory(parent / "pictures");
  write_whole_file(parent / "pictures/picture_000000.png", "old");
  write_whole_file(parent / "pictures/mine.png", "precious");
  write_whole_file(parent / "notes.txt", "precious");
  RunFolder folder(parent.path(), setup(), ExistingFolder::overwrite, small_world());
  EXPECT_FALSE(fs::exists(parent / "liquid_000000.vtp"));
  EXPECT_FALSE(fs::exists(parent / "textile_swatch_pores_000003.vtp"));
  EXPECT_FALSE(fs::exists(parent / "liquid.pvd"));
  EXPECT_FALSE(fs::exists(parent / "pictures/picture_000000.png"));
  EXPECT_TRUE(list_checkpoints(parent.path()).empty());
  EXPECT_EQ(read_series(parent / "series.csv").rows(), 0u);
  EXPECT_EQ(text_of(parent / "notes.txt"), "precious");
  EXPECT_EQ(text_of(parent / "pictures/mine.png"), "precious");
}

TEST(RunFolder, resumed_between_two_outputs_ends_as_if_never_stopped) {
  const TemporaryFolder parent;
  World world = small_world();
  {
    RunFolder folder(parent.path(), setup(), ExistingFolder::refuse, world);
    make_outputs(folder, world, 0, 5);  // went on to 0.5 s after the checkpoint of 0.23 s, then was killed
  }
  world.time = 0.23;
  world.step = 230;
  {
    RunFolder folder(parent.path(), setup(), ExistingFolder::resume, world);
    folder.write_output(world, {});  // the state it starts from: not an output time
    EXPECT_EQ(read_series(parent / "series.csv").column("time_s"), (std::vector<Real>{0, 0.1, 0.2}));
    make_outputs(folder, world, 3, 4);
    folder.finish(world, RunStatus::done);
  }
  const std::vector<Real> times{0, 0.1, 0.2, 0.1 * 3, 0.4};
  EXPECT_EQ(read_series(parent / "series.csv").column("time_s"), times);
  EXPECT_EQ(times_in(parent / "liquid.pvd"), times);
  EXPECT_EQ(times_in(parent / "textile_swatch.pvd"), times);
  EXPECT_EQ(read_pvd(parent / "liquid.pvd").back().file, "liquid_000004.vtp");
}

TEST(RunFolder, resumed_at_an_output_time_has_it_once_whether_or_not_it_was_written_before) {
  for (const int last_written : {2, 3}) {
    const TemporaryFolder parent;
    World world = small_world();
    {
      RunFolder folder(parent.path(), setup(), ExistingFolder::refuse, world);
      make_outputs(folder, world, 0, last_written);
    }
    world.time = 0.1 * 3;
    world.step = 300;
    RunFolder folder(parent.path(), setup(), ExistingFolder::resume, world);
    make_outputs(folder, world, 3, 4);
    EXPECT_EQ(read_series(parent / "series.csv").column("time_s"), (std::vector<Real>{0, 0.1, 0.2, 0.1 * 3, 0.4}));
    EXPECT_EQ(times_in(parent / "liquid.pvd").size(), 5u);
  }
}

TEST(RunFolder, resumed_adds_up_wall_time_and_keeps_the_start_and_the_log) {
  const TemporaryFolder parent;
  World world = small_world();
  {
    RunFolder folder(parent.path(), setup(), ExistingFolder::refuse, world);
    make_outputs(folder, world, 0, 1);
    folder.finish(world, RunStatus::interrupted, "stopped by the user");
  }
  nlohmann::json run = run_json(parent.path());
  EXPECT_EQ(run["reason"], "stopped by the user");
  run["wall_s"] = 1000;
  run["started_at"] = "2001-01-01T00:00:00Z";
  write_whole_file(parent / "run.json", run.dump());
  RunFolder folder(parent.path(), setup(), ExistingFolder::resume, world);
  folder.finish(world, RunStatus::done);
  EXPECT_GE(run_json(parent.path())["wall_s"], 1000);
  EXPECT_EQ(run_json(parent.path())["started_at"], "2001-01-01T00:00:00Z");
  const std::string log = text_of(parent / "log.txt");
  EXPECT_NE(log.find("started version"), std::string::npos);
  EXPECT_NE(log.find("resumed version"), std::string::npos);
}

TEST(RunFolder, on_a_disk_that_fills_up_says_so_and_keeps_every_earlier_output) {
  const TemporaryFolder parent;
  World world = small_world();
  RunFolder folder(parent.path(), setup(), ExistingFolder::refuse, world);
  make_outputs(folder, world, 0, 1);
  const std::string series = text_of(parent / "series.csv"), pvd = text_of(parent / "liquid.pvd");
  World larger = small_world(20000);
  larger.time = 0.2;
  {
    const testing::LimitedFileSize limit(20000);
    EXPECT_THROW(folder.write_output(larger, {}), OutputError);
  }
  EXPECT_EQ(text_of(parent / "series.csv"), series);
  EXPECT_EQ(text_of(parent / "liquid.pvd"), pvd);
  EXPECT_EQ(times_in(parent / "textile_swatch.pvd").size(), 2u);
  EXPECT_FALSE(has_part_files(parent.path()));
  // Space is there again: the run goes on in the same folder.
  folder.write_output(larger, {});
  EXPECT_EQ(read_series(parent / "series.csv").rows(), 3u);
  EXPECT_EQ(times_in(parent / "liquid.pvd").size(), 3u);
}

TEST(RunFolder, that_vanishes_during_the_run_or_cannot_be_made_is_an_output_error_that_names_it) {
  const TemporaryFolder parent;
  World world = small_world();
  RunFolder folder(parent / "run", setup(), ExistingFolder::refuse, world);
  fs::remove_all(parent / "run");
  try {
    folder.write_output(world, {});
    FAIL();
  } catch (const OutputError& error) {
    EXPECT_NE(std::string(error.what()).find((parent / "run").string()), std::string::npos) << error.what();
  }
  EXPECT_THROW(folder.log("x"), OutputError);
  EXPECT_THROW(folder.finish(world, RunStatus::failed), OutputError);
  // A device's folder takes no new folders, not even from root.
  EXPECT_THROW(RunFolder("/proc/imbibe_run", setup(), ExistingFolder::refuse, world), OutputError);
}

TEST(RunFolder, refuses_a_state_that_is_not_finite_and_names_the_array) {
  const TemporaryFolder parent;
  World world = small_world();
  RunFolder folder(parent.path(), setup(), ExistingFolder::refuse, world);
  world.liquid.particles.velocity[3].y = std::numeric_limits<float>::quiet_NaN();
  try {
    folder.write_output(world, {});
    FAIL();
  } catch (const NumericalError& error) {
    EXPECT_NE(error.where.find("'velocity'"), std::string::npos) << error.where;
  }
}

TEST(RunFolder, keeps_textiles_apart_whose_names_give_the_same_file_name) {
  const TemporaryFolder parent;
  World world = small_world();
  world.textiles.resize(3, world.textiles[0]);
  world.textiles[0].name = "a b";
  world.textiles[1].name = "a/b";
  world.textiles[2].name = "a b pores";
  RunFolder folder(parent.path(), setup(), ExistingFolder::refuse, world);
  make_outputs(folder, world, 0, 0);
  std::size_t collections = 0;
  for (const auto& entry : fs::directory_iterator(parent.path())) collections += entry.path().extension() == ".pvd";
  EXPECT_EQ(collections, 1u + 2 * 3);
}

TEST(TextilePolyData, has_one_line_per_yarn_with_the_values_of_its_segments) {
  World world = small_world();
  Textile& textile = world.textiles[0];
  const YarnNetwork& network = textile.fabric->network;
  textile.placement.origin = {1, 2, 3};
  for (std::size_t s = 0; s < network.segments(); ++s) textile.contents.liquid_kg[s] = 1e-9 * static_cast<Real>(s + 1);
  const PolyData data = textile_poly_data(textile, node_saturations(textile, world.air));
  ASSERT_EQ(data.line_start.size(), 18u + 1);  // 10 ends, 8 picks
  const auto find = [&](const std::string& name) -> const PointArray& {
    for (const PointArray& array : data.arrays) {
      if (array.name == name) return array;
    }
    throw std::runtime_error("no array " + name);
  };
  const auto& yarn_kg = std::get<std::vector<float>>(find("yarn_kg").values);
  const auto& yarn = std::get<std::vector<std::int32_t>>(find("yarn").values);
  const auto& family = std::get<std::vector<std::int32_t>>(find("family").values);
  for (std::size_t s = 0; s < network.segments(); ++s) {
    // The point in the middle of a segment is its centre, and carries its mass.
    const Index y = network.segment_yarn[s];
    const std::size_t point =
        network.yarn_first_point[y] +
        (s - network.yarn_first_segment[y]) * static_cast<std::size_t>(network.points_per_segment) +
        static_cast<std::size_t>(network.points_per_segment / 2);
    EXPECT_EQ(yarn_kg[point], static_cast<float>(1e-9 * static_cast<Real>(s + 1)));
    EXPECT_EQ(yarn[point], static_cast<std::int32_t>(y));
    EXPECT_EQ(family[point], static_cast<std::int32_t>(network.family_of_segment(s)));
    const Vec3 centre = network.segment_centre[s] + Vec3{1, 2, 3};
    EXPECT_NEAR(data.points[point].x, centre.x, 1e-6);  // float
    EXPECT_NEAR(data.points[point].y, centre.y, 1e-6);
  }
}

}  // namespace
}  // namespace imbibe
