#include "imbibe/core/quantity.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace imbibe {
namespace {

struct Reading {
  const char* text;
  const char* unit;
  Real si;
};

class Readings : public ::testing::TestWithParam<Reading> {};

TEST_P(Readings, GiveTheSiValue) {
  const Reading& r = GetParam();
  // A conversion is a product or two of rounded factors: some units in the last place.
  EXPECT_NEAR(parse_quantity(r.text, r.unit), r.si, 4e-15 * std::abs(r.si)) << r.text;
}

INSTANTIATE_TEST_SUITE_P(
    Units, Readings,
    ::testing::Values(Reading{"0.4 mm", "m", 4e-4}, Reading{"20 tex", "kg/m", 2e-5}, Reading{"150 dtex", "kg/m", 1.5e-5},
                      Reading{"9 denier", "kg/m", 1e-6}, Reading{"24 /cm", "1/m", 2400}, Reading{"24 ends/cm", "1/m", 2400},
                      Reading{"60 picks/inch", "1/m", 60 / 0.0254}, Reading{"120 gsm", "kg/m2", 0.12},
                      Reading{"120 g/m2", "kg/m2", 0.12}, Reading{"50 uL", "m3", 5e-8}, Reading{"50 µL", "m3", 5e-8},
                      Reading{"1.64 mL", "m3", 1.64e-6}, Reading{"60 deg", "rad", pi / 3}, Reading{"65 %", "1", 0.65},
                      Reading{"20 degC", "K", 293.15}, Reading{"300 K", "K", 300}, Reading{"72.8 mN/m", "N/m", 0.0728},
                      Reading{"-0.3 m/s", "m/s", -0.3}, Reading{"+5 ms", "s", 5e-3}, Reading{"1e3", "kg/m3", 1000},
                      Reading{" 2mm ", "m", 2e-3}, Reading{"1 g/cm3", "kg/m3", 1000}, Reading{"2.5e-1 mm", "m", 2.5e-4}));

TEST(Quantity, EnglishCottonCountRunsTheOtherWayRound) {
  // Ne 30: 30 hanks of 840 yards weigh one pound; 590.541 / Ne tex, of which the last digit is rounded.
  EXPECT_NEAR(parse_quantity("30 Ne", "kg/m"), 590.541e-6 / 30, 0.0005e-6 / 30);
  EXPECT_NEAR(parse_quantity("30 Ne", "kg/m") * 2, parse_quantity("15 Ne", "kg/m"), 1e-20);
  EXPECT_THROW(parse_quantity("0 Ne", "kg/m"), QuantityError);
  EXPECT_THROW(parse_quantity("30 Ne", "m"), QuantityError);
}

class Refusals : public ::testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(Refusals, AreErrorsThatQuoteWhatWasRead) {
  const auto& [text, unit] = GetParam();
  try {
    parse_quantity(text, unit);
    ADD_FAILURE() << "'" << text << "' was taken as " << unit;
  } catch (const QuantityError& error) {
    EXPECT_NE(std::string(error.what()), "");
  }
}

INSTANTIATE_TEST_SUITE_P(BadValues, Refusals,
                         ::testing::Values(std::pair{"", "m"}, std::pair{"mm", "m"}, std::pair{"nan", "m"},
                                           std::pair{"inf m", "m"}, std::pair{"-inf", "1"}, std::pair{"1e999", "m"},
                                           std::pair{"5 kg", "m"}, std::pair{"5 furlungs", "m"}, std::pair{"5 m m", "m"},
                                           std::pair{"90", "rad"}, std::pair{"20", "K"}, std::pair{"5 mm", "1"},
                                           std::pair{"20 tex", "kg"}, std::pair{"1,5 mm", "m"}));

TEST(Quantity, AnAmbiguousBareNumberIsRefusedWithTheUnitsThatWouldDo) {
  try {
    parse_quantity("20", "K");
    FAIL();
  } catch (const QuantityError& error) {
    EXPECT_NE(std::string(error.what()).find("degC"), std::string::npos);
  }
}

TEST(Quantity, ShownValuesReadBackAsTheyWere) {
  const std::vector<std::pair<Reading, const char*>> cases{
      {{"", "m", 4e-4}, "mm"}, {{"", "kg/m", 2e-5}, "tex"}, {{"", "rad", 1.0}, "deg"}, {{"", "K", 293.15}, "degC"}};
  for (const auto& [r, shown] : cases) {
    const std::string text = format_quantity(r.si, r.unit, shown);
    EXPECT_NEAR(parse_quantity(text, r.unit), r.si, 1e-6 * r.si) << text;  // six digits are shown
  }
  EXPECT_EQ(format_quantity(4e-4, "m", "mm"), "0.4 mm");
  EXPECT_EQ(format_quantity(293.15, "K", "degC"), "20 degC");
}

TEST(Quantity, ThatIsTooLargeOnceConvertedOrHasAnEndlessUnitIsRefused) {
  EXPECT_THROW(parse_quantity("1e308 km", "m"), QuantityError);
  EXPECT_THROW(parse_quantity("3e-320 Ne", "kg/m"), QuantityError);
  EXPECT_THROW(parse_quantity("1 " + std::string(100000, '('), "m"), QuantityError);
}

}  // namespace
}  // namespace imbibe
