#include "imbibe/core/error.h"

#include <gtest/gtest.h>

#include <string>

namespace imbibe {
namespace {

TEST(Problem, ItsTextGivesPlaceKeyAndMessageAndLeavesOutWhatIsNotKnown) {
  EXPECT_EQ((Problem{"a.yaml", 3, 7, "warp.radius", "too thin"}.text()), "a.yaml:3:7: error: warp.radius: too thin");
  EXPECT_EQ((Problem{"a.yaml", 0, 0, "", "is missing"}.text()), "a.yaml: error: is missing");
  EXPECT_EQ((Problem{"", 0, 0, "", "no memory"}.text()), "error: no memory");
}

TEST(InputError, CarriesEveryProblemOneALine) {
  const InputError error({Problem{"a", 1, 1, "x", "one"}, Problem{"a", 2, 1, "y", "two"}});
  EXPECT_EQ(error.problems().size(), 2u);
  EXPECT_EQ(std::string(error.what()), "a:1:1: error: x: one\na:2:1: error: y: two");
}

TEST(NumericalError, SaysWhenInWhichStageAndWhere) {
  const NumericalError error(0.25, 42, "pressure", "particle 7");
  const std::string text = error.what();
  for (const char* part : {"0.25", "42", "pressure", "particle 7"}) EXPECT_NE(text.find(part), std::string::npos) << part;
}

TEST(Assertion, ThrowsInEveryBuildAndQuotesTheCondition) {
  EXPECT_NO_THROW(IMBIBE_ASSERT(1 + 1 == 2));
  try {
    IMBIBE_ASSERT(1 + 1 == 3);
    FAIL();
  } catch (const std::logic_error& error) {
    EXPECT_NE(std::string(error.what()).find("1 + 1 == 3"), std::string::npos);
  }
}

TEST(NearestWord, IsTheOneWithTheFewestEdits) {
  const std::vector<std::string> known{"diameter", "density", "fibre", "packing"};
  EXPECT_EQ(nearest_word("diametre", known), "diameter");
  EXPECT_EQ(nearest_word("densty", known), "density");
  EXPECT_EQ(nearest_word("fiber", known), "fibre");
  EXPECT_EQ(nearest_word("packing", known), "packing");
}

TEST(NearestWord, IsNoneWhenNothingIsNearEnoughToBeMeant) {
  EXPECT_EQ(nearest_word("zzzzzzzz", {"diameter", "density"}), "");
  EXPECT_EQ(nearest_word("x", {}), "");
}

}  // namespace
}  // namespace imbibe
