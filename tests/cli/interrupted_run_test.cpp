// A run that is stopped, killed or cut short, and goes on: the same state, files and film as of one never stopped.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "imbibe/core/random.h"
#include "support/run_fixture.h"

namespace {

namespace fs = std::filesystem;
using namespace imbibe;
using namespace imbibe::test;

class InterruptedRun : public CommandRun {
 protected:
  // Complete rows of a series that grows.
  int rows(const std::string& out) const {
    const std::string text = text_of(folder_ / out / "series.csv");
    return static_cast<int>(std::count(text.begin(), text.end(), '\n')) - 1;
  }
  // Starts a long run and sends the signal once `least` rows are written.
  int signalled(const std::string& out, int signal_number, int least, std::vector<std::string> options = {}) const {
    std::vector<std::string> words{"run", scene_, "-o", in(out), "--set", "duration=100 ms"};
    words.insert(words.end(), options.begin(), options.end());
    return signalled_command(words, signal_number, [&] { return rows(out) >= least; });
  }
  std::string checkpoint_in(const std::string& out) const {
    for (const auto& entry : fs::directory_iterator(folder_ / out))
      if (entry.path().extension() == ".h5") return entry.path().filename().string();
    return "";
  }
  void resume(const std::string& out, const std::string& options = "") const {
    const Outcome outcome = run_command("run " + in(out) + " --resume " + options);
    EXPECT_EQ(outcome.code, 0) << outcome.output;
  }
  // All files but checkpoints, times and machine words are the same bytes.
  void expect_same_files(const std::string& a, const std::string& b) const {
    int compared = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / a)) {
      const fs::path name = fs::relative(entry.path(), folder_ / a), extension = name.extension();
      if (extension != ".csv" && extension != ".vtp" && extension != ".pvd" && extension != ".png" && extension != ".mp4") continue;
      EXPECT_TRUE(text_of(entry.path()) == text_of(folder_ / b / name)) << name << " differs";
      ++compared;
    }
    EXPECT_GT(compared, 100);
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / b)) {
      const fs::path name = fs::relative(entry.path(), folder_ / b);
      EXPECT_TRUE(name.extension() == ".h5" || fs::exists(folder_ / a / name)) << name << " is left over";
    }
  }
};

TEST_F(InterruptedRun, StopsOnCtrlCWithACheckpointAndResumesToTheVeryFilesOfAnUnbrokenRun) {
  run("whole", "--set duration='100 ms'");
  EXPECT_EQ(signalled("broken", SIGINT, 3), 130);
  EXPECT_NE(checkpoint_in("broken"), "");
  EXPECT_EQ(run_json("broken")["status"], "interrupted");
  EXPECT_TRUE(fs::exists(folder_ / "broken" / "film.mp4")) << "what there is makes a film";
  EXPECT_TRUE(fs::exists(folder_ / "broken" / "report.html"));
  resume("broken");
  EXPECT_EQ(run_json("broken")["status"], "done");
  EXPECT_EQ(hash("broken"), hash("whole"));
  expect_same_files("whole", "broken");
}

TEST_F(InterruptedRun, TakesATerminationLikeCtrlC) {
  EXPECT_EQ(signalled("broken", SIGTERM, 2, {"--no-pictures"}), 130);
  EXPECT_NE(checkpoint_in("broken"), "");
}

TEST_F(InterruptedRun, SurvivesAKillAtAnyMoment) {
  const std::string often = " --set output.checkpoint_every=0.01";
  run("whole", "--set duration='100 ms'" + often);
  for (const int least : {0, 1, 4, 9, 23}) {
    const std::string out = "killed_" + std::to_string(least);
    EXPECT_EQ(signalled(out, SIGKILL, least, {"--set", "output.checkpoint_every=0.01"}), -1);
    if (!fs::exists(folder_ / out / "run.json")) continue;  // killed before there was a run
    EXPECT_EQ(run_json(out)["status"], "running") << "whole, though the run was killed";
    resume(out);
    EXPECT_EQ(hash(out), hash("whole")) << out;
    expect_same_files("whole", out);
  }
}

