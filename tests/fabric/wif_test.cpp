#include "imbibe/fabric/wif.h"

#include <algorithm>
#include <fstream>

#include "fabric/support.h"

namespace imbibe {
namespace {

using Rows = std::vector<std::string>;
using test::contains;
using test::problem_count;
using test::problems_of;

const std::string head = "[WIF]\nVersion=1.1\nDate=April 20, 1997\nDevelopers=x\nSource Program=test\n";
const std::string loom = "[WEAVING]\nShafts=4\nTreadles=4\nRising Shed=true\n[WARP]\nThreads=4\n[WEFT]\nThreads=4\n";
const std::string straight = "[THREADING]\n1=1\n2=2\n3=3\n4=4\n";
const std::string tied = "[TIEUP]\n1=1,2\n2=2,3\n3=3,4\n4=1,4\n[TREADLING]\n1=1\n2=2\n3=3\n4=4\n";
const Rows twill{"1100", "0110", "0011", "1001"};

WifFile parse(const std::string& text) { return parse_wif(text, "t.wif"); }
std::string errors(const std::string& text) { return problems_of([&] { parse(text); }); }
std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(Wif, ThreadingTieupAndTreadlingDrawDownToTheWeave) {
  const WifFile wif = parse(head + loom + straight + tied);
  EXPECT_EQ(weave_rows(wif.draft), twill);
  EXPECT_FALSE(wif.from_liftplan);
}

TEST(Wif, ALiftplanGivesTheSameDraftAndWinsOverTreadling) {
  const std::string lift = "[LIFTPLAN]\n1=1,2\n2=2,3\n3=3,4\n4=1,4\n";
  EXPECT_EQ(weave_rows(parse(head + loom + straight + lift).draft), twill);
  const std::string plain = "[LIFTPLAN]\n1=1,3\n2=2,4\n3=1,3\n4=2,4\n";
  const WifFile both = parse(head + loom + straight + tied + plain);
  EXPECT_EQ(weave_rows(both.draft), (Rows{"1010", "0101", "1010", "0101"}));
  EXPECT_TRUE(both.from_liftplan);
}

TEST(Wif, ASinkingShedTurnsTheClothOver) {
  const WifFile sinking = parse(replaced(head + loom + straight + tied, "Rising Shed=true", "Rising Shed=off"));
  for (std::size_t p = 0; p < 4; ++p)
    for (std::size_t e = 0; e < 4; ++e) EXPECT_EQ(sinking.draft.warp_on_face(p, e), twill[p][e] == '0');
}

TEST(Wif, NamesAreReadInAnyCaseAndOrderWithAnyLineEnd) {
  std::string text = head + tied + straight + loom;
  for (const char* name : {"TREADLING", "THREADING", "WEAVING", "TIEUP"}) {
    std::string other = name;
    std::transform(other.begin(), other.end(), other.begin(), [](unsigned char c) { return std::tolower(c); });
    text = replaced(text, std::string("[") + name, "[" + other);
  }
  text = replaced(text, "Threads=4", "tHREADS = 4 ; ends");
  std::string dos;
  for (char c : text) dos += c == '\n' ? "\r\n" : std::string(1, c);
  EXPECT_EQ(weave_rows(parse("\xEF\xBB\xBF" + dos).draft), twill);
}

TEST(Wif, EveryWordForABooleanIsKnown) {
  for (const char* word : {"true", "on", "yes", "1", "TRUE", "On"})
    EXPECT_TRUE(parse(replaced(head + loom + straight + tied, "Shed=true", std::string("Shed=") + word)).rising_shed) << word;
  for (const char* word : {"false", "off", "no", "0", "FALSE"})
    EXPECT_FALSE(parse(replaced(head + loom + straight + tied, "Shed=true", std::string("Shed=") + word)).rising_shed) << word;
  EXPECT_TRUE(contains(errors(replaced(head + loom + straight + tied, "Shed=true", "Shed=maybe")),
                       "t.wif:9:1: error: [WEAVING] rising shed: 'maybe' is not a boolean"));
}

TEST(Wif, ContentsMayLie) {
  const std::string lying = "[CONTENTS]\nCOLOR TABLE=true\nLIFTPLAN=yes\nTHREADING=false\nWEFT COLORS=on\n";
  EXPECT_EQ(weave_rows(parse(head + lying + loom + straight + tied).draft), twill);
}

TEST(Wif, SeveralShaftsPerEndSeveralTreadlesPerPickAndUnusedOnesAreLegal) {
  const std::string text = head + loom + "[THREADING]\n1=1,2\n2=0\n4=4\n" +
                           "[TIEUP]\n1=1\n2=4\n3=0\n[TREADLING]\n1=1,2\n3=3\n4=0\n";
  EXPECT_EQ(weave_rows(parse(text).draft), (Rows{"1001", "0000", "0000", "0000"}));
}

TEST(Wif, ColoursRunOverTheirRangeAndBecomeLinear) {
  const std::string palette = "[COLOR PALETTE]\nForm=RGB\nRange=0,999\nEntries=3\n"
                              "[COLOR TABLE]\n1=999,999,999\n2=999,0,0\n3=0,0,500\n";
  const WifFile wif = parse(replaced(head + loom + straight + tied, "[WARP]\nThreads=4", "[WARP]\nThreads=4\nColor=2") +
                            palette + "[WARP COLORS]\n2=1\n[WEFT COLORS]\n1=3\n");
  ASSERT_EQ(wif.warp.colour.size(), 4u);
  EXPECT_EQ(wif.warp.colour[0], (Vec3{1, 0, 0}));
  EXPECT_EQ(wif.warp.colour[1], (Vec3{1, 1, 1}));
  // sRGB 0.5005: ((0.5005 + 0.055) / 1.055)^2.4
  EXPECT_NEAR(wif.weft.colour[0].z, 0.2145, 2e-4);
  EXPECT_EQ(wif.weft.colour[3], (Vec3{1, 1, 1}));
}

TEST(Wif, SpacingAndThicknessAreInTheUnitsOfTheirFamily) {
  const auto with = [&](const std::string& warp) {
    return parse(replaced(head + loom + straight + tied, "[WARP]\nThreads=4", "[WARP]\nThreads=4\n" + warp));
  };
  EXPECT_DOUBLE_EQ(with("Units=Decipoints\nSpacing=24\n").warp.spacing[3], 24 * 0.0254 / 720);
  EXPECT_DOUBLE_EQ(with("Units=inches\nSpacing=0.05\n").warp.spacing[0], 0.05 * 0.0254);
  const WifFile mixed = with("Units=Centimeters\nSpacing=0.212\nThickness=0.1\n[WARP SPACING]\n3=0.4\n[WARP THICKNESS]\n1=0.2\n");
  EXPECT_DOUBLE_EQ(mixed.warp.spacing[0], 0.00212);
  EXPECT_DOUBLE_EQ(mixed.warp.spacing[2], 0.004);
  EXPECT_DOUBLE_EQ(mixed.warp.thickness[0], 0.002);
  EXPECT_DOUBLE_EQ(mixed.warp.thickness[1], 0.001);
  EXPECT_TRUE(mixed.weft.spacing.empty());
  const WifFile without_unit = with("Spacing=0.212\n");
  EXPECT_TRUE(without_unit.warp.spacing.empty());
  EXPECT_TRUE(without_unit.warp.lengths_without_unit);
}

TEST(Wif, CommentsNotesAndOtherProgramsSectionsAreSkipped) {
  const std::string extra = "; a comment\n[NOTES]\nno equals sign here\n1=note\n[PRIVATE PCW]\nfree text\n[WARP SYMBOLS]\n1=X\n";
  const WifFile wif = parse(head + "[TEXT]\nTitle=My twill\n" + extra + loom + straight + replaced(tied, "1=1,2", "1=1,2 ; tie"));
  EXPECT_EQ(weave_rows(wif.draft), twill);
  EXPECT_EQ(wif.title, "My twill");
}

struct Mistake {
  const char* section;
  const char* from;
  const char* to;
  const char* message;
};

class WifMistakes : public testing::TestWithParam<Mistake> {};

// A file with every section, changed in one place each time: the message names the section and the line is right.
TEST_P(WifMistakes, AreReportedWithTheirSectionAndLine) {
  const std::string full =
      head + "[CONTENTS]\nCOLOR TABLE=true\n" + loom + "[COLOR PALETTE]\nForm=RGB\nRange=0,255\nEntries=2\n" +
      "[COLOR TABLE]\n1=255,255,255\n2=0,10,20\n" + straight + tied + "[LIFTPLAN]\n1=1,2\n" + "[WARP COLORS]\n1=2\n" +
      "[WEFT COLORS]\n1=1\n[WARP SPACING]\n1=0.2\n2=0.2\n3=0.2\n4=0.2\n[WEFT THICKNESS]\n1=.1\n2=.1\n3=.1\n4=.1\n";
  ASSERT_EQ(errors(full), "");
  const Mistake& m = GetParam();
  const std::string broken = replaced(full, m.from, m.to);
  const std::string text = errors(broken);
  EXPECT_TRUE(contains(text, m.message)) << text;
  EXPECT_TRUE(contains(text, m.section)) << text;
  EXPECT_EQ(text.substr(0, 6), "t.wif:") << text;
}

INSTANTIATE_TEST_SUITE_P(
    EachSection, WifMistakes,
    testing::Values(
        Mistake{"", "[WIF]\n", "", "there is no [WIF] section"},
        Mistake{"[WIF]", "Version=1.1", "Version=2.0", "2 is not supported"},
        Mistake{"[WIF]", "Version=1.1\n", "", "version: is missing"},
        Mistake{"[CONTENTS]", "COLOR TABLE=true", "COLOR TABLE=perhaps", "'perhaps' is not a boolean"},
        Mistake{"[WEAVING]", "Shafts=4", "Shafts=four", "'four' is not a whole number"},
        Mistake{"[WEAVING]", "Shafts=4", "Shafts=100000", "outside [1, 4096]"},
        Mistake{"[WEAVING]", "Shafts=4\n", "", "shafts: is missing"},
        Mistake{"[WARP]", "Threads=4\n[WEFT]", "Threads=-3\n[WEFT]", "-3 is outside"},
        Mistake{"[WARP]", "Threads=4\n[WEFT]", "[WEFT]", "threads: is missing"},
        Mistake{"[WARP]", "Threads=4\n[WEFT]", "Threads=4\nUnits=furlongs\n[WEFT]", "'furlongs' is not Decipoints"},
        Mistake{"[WARP]", "Threads=4\n[WEFT]", "Threads=4\nSpacing=wide\n[WEFT]", "'wide' is not a number"},
        Mistake{"", "[WEFT]\nThreads=4\n", "", "there is no [WEFT] section"},
        Mistake{"[COLOR PALETTE]", "Range=0,255", "Range=255,0", "255 is not below 0"},
        Mistake{"[COLOR PALETTE]", "Range=0,255", "Range=255", "not two numbers"},
        Mistake{"[COLOR PALETTE]", "Form=RGB", "Form=CMYK", "'CMYK' is not supported"},
        Mistake{"[COLOR TABLE]", "2=0,10,20", "2=0,10", "needs 3 numbers, has 2"},
        Mistake{"[COLOR TABLE]", "2=0,10,20", "2=0,10,256", "256 is outside [0, 255]"},
        Mistake{"[COLOR TABLE]", "2=0,10,20", "7=0,10,20", "they run from 1 to 2"},
        Mistake{"[THREADING]", "2=2\n3=3", "2=9\n3=3", "9 is outside [0, 4]"},
        Mistake{"[THREADING]", "2=2\n3=3", "17=2\n3=3", "there is no thread 17"},
        Mistake{"[THREADING]", "2=2\n3=3", "1=2\n3=3", "was given before"},
        Mistake{"[THREADING]", "2=2\n3=3", "two\n3=3", "'two' is not key=value"},
        Mistake{"[TIEUP]", "4=1,4", "4=1,x", "'x' is not a whole number"},
        Mistake{"[TREADLING]", "[TREADLING]\n1=1", "[TREADLING]\n1=5", "5 is outside [0, 4]"},
        Mistake{"[TREADLING]", "[TREADLING]\n1=1", "[TREADLING]\nfirst=1", "is not the number of a pick"},
        Mistake{"[LIFTPLAN]", "[LIFTPLAN]\n1=1,2", "[LIFTPLAN]\n1=1,7", "7 is outside [0, 4]"},
        Mistake{"[WARP COLORS]", "[WARP COLORS]\n1=2", "[WARP COLORS]\n1=3", "3 is outside [1, 2]"},
        Mistake{"[WEFT COLORS]", "[WEFT COLORS]\n1=1", "[WEFT COLORS]\n1=red", "'red' is not a whole number"},
        Mistake{"[WARP SPACING]", "4=0.2", "4=-0.2", "not a number of 0 or more"},
        Mistake{"[WARP SPACING]", "4=0.2", "4=nan", "not a number of 0 or more"},
        Mistake{"[WEFT THICKNESS]", "4=.1", "9=.1", "there is no thread 9"},
        Mistake{"", "[THREADING]", "[THREADING", "is not a [section]"},
        Mistake{"[TIEUP]", "[TREADLING]", "[TIEUP]\n[TREADLING]", "the section was given before"}));

TEST(Wif, AllProblemsOfAFileAreReportedAtOnce) {
  const std::string text = errors("[WIF]\nVersion=3\n[WEAVING]\nShafts=x\nRising Shed=dunno\n[WARP]\nThreads=0\n");
  for (const char* part : {"t.wif:2:1", "t.wif:4:1", "t.wif:5:1", "t.wif:7:1", "no [WEFT]", "no [THREADING]"})
    EXPECT_TRUE(contains(text, part)) << part << "\n" << text;
}

TEST(Wif, AWrongFileDoesNotFloodTheScreen) {
  std::string text = head + loom + "[THREADING]\n";
  for (int i = 0; i < 5000; ++i) text += "word\n";
  EXPECT_LE(problem_count([&] { parse(text); }), 101u);
  EXPECT_TRUE(contains(errors("\x01\x02 binary"), "no [WIF] section"));
  EXPECT_FALSE(errors("").empty());
}

TEST(Wif, CountsBeyondReasonAreRefusedBeforeAnythingIsAllocated) {
  EXPECT_TRUE(contains(errors(replaced(head + loom + straight + tied, "Threads=4", "Threads=2000000000")), "outside [1, 16384]"));
  const std::string large = replaced(replaced(head + loom + straight + tied, "[WARP]\nThreads=4", "[WARP]\nThreads=16000"),
                                     "[WEFT]\nThreads=4", "[WEFT]\nThreads=16000");
  EXPECT_TRUE(contains(errors(large), "larger than"));
}

TEST(Wif, AMissingFileAndAFolderAreReported) {
  EXPECT_TRUE(contains(problems_of([] { read_wif("/nowhere/x.wif"); }), "/nowhere/x.wif: error: cannot be opened"));
  EXPECT_TRUE(contains(problems_of([] { read_wif(IMBIBE_SOURCE_DIR "/fabrics"); }), "cannot be opened"));
}

TEST(Wif, TheShippedFilesAreReadAndInterlace) {
  std::size_t files = 0;
  for (const auto& item : std::filesystem::directory_iterator(IMBIBE_SOURCE_DIR "/fabrics")) {
    if (item.path().extension() != ".wif") continue;
    ++files;
    const WeaveFacts facts = weave_facts(read_wif(item.path()).draft);
    EXPECT_TRUE(facts.loose_ends.empty() && facts.loose_picks.empty()) << item.path();
  }
  EXPECT_GE(files, 3u);
}

}  // namespace
}  // namespace imbibe
