// `imbibe verify --quick`: every case runs through its scene file, and the command's exit code says what the report says.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "io/temporary_folder.h"
#include "support/command.h"

namespace {

namespace fs = std::filesystem;
using namespace imbibe::test;

// Cases that are outside their tolerance in the quick form, with the cause. The test goes red when one is mended as well:
// then its line here goes.
const std::set<std::string> known_to_fail = {
};

TEST(VerifyCommand, QuickFormPassesAllCasesButThoseKnownToFail) {
  const imbibe::testing::TemporaryFolder folder;
  const Outcome outcome = run_command("verify --quick --no-pictures -o '" + (folder.path() / "v").string() + "'");
  const auto report = nlohmann::json::parse(text_of(folder.path() / "v" / "verify.json"));
  std::set<std::string> failed;
  for (const auto& one : report["cases"]) {
    if (!one["passed"]) failed.insert(one["name"]);
  }
  EXPECT_EQ(failed, known_to_fail) << outcome.output;
  EXPECT_EQ(outcome.code, failed.empty() ? 0 : 1);
  EXPECT_GT(fs::file_size(folder.path() / "v" / "verify.html"), 10000u);
}

TEST(VerifyCommand, RefusesAnUnknownCase) {
  const Outcome outcome = run_command("verify jurim");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.output.find("did you mean 'jurin'"), std::string::npos) << outcome.output;
}

}  // namespace
