// The built command, `run` and what works on its folder: files, exit codes, refusals, limits.
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "imbibe/view/png.h"
#include "imbibe/view/vtp_reader.h"
#include "support/run_fixture.h"

namespace {

namespace fs = std::filesystem;
using namespace imbibe;
using namespace imbibe::test;

using RunCommand = CommandRun;

TEST_F(RunCommand, LeavesEveryFileOfTheRunFolder) {
  const std::string said = run("out");
  const fs::path out = folder_ / "out";
  for (const char* name : {"scene.yaml", "run.json", "log.txt", "series.csv", "liquid.pvd", "liquid_000000.vtp", "liquid_000010.vtp",
                           "textile_swatch.pvd", "textile_swatch_000010.vtp", "textile_swatch_pores.pvd",
                           "textile_swatch_pores_000010.vtp", "film.mp4", "report.html"})
    EXPECT_GT(fs::exists(out / name) ? fs::file_size(out / name) : 0, 100u) << name << "\n" << said;
  for (int i = 0; i <= 10; ++i) {
    char name[32];
    std::snprintf(name, sizeof name, "picture_%06d.png", i);
    const Image picture = read_png(out / "pictures" / name);
    EXPECT_EQ(picture.width, 96);
    EXPECT_EQ(picture.height, 64);
  }
  int checkpoints = 0, parts = 0;
  for (const auto& entry : fs::recursive_directory_iterator(out)) {
    checkpoints += entry.path().extension() == ".h5";
    parts += entry.path().extension() == ".part";
  }
  EXPECT_GE(checkpoints, 1);
  EXPECT_EQ(parts, 0) << "a finished run leaves no unfinished file";
  EXPECT_EQ(run_json("out")["status"], "done");
  EXPECT_EQ(run_json("out")["outputs"], 11);
}

TEST_F(RunCommand, ItsSeriesHasTheFixedColumnsAndABalanceThatCloses) {
  run("out", "--no-pictures");
  const std::string text = text_of(folder_ / "out" / "series.csv");
  EXPECT_TRUE(text.starts_with("time_s,free_kg,sorbed_kg,yarn_kg,pore_kg,cell_kg,evaporated_kg,left_kg,supplied_kg,ledger_error,"
                               "particles,wet_area_m2,wet_extent_warp_m,wet_extent_weft_m,mean_saturation,max_saturation,"
                               "step_s,steps"))
      << text.substr(0, 300);
  const SeriesTable table = read_series(folder_ / "out" / "series.csv");
  ASSERT_EQ(table.rows(), 11u);
  for (const Real error : table.column("ledger_error")) EXPECT_LE(error, 1e-10);  // the balance asked of every step
  EXPECT_NEAR(table.column("time_s").back(), 0.020, 1e-12);  // sums of some hundred steps, rounded
  EXPECT_GT(table.column("yarn_kg").back() + table.column("pore_kg").back(), 1e-7) << "the cloth took water up";
}

TEST_F(RunCommand, ItsVtkFilesReadBack) {
  run("out", "--no-pictures");
  const PolyData liquid = read_vtp(folder_ / "out" / "liquid_000001.vtp");
  EXPECT_GT(liquid.points.size(), 100u);
  EXPECT_NE(find_floats(liquid, "density"), nullptr);
  EXPECT_NE(find_floats(liquid, "mass"), nullptr);
  const PolyData yarns = read_vtp(folder_ / "out" / "textile_swatch_000010.vtp");
  for (const char* name : {"saturation", "sorbed_kg", "yarn_kg", "regain"}) EXPECT_NE(find_floats(yarns, name), nullptr) << name;
  const PolyData pores = read_vtp(folder_ / "out" / "textile_swatch_pores_000010.vtp");
  for (const char* name : {"saturation", "pore_kg"}) EXPECT_NE(find_floats(pores, name), nullptr) << name;
}

TEST_F(RunCommand, ItsSceneRunsAgainToTheSameState) {
  run("out", "--no-pictures --set liquid.drops[0].volume='2.5 uL'");
  const Outcome again = run_command("run " + in("out/scene.yaml") + " --no-pictures -o " + in("again"));
  EXPECT_EQ(again.code, 0) << again.output;
  EXPECT_EQ(hash("again"), hash("out"));
  run("other", "--no-pictures");
  EXPECT_NE(hash("other"), hash("out")) << "--set changed nothing";
}

TEST_F(RunCommand, GivesTheSameStateOnAnyNumberOfThreads) {
  run("one", "--no-pictures --threads 1");
  run("two", "--no-pictures --threads 2");
  run("three", "--no-pictures --threads 3");
  EXPECT_EQ(hash("one"), hash("two"));
  EXPECT_EQ(hash("one"), hash("three"));
  EXPECT_EQ(text_of(folder_ / "one" / "series.csv"), text_of(folder_ / "three" / "series.csv"));
}

TEST_F(RunCommand, RefusesAFolderThatIsNotEmptyAndOverwritesWhenAsked) {
  run("out", "--no-pictures --until 0.004");
  const std::string refusal = run("out", "--no-pictures", 2);
  EXPECT_NE(refusal.find("--overwrite"), std::string::npos) << refusal;
  EXPECT_EQ(run_json("out")["outputs"], 3) << "the refused run changed nothing";
  write("out/my_notes.txt", "mine");
  run("out", "--no-pictures --until 0.002 --overwrite");
  EXPECT_EQ(run_json("out")["outputs"], 2);
  EXPECT_FALSE(fs::exists(folder_ / "out" / "liquid_000002.vtp")) << "of the run that was replaced";
  EXPECT_EQ(text_of(folder_ / "out" / "my_notes.txt"), "mine");
  fs::create_directory(folder_ / "foreign");
  write("foreign/a.txt", "a");
  run("foreign", "--overwrite", 2);
  EXPECT_EQ(text_of(folder_ / "foreign" / "a.txt"), "a");
}

TEST_F(RunCommand, WritesProgressAsLinesOfJson) {
  // Only stderr carries progress.
  const Outcome outcome = run_command("run " + scene_ + " -o " + in("out") + " --no-pictures --progress json 2>" + in("progress"));
  EXPECT_EQ(outcome.code, 0);
  std::istringstream lines(text_of(folder_ / "progress"));
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    const nlohmann::json p = nlohmann::json::parse(line, nullptr, false);
    ASSERT_TRUE(p.is_object()) << line;
    for (const char* key : {"time_s", "until_s", "step_s", "step_bound", "free_kg", "absorbed_kg", "ledger_error"})
      EXPECT_TRUE(p.contains(key)) << key << " in " << line;
  }
  EXPECT_GE(count, 2) << "the first and the last step";
}

