// The built command on bad input: message on stderr with file, line and column; exit code 2; nothing written.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "support/command.h"

namespace {

// kB: a reader that went on for ever would end in std::bad_alloc. The address sanitizer needs 16 TB of addresses itself.
#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define IMBIBE_ADDRESS_SANITIZER
#endif
#endif
#ifdef IMBIBE_ADDRESS_SANITIZER
constexpr const char* bounded_memory = "";
#else
constexpr const char* bounded_memory = "ulimit -v 4000000;";
#endif

namespace fs = std::filesystem;
using imbibe::test::Outcome;
using imbibe::test::run_command;

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

TEST_F(BadInput, TextThatIsNotUtf8IsRefusedWithItsPlace) {
  std::string text = scene_text;
  text.replace(text.find("small"), 5, "t\xE9te");  // Latin-1
  const std::string file = write("scene.yaml", text);
  const Outcome outcome = run_command("check " + file);
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.output.find(file + ":2:9: error: byte 0xE9 is not UTF-8"), std::string::npos) << outcome.output;
  text.replace(text.find("t\xE9te"), 4, "t\xC3\xAAte");
  EXPECT_EQ(run_command("check " + write("utf8.yaml", text)).code, 0);
}

TEST_F(BadInput, ADropFartherAwayThanSinglePrecisionPlacesItIsRefused) {
  std::string text = scene_text;
  text.replace(text.find("[0, 0, 5 mm]"), 12, "[0, 0, 1e300]");
  const Outcome outcome = run_command("check " + write("scene.yaml", text));
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.output.find(":8:23: error: liquid.drops[0].centre[2]: 1e300 is outside"), std::string::npos)
      << outcome.output;
}

TEST_F(BadInput, ANameTooLongForAFileNameIsRefusedBeforeTheRun) {
  std::string text = scene_text;
  text.replace(text.find("swatch"), 6, std::string(300, 'x'));
  const Outcome outcome = run_command("check " + write("scene.yaml", text));
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.output.find("textiles[0].name: is longer than"), std::string::npos) << outcome.output;
}

TEST_F(BadInput, ALiquidWithoutViscosityIsRefusedAtItsOwnKey) {
  const Outcome outcome = run_command("check " + write("scene.yaml", scene_text) + " --set liquid.kind.viscosity=0");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.output.find("error: liquid.kind"), std::string::npos) << outcome.output;
}

TEST_F(BadInput, OnlyTheDropsThatFallBeforeTheEndCountAgainstTheLimitOfParticles) {
  std::string text = scene_text;
  const std::string drops = "  drops:\n    - {centre: [0, 0, 5 mm], volume: 20 uL}\n";
  text.replace(text.find(drops), drops.size(),
               "  droppers:\n    - {centre: [0, 0, 5 mm], volume: 20 uL, interval: 1 s, count: 1000000}\n");
  EXPECT_EQ(run_command("check " + write("one.yaml", text)).code, 0) << "one drop falls in 1 ms";
  const Outcome outcome = run_command("check " + write("many.yaml", text) + " --set duration='1e6 s' --set limits.max_disk='1e9 GB'");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.output.find("more than limits.max_particles"), std::string::npos) << outcome.output;
}

TEST_F(BadInput, FilesThatAreNoScenesAreRefusedWhateverTheyHold) {
  const std::string deep(100000, '['), keys(20000, '{');
  const std::string contents[] = {"", "\n\n", "hello", "- a\n", deep, keys, std::string(1000, '\0'), "a: *b\n", "\xFF\xFE\x00",
                                  "version: 1\n\tduration: 1\n", "a: &a [*a]\n", "%YAML 9.9\n---\n{}\n"};
  for (const std::string& content : contents) {
    const std::string file = write("no_scene.yaml", content);
    for (const char* command : {"check ", "fabric ", "run "}) {
      const Outcome outcome = run_command(command + file, bounded_memory);
      EXPECT_EQ(outcome.code, 2) << command << content.substr(0, 20) << outcome.output.substr(0, 500);
      EXPECT_NE(outcome.output.find(file), std::string::npos) << outcome.output.substr(0, 500);
    }
  }
  for (const char* device : {"/dev/zero", "/dev/null", "/"})
    EXPECT_EQ(run_command(std::string("check ") + device, bounded_memory).code, 2) << device;
}

TEST_F(BadInput, FilesWithoutAnEndAreRefusedByTheirSize) {
  const std::string scene = write("endless.yaml", std::string(scene_text) + "solids:\n  - {shape: {kind: mesh, file: /dev/zero}}\n");
  for (const std::string& arguments : {std::string("check ") + scene, std::string("check /dev/zero"),
                                       std::string("fabric /dev/zero")}) {
    const Outcome outcome = run_command(arguments, bounded_memory);
    EXPECT_EQ(outcome.code, 2) << arguments << outcome.output;
  }
}

}  // namespace
