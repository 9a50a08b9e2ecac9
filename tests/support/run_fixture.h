// A scratch folder with a small scene, for tests that run the built command: 3 uL on 9 x 9 mm, a second at most.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <string>

#include "imbibe/io/series.h"
#include "support/command.h"

namespace imbibe::test {

class CommandRun : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (std::filesystem::temp_directory_path() / "imbibe_run_XXXXXX").string();
    folder_ = mkdtemp(name.data());
    scene_ = write("small.yaml", scene_text());
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  static std::string scene_text() {
    return "version: 1\n"
           "title: small drop\n"
           "duration: 20 ms\n"
           "liquid:\n"
           "  kind: water\n"
           "  particle_mass: 0.016 mg\n"
           "  drops:\n"
           "    - {centre: [0 mm, 0 mm, 1.2 mm], volume: 3 uL, velocity: [0, 0, -0.1 m/s]}\n"
           "textiles:\n"
           "  - name: swatch\n"
           "    size: [9 mm, 9 mm]\n"
           "    warp: {fibre: cotton, linear_density: 20 tex, density: 30 /cm}\n"
           "    weft: {fibre: cotton, linear_density: 20 tex, density: 28 /cm}\n"
           "output: {every: 2 ms}\n"
           "picture: {width: 96, height: 64, samples: 1}\n";
  }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return (folder_ / name).string();
  }
  std::string in(const std::string& name) const { return (folder_ / name).string(); }

  // Runs the small scene into folder `out`; must end with `code`.
  std::string run(const std::string& out, const std::string& options = "", int code = 0,
                  const std::string& before = "") const {
    const Outcome outcome = run_command("run " + scene_ + " -o " + in(out) + " " + options, before);
    EXPECT_EQ(outcome.code, code) << outcome.output;
    return outcome.output;
  }
  nlohmann::json run_json(const std::string& out) const {
    return nlohmann::json::parse(text_of(folder_ / out / "run.json"));
  }
  std::string hash(const std::string& out) const { return run_json(out)["state_hash"]; }

  std::filesystem::path folder_;
  std::string scene_;
};

}  // namespace imbibe::test
