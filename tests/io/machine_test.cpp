#include "imbibe/io/machine.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <vector>

namespace imbibe {
namespace {

TEST(Machine, MemoryInUseGrowsByWhatIsFilled) {
  const double before = memory_in_use();
  EXPECT_GT(before, 1e6);
  const std::vector<char> filled(64 << 20, 1);
  // The allocator may have had some of it in hand; half is far above that.
  EXPECT_GT(memory_in_use() - before, 0.5 * static_cast<double>(filled.size()));
}

TEST(Machine, FreeSpaceOfAFolderThatIsYetToBeMadeIsThatOfTheOneAbove) {
  const auto folder = std::filesystem::temp_directory_path();
  const double there = free_space(folder), below = free_space(folder / "not" / "made" / "yet");
  EXPECT_GT(there, 0);
  ASSERT_TRUE(std::isfinite(there));
  EXPECT_NEAR(below, there, 0.05 * there);  // others write meanwhile
}

}  // namespace
}  // namespace imbibe