TEST_F(RunCommand, EndsWithOneAndKeepsItsFilesWhenTheDiskIsFull) {
  // 1 MiB for every file: the first outputs fit (0.44 MB), a smaller limit below would stop the first one.
  const std::string said = run("out", "--no-pictures --set textiles[0].size='[30 mm, 30 mm]'", 1, "ulimit -f 1024;");
  EXPECT_NE(said.find("error: cannot write"), std::string::npos) << said;
  EXPECT_NE(said.find("Files written before are intact"), std::string::npos) << said;
  for (const auto& entry : fs::directory_iterator(folder_ / "out"))
    EXPECT_NE(entry.path().extension(), ".part") << "an unfinished file stayed: " << entry.path();
  EXPECT_EQ(run_json("out")["status"], "failed");
  const std::string resumed = run_command("run " + in("out") + " --resume --no-pictures --until 0.004").output;
  EXPECT_EQ(run_json("out")["status"], "done") << "with room again it goes on\n" << resumed;
}

TEST_F(RunCommand, StopsAtItsLimitOfStepsWithAllKeptAndGoesOnWithAHigherOne) {
  const std::string said = run("out", "--set limits.max_steps=60", 1);
  EXPECT_NE(said.find("error: stopped after 60 steps"), std::string::npos) << said;
  EXPECT_EQ(said.find("error: error:"), std::string::npos) << said;
  EXPECT_EQ(run_json("out")["status"], "failed");
  EXPECT_TRUE(fs::exists(folder_ / "out" / "film.mp4"));
  EXPECT_TRUE(fs::exists(folder_ / "out" / "report.html"));
  const Outcome resumed = run_command("run " + in("out") + " --resume --set limits.max_steps=1e6");
  EXPECT_EQ(resumed.code, 0) << resumed.output;
  run("whole", "--no-pictures");
  EXPECT_EQ(hash("out"), hash("whole"));
}

TEST_F(RunCommand, EndsWithThreeWhenTheStepVanishesAndKeepsWhatWasWritten) {
  const std::string said = run("out", "--no-pictures --set liquid.solver.capillary_factor=1e-13", 3);
  EXPECT_NE(said.find("error: numerical failure at t = "), std::string::npos) << said;
  EXPECT_EQ(run_json("out")["status"], "failed");
  EXPECT_NE(std::string(run_json("out")["reason"]).find("the step fell to"), std::string::npos);
  EXPECT_EQ(read_series(folder_ / "out" / "series.csv").rows(), 1u);
}

