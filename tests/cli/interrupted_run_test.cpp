// A run that is stopped, killed or cut short, and goes on: the same state, files and film as of one never stopped.
#include <gtest/gtest.h>

#include <algorithm>

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

TEST_F(InterruptedRun, SaysWhatIsMissingToResume) {
  EXPECT_EQ(run_command("run " + in("nowhere") + " --resume").code, 2);
  const Outcome bare = run_command("run " + scene_ + " --resume");
  EXPECT_EQ(bare.code, 2);
  EXPECT_NE(bare.output.find("folder"), std::string::npos) << bare.output;
  fs::create_directory(folder_ / "empty");
  EXPECT_EQ(run_command("run " + in("empty") + " --resume").code, 2);
}

}  // namespace