TEST_F(InterruptedRun, StartsFromTheBeginningWhenItWasKilledBeforeTheFirstCheckpoint) {
  EXPECT_EQ(signalled("killed", SIGKILL, 2), -1);  // a checkpoint a minute by default
  ASSERT_EQ(checkpoint_in("killed"), "");
  resume("killed");
  run("whole", "--set duration='100 ms'");
  EXPECT_EQ(hash("killed"), hash("whole"));
  expect_same_files("whole", "killed");
}

TEST_F(InterruptedRun, PassesOverADamagedCheckpoint) {
  run("out", "--no-pictures --until 0.004");
  const fs::path good = folder_ / "out" / checkpoint_in("out");
  write("out/checkpoint_000099999.h5", text_of(good).substr(0, 5000));
  const Outcome outcome = run_command("run " + in("out") + " --resume --no-pictures --until 0.008");
  EXPECT_EQ(outcome.code, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("passed over"), std::string::npos) << outcome.output;
  run("whole", "--no-pictures --until 0.008");
  EXPECT_EQ(hash("out"), hash("whole"));
}

TEST_F(InterruptedRun, GoesOnBeyondItsEndWithALaterOne) {
  run("out", "--until 0.008");
  resume("out", "--until 0.02");
  run("whole");
  EXPECT_EQ(hash("out"), hash("whole"));
  EXPECT_EQ(text_of(folder_ / "out" / "series.csv"), text_of(folder_ / "whole" / "series.csv"));
  EXPECT_EQ(text_of(folder_ / "out" / "film.mp4"), text_of(folder_ / "whole" / "film.mp4"));
}

// A run of a few tenths of a second that is killed again and again at random moments, some of them before it has a
// folder or while it resumes, and goes on after every kill. IMBIBE_KILLS sets how many (nightly: 200).
TEST_F(InterruptedRun, KilledAtRandomMomentsItEndsInTheSameState) {
  const char* wanted = std::getenv("IMBIBE_KILLS");
  const int kills = wanted ? std::atoi(wanted) : 50;
  const std::vector<std::string> options{"--no-pictures", "--threads", "1", "--set", "output.checkpoint_every=0.005"};
  const auto start = std::chrono::steady_clock::now();
  run("whole", "--no-pictures --threads 1 --set output.checkpoint_every=0.005");
  const double whole_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  // Only kills that hit count; where the machine is so fast now that few do, the test ends all the same.
  int killed = 0, resumed = 0;
  for (int round = 0, made = 0; killed < kills && made < 4 * kills; ++round) {
    const std::string out = "killed_" + std::to_string(round);
    // Each round kills one run up to four times, then lets it end.
    for (int k = 0; k < 4 && killed < kills; ++k) {
      const bool goes_on = fs::exists(folder_ / out / "scene.yaml");
      std::vector<std::string> words{"run", goes_on ? in(out) : scene_, goes_on ? "--resume" : "--no-pictures"};
      if (!goes_on) words.insert(words.end(), {"-o", in(out)});
      words.insert(words.end(), options.begin() + (goes_on ? 0 : 1), options.end());
      const double after_s = uniform({.seed = 7, .id = static_cast<std::uint64_t>(made)}) * whole_s;
      const auto begun = std::chrono::steady_clock::now();
      const int code = signalled_command(words, SIGKILL, [&] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count() > after_s;
      });
      ++made;
      killed += code == -1;
      resumed += code == -1 && goes_on;
      ASSERT_TRUE(code == -1 || code == 0) << "kill " << made << " ended with " << code;
    }
    if (fs::exists(folder_ / out / "scene.yaml")) resume(out, "--no-pictures");
    else run(out, "--no-pictures");
    ASSERT_EQ(run_json(out)["status"], "done") << out;
    ASSERT_EQ(hash(out), hash("whole")) << out;
    ASSERT_EQ(text_of(folder_ / out / "series.csv"), text_of(folder_ / "whole" / "series.csv")) << out;
    for (const auto& entry : fs::directory_iterator(folder_ / out))
      ASSERT_NE(entry.path().extension(), ".part") << entry.path();
    fs::remove_all(folder_ / out);
  }
  EXPECT_GT(killed, 0);
  EXPECT_GT(resumed, 0) << "a run that had been killed before was killed again";
}

