// The installed command starts the build for newer processors that lies beside it.
#include "support/run_fixture.h"

namespace imbibe::test {
namespace {

class BestBuild : public CommandRun {
 protected:
  void SetUp() override {
    CommandRun::SetUp();
    std::filesystem::copy_file(IMBIBE_COMMAND, folder_ / "imbibe");
    write("imbibe-x86-64-v3", "#!/bin/sh\necho the better build: \"$@\"\n");
    std::filesystem::permissions(folder_ / "imbibe-x86-64-v3", std::filesystem::perms::owner_all);
  }
  Outcome version(const std::string& environment = "") {
    return run_line(environment + " '" + (folder_ / "imbibe").string() + "' --version again");
  }
};

bool has_level_3() {
  const std::string flags = text_of("/proc/cpuinfo");
  return flags.find(" avx2 ") != std::string::npos && flags.find(" bmi2 ") != std::string::npos &&
         flags.find(" fma ") != std::string::npos;
}

TEST_F(BestBuild, TakesOverWithTheSameWordsWhereTheProcessorCanRunIt) {
  const Outcome outcome = version();
  EXPECT_EQ(outcome.output.find("the better build: --version again") != std::string::npos, has_level_3())
      << outcome.output;
}

TEST_F(BestBuild, IsLeftAloneWhenTheOldestIsWanted) {
  EXPECT_EQ(version("IMBIBE_LEVEL=x86-64").output.find("better"), std::string::npos);
}

TEST_F(BestBuild, ThatCannotBeStartedIsPassedOver) {
  write("imbibe-x86-64-v3", "no program");
  std::filesystem::permissions(folder_ / "imbibe-x86-64-v3", std::filesystem::perms::owner_read);
  EXPECT_EQ(version().output, run_command("--version again").output);
}

}  // namespace
}  // namespace imbibe::test
