// `imbibe verify --quick`: every case runs through its scene file, and the command's exit code says what the report says.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "io/temporary_folder.h"
#include "support/command.h"

namespace {

namespace fs = std::filesystem;
using namespace imbibe::test;

// Cases whose goals the free liquid does not reach yet, at any rate in the quick form (docs/accuracy.md): they must run
// to their end and may fail. All others must pass.
const std::set<std::string> open_goals = {
    "taylor-green-pressed", "poiseuille", "couette",     "static-drop",       "rayleigh",  "sessile",
    "sessile-gravity", "hysteresis",        "incline",    "coalescence", "slot", "uptake-resolution", "stain-area",
    "drop-on-ball",    "drop-on-cone",      "drop-on-weave",
};

TEST(VerifyCommand, QuickFormRunsAllCasesAndAllButTheOpenGoalsPass) {
  const imbibe::testing::TemporaryFolder folder;
  const Outcome outcome = run_command("verify --quick --no-pictures -o '" + (folder.path() / "v").string() + "'");
  const auto report = nlohmann::json::parse(text_of(folder.path() / "v" / "verify.json"));
  bool all_passed = true;
  for (const auto& one : report["cases"]) {
    const std::string name = one["name"];
    all_passed = all_passed && one["passed"];
    EXPECT_FALSE(one.contains("failure")) << name << ": " << one["failure"];
    EXPECT_FALSE(one["checks"].empty()) << name;
    if (!open_goals.contains(name)) {
      EXPECT_TRUE(one["passed"]) << name << "\n" << outcome.output;
    }
  }
  EXPECT_EQ(report["passed"], all_passed);
  EXPECT_EQ(outcome.code, all_passed ? 0 : 1) << outcome.output;
  EXPECT_GT(fs::file_size(folder.path() / "v" / "verify.html"), 10000u);
}

TEST(VerifyCommand, MakesOnePictureAndSaysHowToRunACaseByHand) {
  const imbibe::testing::TemporaryFolder folder;
  const Outcome outcome = run_command("verify sorptivity --quick -o '" + (folder.path() / "v").string() + "'");
  EXPECT_EQ(outcome.code, 0) << outcome.output;
  EXPECT_GT(fs::file_size(folder.path() / "v" / "pictures" / "sorptivity.png"), 5000u);
  const std::string html = text_of(folder.path() / "v" / "verify.html");
  EXPECT_NE(html.find("data:image/png;base64,"), std::string::npos);
  EXPECT_NE(html.find("imbibe run scenes/verify/yarn.yaml --set"), std::string::npos);
}

TEST(VerifyCommand, RefusesAnUnknownCase) {
  const Outcome outcome = run_command("verify jurim");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.output.find("did you mean 'jurin'"), std::string::npos) << outcome.output;
}

// The pages that tools/theory_pages makes of docs/verification.json and of the models' headers.
TEST(Docs, VerificationAndTheoryPagesAreCurrent) {
  FILE* pipe = popen("/usr/bin/python3 '" IMBIBE_SOURCE_DIR "/tools/theory_pages' --check 2>&1", "r");
  std::string said;
  char buffer[4096];
  while (const std::size_t n = fread(buffer, 1, sizeof buffer, pipe)) said.append(buffer, n);
  EXPECT_EQ(pclose(pipe), 0) << said << "run tools/theory_pages";
}

}  // namespace
