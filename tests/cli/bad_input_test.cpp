// The built command on bad input: message on stderr with file, line and column; exit code 2; nothing written.
#include <gtest/gtest.h>

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace {

namespace fs = std::filesystem;

struct Outcome {
  int code = -1;
  std::string output;  // of stdout and stderr
};

Outcome run_command(const std::string& arguments) {
  const std::string line = "IMBIBE_DATA_DIR='" IMBIBE_SOURCE_DIR "' '" IMBIBE_COMMAND "' " + arguments + " 2>&1";
  FILE* pipe = popen(line.c_str(), "r");
  Outcome outcome;
  std::array<char, 4096> buffer;
  while (const std::size_t n = fread(buffer.data(), 1, buffer.size(), pipe)) outcome.output.append(buffer.data(), n);
  const int status = pclose(pipe);
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

class BadInput : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "imbibe_cli_XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  void TearDown() override {
    fs::permissions(folder_, fs::perms::owner_all);
    fs::remove_all(folder_);
  }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return (folder_ / name).string();
  }
  fs::path folder_;
};

const char* const scene_text =
    "version: 1\n"
    "title: small\n"
    "duration: 1 ms\n"
    "liquid:\n"
    "  kind: water\n"
    "  particle_mass: 0.205 mg\n"
    "  drops:\n"
    "    - {centre: [0, 0, 5 mm], volume: 20 uL}\n"
    "textiles:\n"
    "  - name: swatch\n"
    "    size: [8 mm, 8 mm]\n"
    "    warp: {fibre: cotton, diameter: 0.4 mm, density: 10 /cm}\n"
    "    weft: {fibre: cotton, diameter: 0.4 mm, density: 10 /cm}\n";

TEST_F(BadInput, AGoodSceneChecksWithCodeZero) {
  const Outcome outcome = run_command("check " + write("scene.yaml", scene_text));
  EXPECT_EQ(outcome.code, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("porosity"), std::string::npos);
}

TEST_F(BadInput, AMissingFileIsCodeTwo) {
  for (const char* command : {"check ", "run ", "fabric "}) {
    const Outcome outcome = run_command(command + (folder_ / "nowhere.yaml").string());
    EXPECT_EQ(outcome.code, 2) << command << outcome.output;
    EXPECT_NE(outcome.output.find("nowhere.yaml"), std::string::npos) << outcome.output;
  }
}

TEST_F(BadInput, NotYamlIsCodeTwoWithThePlace) {
  const std::string file = write("scene.yaml", "version: 1\ntitle: [open\n");
  for (const char* command : {"check ", "run "}) {
    const Outcome outcome = run_command(command + file);
    EXPECT_EQ(outcome.code, 2) << outcome.output;
    EXPECT_NE(outcome.output.find(file + ":3:1: error:"), std::string::npos) << outcome.output;
  }
}

TEST_F(BadInput, EveryProblemOfAFileIsPrintedInOneGo) {
  std::string text = scene_text;
  text.replace(text.find("duration: 1 ms"), 14, "duration: 1 mm");
  text.replace(text.find("warp:"), 5, "wrap:");
  text += "limit: 3\n";
  const std::string file = write("scene.yaml", text);
  const Outcome outcome = run_command("run " + file + " -o " + (folder_ / "out").string());
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.output.find(file + ":3:11: error: duration: "), std::string::npos) << outcome.output;
  EXPECT_NE(outcome.output.find(file + ":12:5: error: textiles[0].wrap: unknown key; did you mean 'warp'?"),
            std::string::npos)
      << outcome.output;
  EXPECT_NE(outcome.output.find("did you mean 'limits'?"), std::string::npos) << outcome.output;
  EXPECT_FALSE(fs::exists(folder_ / "out")) << "nothing may be written for a scene that cannot run";
}

TEST_F(BadInput, AWrongOverrideIsCodeTwo) {
  const std::string file = write("scene.yaml", scene_text);
  const Outcome outcome = run_command("check " + file + " --set textiles[0].warp.densty=10");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.output.find("did you mean 'density'?"), std::string::npos) << outcome.output;
}

TEST_F(BadInput, AnOverrideChangesTheScene) {
  const std::string file = write("scene.yaml", scene_text);
  const Outcome outcome = run_command("check --resolved " + file + " --set textiles[0].warp.density='12 /cm'");
  EXPECT_EQ(outcome.code, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("density: 12 1/cm"), std::string::npos) << outcome.output;
}

TEST_F(BadInput, AResolvedSceneChecksAgainToItself) {
  const Outcome first = run_command("check --resolved " + write("scene.yaml", scene_text));
  ASSERT_EQ(first.code, 0) << first.output;
  const Outcome second = run_command("check --resolved " + write("resolved.yaml", first.output));
  EXPECT_EQ(second.code, 0);
  EXPECT_EQ(second.output, first.output);
}

TEST_F(BadInput, BadUsageIsCodeTwo) {
  for (const char* arguments : {"", "runn scene.yaml", "run", "check", "params --json --schema", "check a b c"})
    EXPECT_EQ(run_command(arguments).code, 2) << arguments;
}

TEST_F(BadInput, AnUnknownPartOfTheParametersIsCodeTwo) {
  EXPECT_EQ(run_command("params nothing_like_this").code, 2);
  const Outcome outcome = run_command("params humidity");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_NE(outcome.output.find("air.humidity"), std::string::npos);
}

TEST_F(BadInput, MoreParticlesThanTheMachineHoldsIsCodeTwoAtOnce) {
  std::string text = scene_text;
  text.replace(text.find("0.205 mg"), 8, "1e-15 kg");
  const Outcome outcome = run_command("run " + write("scene.yaml", text) + " -o " + (folder_ / "out").string());
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.output.find("particles"), std::string::npos) << outcome.output;
}

TEST_F(BadInput, AnOutputFolderThatCannotBeWrittenIsARunTimeFailureAtOnce) {
  const std::string file = write("scene.yaml", scene_text);
  write("taken", "a file, not a folder");
  const Outcome outcome = run_command("run " + file + " -o " + (folder_ / "taken" / "out").string());
  EXPECT_EQ(outcome.code, 1) << outcome.output;
  EXPECT_NE(outcome.output.find("cannot create the run folder"), std::string::npos) << outcome.output;
  EXPECT_NE(outcome.output.find("taken"), std::string::npos) << outcome.output;
}

}  // namespace