TEST_F(RunCommand, StopsWhenTheRunFolderOutgrowsItsLimit) {
  run("out", "--no-pictures --until 0.004");
  // Something else fills the folder: the estimate before the run cannot know.
  write("out/big.bin", std::string(30'000'000, 'x'));
  const Outcome stopped = run_command("run " + in("out") + " --resume --no-pictures --until 0.02 --set limits.max_disk='20 MB'");
  EXPECT_EQ(stopped.code, 1) << stopped.output;
  EXPECT_NE(stopped.output.find("more than limits.max_disk = 20 MB"), std::string::npos) << stopped.output;
  fs::remove(folder_ / "out" / "big.bin");
  EXPECT_EQ(run_command("run " + in("out") + " --resume --no-pictures --until 0.02").code, 0);
  run("whole", "--no-pictures");
  EXPECT_EQ(hash("out"), hash("whole"));
}

TEST_F(RunCommand, RefusesASceneThatNeedsMoreMemoryThanItsLimit) {
  const std::string refused = run("refused", "--no-pictures --set limits.max_memory='10 MB'", 2);
  EXPECT_NE(refused.find("limits.max_memory"), std::string::npos) << refused;
  EXPECT_FALSE(fs::exists(folder_ / "refused"));
}

TEST_F(RunCommand, EndsWithOneWhenItsFolderVanishesOrIsNoPlaceToWrite) {
  const Outcome nowhere = run_command("run " + scene_ + " -o /proc/imbibe/run");
  EXPECT_EQ(nowhere.code, 1) << nowhere.output;
  EXPECT_NE(nowhere.output.find("cannot create the run folder /proc/imbibe/run"), std::string::npos) << nowhere.output;
  // 127 would be a command that could not be started.
  const fs::path out = folder_ / "out";
  bool gone = false;
  const int code = signalled_command({"run", scene_, "-o", out.string(), "--set", "duration=10 s"}, SIGCONT, [&] {
    if (!gone && fs::exists(out / "liquid_000002.vtp")) fs::rename(out, folder_ / "elsewhere"), gone = true;
    return gone;
  });
  EXPECT_EQ(code, 1);
}

TEST_F(RunCommand, RendersAndReportsFromItsFolder) {
  run("out", "--no-pictures");
  EXPECT_FALSE(fs::exists(folder_ / "out" / "pictures" / "picture_000010.png"));
  const Outcome render = run_command("render " + in("out") + " --last");
  EXPECT_EQ(render.code, 0) << render.output;
  EXPECT_EQ(read_png(folder_ / "out" / "pictures" / "picture_000010.png").width, 96);
  fs::remove(folder_ / "out" / "report.html");
  const Outcome report = run_command("report " + in("out"));
  EXPECT_EQ(report.code, 0) << report.output;
  EXPECT_NE(text_of(folder_ / "out" / "report.html").find("small drop"), std::string::npos);
  for (const char* command : {"render ", "report "}) EXPECT_EQ(run_command(command + in("nowhere")).code, 2) << command;
}

TEST_F(RunCommand, DrawsThePicturesOfTheRunAgainBitForBit) {
  run("out", "--until 0.006");
  EXPECT_EQ(run_command("render " + in("out") + " -o " + in("again")).code, 0);
  for (const char* name : {"picture_000000.png", "picture_000003.png"})
    EXPECT_EQ(text_of(folder_ / "out" / "pictures" / name), text_of(folder_ / "again" / "pictures" / name)) << name;
}

// A cloth of cells, and the pipe above it, which is a mesh.
TEST_F(RunCommand, DrawsAClothOfCellsAndItsPipeAgainBitForBit) {
  scene_ = IMBIBE_SOURCE_DIR "/scenes/seed_b/pipe_on_hanging_cloth.yaml";
  run("out", "--until 0.2 --set picture.width=96 --set picture.height=64 --set picture.samples=1");
  const Outcome render = run_command("render " + in("out") + " -o " + in("again"));
  EXPECT_EQ(render.code, 0) << render.output;
  for (const char* name : {"picture_000000.png", "picture_000002.png"})
    EXPECT_EQ(text_of(folder_ / "out" / "pictures" / name), text_of(folder_ / "again" / "pictures" / name)) << name;
  const PolyData cloth = read_vtp(folder_ / "out" / "textile_cloth_000002.vtp");
  EXPECT_EQ(cloth.points.size(), 23u * 23u);
  for (const char* name : {"saturation", "cell_kg", "velocity", "uv"})
    EXPECT_TRUE(std::any_of(cloth.arrays.begin(), cloth.arrays.end(), [&](const PointArray& a) { return a.name == name; })) << name;
}