TEST_F(InterruptedRun, GoesOnOrStartsAgainWhenItWasKilledBeforeItsFirstRunJson) {
  run("whole", "--no-pictures");
  fs::create_directory(folder_ / "unborn");
  fs::copy(folder_ / "whole" / "scene.yaml", folder_ / "unborn" / "scene.yaml");
  write("unborn/run.json.part", "{");
  resume("unborn", "--no-pictures");
  EXPECT_EQ(hash("unborn"), hash("whole"));
  EXPECT_FALSE(fs::exists(folder_ / "unborn" / "run.json.part"));

  fs::create_directory(folder_ / "replaced");
  fs::copy(folder_ / "whole" / "scene.yaml", folder_ / "replaced" / "scene.yaml");
  run("replaced", "--no-pictures --overwrite");
  EXPECT_EQ(hash("replaced"), hash("whole"));

  fs::create_directory(folder_ / "nothing");
  write("nothing/scene.yaml.part", "version");
  const Outcome refused = run_command("run " + in("nothing") + " --resume");
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.output.find("start it with run SCENE -o"), std::string::npos) << refused.output;
  run("nothing", "--no-pictures");
  EXPECT_EQ(hash("nothing"), hash("whole"));
}

TEST_F(InterruptedRun, NeverReplacesAUsersOwnSceneThatLiesInTheFolder) {
  fs::create_directory(folder_ / "mine");
  write("mine/scene.yaml", scene_text());
  for (const char* option : {"--overwrite", "--resume"}) run("mine", option, 2);
  EXPECT_EQ(text_of(folder_ / "mine" / "scene.yaml"), scene_text());
}

// The second drop is too fast for any step: the run ends with code 3 and keeps the state before it.
TEST_F(InterruptedRun, ABlowUpLeavesTheLastGoodStateAndGoesOnFromItWithBetterNumbers) {
  scene_ = write("blow_up.yaml", "version: 1\n"
                 "duration: 4 us\n"
                 "liquid:\n"
                 "  kind: water\n"
                 "  particle_mass: 1e-15 kg\n"
                 "  drops:\n"
                 "    - {centre: [0 mm, 0 mm, 0 mm], volume: 3e-16 m3}\n"
                 "    - {centre: [0.1 mm, 0 mm, 0 mm], volume: 1e-16 m3, velocity: [100 m/s, 0, 0], start: 2 us}\n"
                 "  solver: {convective_factor: 0.004}\n"
                 "output: {every: 1 us, pictures: false}\n");
  const std::string said = run("out", "", 3);
  EXPECT_NE(said.find("error: numerical failure at t = 2e-06 s, step "), std::string::npos) << said;
  EXPECT_NE(said.find("the step fell to 4e-11 s by the bound 'convective'"), std::string::npos) << said;
  EXPECT_NE(said.find("is kept as a checkpoint"), std::string::npos) << said;
  run("until_then", "--until 2e-6");
  EXPECT_EQ(hash("out"), hash("until_then")) << "the state before the step that failed";
  EXPECT_EQ(checkpoint_in("out"), checkpoint_in("until_then"));
  const Outcome resumed = run_command("run " + in("out") + " --resume --set liquid.solver.convective_factor=0.4");
  EXPECT_EQ(resumed.code, 0) << resumed.output;
  EXPECT_NE(resumed.output.find("t = 2e-06 s"), std::string::npos) << resumed.output;
}

TEST_F(InterruptedRun, SaysWhatIsMissingToResume) {
  EXPECT_EQ(run_command("run " + in("nowhere") + " --resume").code, 2);
  const Outcome bare = run_command("run " + scene_ + " --resume");
  EXPECT_EQ(bare.code, 2);
  EXPECT_NE(bare.output.find("folder"), std::string::npos) << bare.output;
  fs::create_directory(folder_ / "empty");
  EXPECT_EQ(run_command("run " + in("empty") + " --resume").code, 2);
}

}  // namespace
