#include "imbibe/fabric/weave.h"

#include <numeric>

#include "fabric/support.h"

namespace imbibe {
namespace {

using Rows = std::vector<std::string>;
using test::contains;
using test::problems_of;

TEST(Weave, PlainAlternatesAndTakesNoNumbers) {
  EXPECT_EQ(weave_rows(parse_weave("plain")), (Rows{"10", "01"}));
  EXPECT_EQ(parse_weave(" Plain weave "), plain_weave());
  EXPECT_TRUE(contains(problems_of([] { parse_weave("plain 2/1"); }), "plain"));
}

TEST(Weave, ATwillsDiagonalClimbsToItsSide) {
  EXPECT_EQ(weave_rows(parse_weave("twill 2/1")), (Rows{"110", "011", "101"}));
  EXPECT_EQ(weave_rows(parse_weave("2/2 Twill left")), (Rows{"1100", "1001", "0011", "0110"}));
  EXPECT_EQ(weave_rows(parse_weave("twill 2 2 right")), (Rows{"1100", "0110", "0011", "1001"}));
  // The left twill is the right one seen in a mirror, up to where the repeat begins.
  const WeaveDraft right = twill_weave(3, 1), left = twill_weave(3, 1, TwillDirection::left);
  for (std::size_t p = 0; p < 4; ++p)
    for (std::size_t e = 0; e < 4; ++e) EXPECT_EQ(right.warp_on_face(p, e + p), left.warp_on_face(p, e + 4 - p));
}

TEST(Weave, ATwillMayHaveSeveralFloats) {
  EXPECT_EQ(parse_weave("twill 3/1/1/3").ends, 8);
  EXPECT_EQ(weave_rows(parse_weave("twill 3/1/1/3"))[0], "11101000");
}

TEST(Weave, ASatinInterlacesOncePerYarnAndNeverBesideANeighbour) {
  for (const auto& [ends, step] : std::vector<std::pair<int, int>>{{5, 2}, {5, 3}, {8, 3}, {8, 5}, {7, 4}, {12, 5}}) {
    const WeaveDraft satin = satin_weave(ends, step), sateen = sateen_weave(ends, step);
    const WeaveFacts facts = weave_facts(satin);
    EXPECT_EQ(facts.longest_warp_float, ends - 1);
    EXPECT_DOUBLE_EQ(facts.warp_face_share, 1 - 1.0 / ends);
    for (std::size_t k = 0; k < satin.warp_up.size(); ++k) EXPECT_NE(satin.warp_up[k], sateen.warp_up[k]);
    const std::size_t n = static_cast<std::size_t>(ends);
    for (std::size_t p = 0; p < n; ++p)
      for (std::size_t e = 0; e < n; ++e)
        EXPECT_FALSE(sateen.warp_on_face(p, e) &&
                     (sateen.warp_on_face(p + 1, e + 1) || sateen.warp_on_face(p + 1, e + n - 1))) << ends << "/" << step;
  }
}

TEST(Weave, AnIllegalSatinStepIsRefusedExactlyWhenTheRuleSaysSo) {
  for (int ends = 2; ends <= 16; ++ends)
    for (int step = -1; step <= ends + 1; ++step) {
      const bool legal = ends >= 5 && step > 1 && step < ends - 1 && std::gcd(step, ends) == 1;
      EXPECT_EQ(problems_of([&] { satin_weave(ends, step); }).empty(), legal) << ends << "/" << step;
    }
  EXPECT_TRUE(contains(problems_of([] { parse_weave("satin 8/2"); }), "legal: 3, 5"));
  EXPECT_TRUE(contains(problems_of([] { parse_weave("satin 6/2"); }), "does not exist"));
}

TEST(Weave, ABasketIsPlainWeaveOfGroups) {
  EXPECT_EQ(weave_rows(parse_weave("basket 2/2")), (Rows{"1100", "1100", "0011", "0011"}));
  EXPECT_EQ(parse_weave("basket 2"), basket_weave(2, 2));
  EXPECT_EQ(weave_rows(parse_weave("basket 2/1")), (Rows{"1100", "0011"}));
  EXPECT_EQ(basket_weave(1, 1), plain_weave());
}

TEST(Weave, FreeRowsAreReadAsWritten) {
  EXPECT_EQ(parse_weave("10 01"), plain_weave());
  EXPECT_EQ(weave_rows(parse_weave("110/011\n101")), (Rows{"110", "011", "101"}));
  const Rows rows{"10110", "01001"};
  EXPECT_EQ(weave_rows(weave_from_rows(rows)), rows);
}

TEST(Weave, EmptyRaggedAndForeignRowsAreAllReported) {
  EXPECT_TRUE(contains(problems_of([] { weave_from_rows({}); }), "empty"));
  EXPECT_TRUE(contains(problems_of([] { weave_from_rows({"", ""}); }), "empty"));
  EXPECT_TRUE(contains(problems_of([] { parse_weave("  "); }), "empty"));
  const std::string text = problems_of([] { weave_from_rows({"10", "011", "0x", "1"}); });
  EXPECT_TRUE(contains(text, "row 2 has 3 ends, row 1 has 2")) << text;
  EXPECT_TRUE(contains(text, "'x' is neither 0 nor 1")) << text;
  EXPECT_TRUE(contains(text, "row 4 has 1 ends")) << text;
}

TEST(Weave, AMisspeltWeaveNamesTheNearest) {
  EXPECT_TRUE(contains(problems_of([] { parse_weave("twil 2/1"); }), "did you mean 'twill'?"));
  EXPECT_TRUE(contains(problems_of([] { parse_weave("2/1"); }), "names no weave"));
  EXPECT_TRUE(contains(problems_of([] { parse_weave("twill 2"); }), "pairs"));
  EXPECT_TRUE(contains(problems_of([] { parse_weave("twill 2/0"); }), "1 or more"));
  EXPECT_TRUE(contains(problems_of([] { parse_weave("satin 5/2 left"); }), "only a twill"));
  EXPECT_TRUE(contains(problems_of([] { parse_weave("basket 0"); }), "1 or more"));
  EXPECT_TRUE(contains(problems_of([] { parse_weave("twill 99999999999/1"); }), "too large"));
  EXPECT_TRUE(contains(problems_of([] { parse_weave("twill 16000/16000"); }), "larger"));
  EXPECT_TRUE(contains(problems_of([] { parse_weave("twill 2/1 & more"); }), "unexpected '&'"));
}

TEST(Weave, FactsTellFloatsAndLooseYarns) {
  const WeaveFacts plain = weave_facts(plain_weave());
  EXPECT_DOUBLE_EQ(plain.warp_interlacing, 1);
  EXPECT_EQ(plain.longest_weft_float, 1);
  const WeaveFacts loose = weave_facts(weave_from_rows({"110", "100"}));
  EXPECT_EQ(loose.loose_ends, (std::vector<int>{0, 2}));
  EXPECT_TRUE(loose.loose_picks.empty());
  EXPECT_EQ(weave_facts(twill_weave(3, 1)).longest_warp_float, 3);
}

}  // namespace
}  // namespace imbibe
