// What a check passes and fails, the observed order, and that a failing case stands in the report.
#include "imbibe/verify/report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "imbibe/core/error.h"
#include "imbibe/verify/runner.h"

namespace imbibe::verify {
namespace {

TEST(Check, ComparesWithItsToleranceAndFailsOnNotANumber) {
  EXPECT_TRUE(near("x", 1.01, 1, "m", 0.011, "").passed);
  EXPECT_FALSE(near("x", 1.02, 1, "m", 0.011, "").passed);
  EXPECT_TRUE(near("x", -0.99, -1, "m", 0.011, "").passed);
  EXPECT_TRUE(within("x", 64, 60, "deg", 5, "").passed);
  EXPECT_FALSE(within("x", 54, 60, "deg", 5, "").passed);
  EXPECT_TRUE(at_most("x", 1, 1, "", "").passed);
  EXPECT_FALSE(at_most("x", 1.1, 1, "", "").passed);
  EXPECT_FALSE(at_least("x", 0.9, 1, "", "").passed);
  const Real none = std::numeric_limits<Real>::quiet_NaN();
  for (const Check& c : {near("x", none, 1, "", 1, ""), within("x", none, 1, "", 1, ""), at_most("x", none, 1, "", ""),
                         at_least("x", none, 1, "", "")})
    EXPECT_FALSE(c.passed);
}

TEST(Convergence, FindsTheOrderOfAPowerLaw) {
  std::vector<Convergence::Row> rows;
  for (const Real h : {0.4, 0.2, 0.1, 0.05}) rows.push_back({h, -3 * std::pow(h, 1.7)});
  EXPECT_NEAR(convergence_of("e", "h", rows).order, 1.7, 1e-12);
}

TEST(Case, WithoutAnyCheckDoesNotPass) { EXPECT_FALSE(CaseResult{}.passed()); }

TEST(Report, ShowsAFailingCaseWithItsErrorAndSaysSoInBothFiles) {
  Case good, bad, broken;
  good.name = "good", bad.name = "bad", broken.name = "broken";
  good.title = good.family = "<Good>", bad.title = "Bad", broken.title = "Broken";
  Verification v;
  v.outcomes.resize(3);
  v.outcomes[0].of = &good, v.outcomes[0].result.checks = {near("x", 1, 1, "m", 0.1, "because")};
  EXPECT_TRUE(v.outcomes[0].passed());
  v.outcomes[1].of = &bad, v.outcomes[1].result.checks = {near("y", 2, 1, "m", 0.1, "because")};
  v.outcomes[2].of = &broken, v.outcomes[2].failure = "the disk is full";
  EXPECT_FALSE(v.passed());
  const std::string html = html_of(v), json = json_of(v);
  EXPECT_NE(html.find("1 of 3 cases passed; 2 failed"), std::string::npos);
  EXPECT_NE(html.find("+100 %"), std::string::npos);
  EXPECT_NE(html.find("the disk is full"), std::string::npos);
  EXPECT_EQ(html.find("<Good>"), std::string::npos) << "text is escaped";
  EXPECT_EQ(html.find("http://"), std::string::npos) << "nothing is fetched";
  EXPECT_NE(json.find("\"passed\": false"), std::string::npos);
  EXPECT_NE(json.find("the disk is full"), std::string::npos);
}

TEST(Cases, HaveDifferentNamesAndSayEverythingAReaderNeeds) {
  std::set<std::string> names;
  for (const Case& c : all_cases()) {
    EXPECT_TRUE(names.insert(c.name).second) << c.name;
    for (const std::string* text : {&c.family, &c.title, &c.computes, &c.formula, &c.source, &c.assumptions, &c.models})
      EXPECT_FALSE(text->empty()) << c.name;
    EXPECT_NE(c.run, nullptr) << c.name;
  }
}

TEST(Cases, AnUnknownNameSuggestsTheNearest) {
  try {
    chosen_cases({.names = {"jurim"}});
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean 'jurin'"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace imbibe::verify