// The folder is whole: the mesh is gone, the folder is elsewhere, and it is drawn, goes on and starts again all the same.
TEST_F(RunCommand, KeepsTheMeshesOfItsScene) {
  const fs::path from = folder_ / "from";
  fs::create_directories(from);
  for (const char* name : {"round_cloth.yaml", "round_cloth.obj", "pipe_on_hanging_cloth.yaml"})
    fs::copy_file(fs::path(IMBIBE_SOURCE_DIR) / "scenes/seed_b" / name, from / name);
  scene_ = (from / "round_cloth.yaml").string();
  run("out", "--until 0.02 --set output.every=0.01 --set picture.width=96 --set picture.height=64 --set picture.samples=1");
  EXPECT_EQ(text_of(folder_ / "out/scene.yaml").find(folder_.string()), std::string::npos);
  fs::remove_all(from);
  fs::rename(folder_ / "out", folder_ / "moved");
  const Outcome render = run_command("render " + in("moved") + " -o " + in("again"));
  EXPECT_EQ(render.code, 0) << render.output;
  EXPECT_EQ(text_of(folder_ / "moved/pictures/picture_000001.png"), text_of(folder_ / "again/pictures/picture_000001.png"));
  const Outcome resumed = run_command("run " + in("moved") + " --resume --until 0.03 --no-pictures");
  EXPECT_EQ(resumed.code, 0) << resumed.output;
  const std::string mesh = text_of(folder_ / "moved/files/round_cloth.obj");
  EXPECT_FALSE(mesh.empty());
  const Outcome anew = run_command("run " + in("moved/scene.yaml") + " --until 0.01 --no-pictures --overwrite -o " + in("moved"));
  EXPECT_EQ(anew.code, 0) << anew.output;
  EXPECT_EQ(text_of(folder_ / "moved/files/round_cloth.obj"), mesh);
}

TEST_F(RunCommand, KeepsTextilesApartWhoseNamesDifferOnlyInWhatAFileNameCannotCarry) {
  std::string text = scene_text();
  text.insert(text.find("output:"),
              "  - name: swa/tch\n"
              "    centre: [0, 0, -4 mm]\n"
              "    size: [5 mm, 5 mm]\n"
              "    warp: {fibre: cotton, linear_density: 20 tex, density: 30 /cm}\n"
              "    weft: {fibre: cotton, linear_density: 20 tex, density: 28 /cm}\n");
  text.replace(text.find("name: swatch"), 12, "name: swa.tch");
  scene_ = write("two.yaml", text);
  run("out", "--until 0.004");
  EXPECT_EQ(read_vtp(folder_ / "out" / "textile_swa_tch-2_000001.vtp").points.size() > 0, true);
  const Outcome render = run_command("render " + in("out") + " -o " + in("again"));
  EXPECT_EQ(render.code, 0) << render.output;
  EXPECT_EQ(text_of(folder_ / "out" / "pictures" / "picture_000002.png"), text_of(folder_ / "again" / "pictures" / "picture_000002.png"));
}

TEST(Commands, EveryShippedFabricHasItsNumbers) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(IMBIBE_SOURCE_DIR) / "fabrics")) {
    std::string command = "fabric " + entry.path().string();
    if (entry.path().filename() == "counterbalance_plain.wif") {  // a bare draft says what its yarns lack
      const Outcome bare = run_command(command);
      EXPECT_EQ(bare.code, 2);
      EXPECT_NE(bare.output.find("counterbalance_plain.wif: error: warp.density:"), std::string::npos) << bare.output;
      EXPECT_NE(bare.output.find("--set warp.density"), std::string::npos) << bare.output;
      for (const char* family : {"warp", "weft"}) command += std::string(" --set ") + family + "='{diameter: 0.2 mm, density: 24 /cm}'";
    }
    const Outcome outcome = run_command(command);
    EXPECT_EQ(outcome.code, 0) << entry.path() << outcome.output;
    EXPECT_NE(outcome.output.find("porosity"), std::string::npos) << entry.path() << outcome.output;
    ++count;
  }
  EXPECT_GT(count, 10);
}

TEST(Commands, TheSchemaOfScenesIsJson) {
  const Outcome outcome = run_command("params --schema");
  EXPECT_EQ(outcome.code, 0);
  const nlohmann::json schema = nlohmann::json::parse(outcome.output, nullptr, false);
  ASSERT_TRUE(schema.is_object());
  EXPECT_TRUE(schema["properties"].contains("textiles"));
  EXPECT_FALSE(nlohmann::json::parse(run_command("params --json").output, nullptr, false).is_discarded());
}

}  // namespace
