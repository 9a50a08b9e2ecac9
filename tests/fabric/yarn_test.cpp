#include "imbibe/fabric/yarn.h"

#include "fabric/support.h"

namespace imbibe {
namespace {

using test::contains;
using test::shipped_fibres;

YarnType made(const YarnSpec& spec) {
  std::vector<Problem> problems;
  const YarnType yarn = make_yarn(spec, shipped_fibres(), "warp", problems);
  for (const Problem& p : problems) ADD_FAILURE() << p.text();
  return yarn;
}

std::string problems(const YarnSpec& spec) {
  std::vector<Problem> found;
  make_yarn(spec, shipped_fibres(), "warp", found);
  std::string text;
  for (const Problem& p : found) text += p.text() + "\n";
  return text;
}

TEST(Yarn, TwentyTexOfCottonIs86MicrometresInRadius) {
  const YarnType yarn = made({.fibre = "cotton", .linear_density = 20e-6});
  EXPECT_NEAR(yarn.radius, 86.4e-6, 0.05e-6);  // sqrt(20e-6 / (pi 1550 0.55))
  EXPECT_DOUBLE_EQ(yarn.packing, 0.55);
  EXPECT_NEAR(yarn.void_share(), 0.45, 1e-15);
}

TEST(Yarn, AnyTwoOfSizeMassAndPackingGiveTheThird) {
  const YarnType a = made({.linear_density = 20e-6, .packing = 0.6});
  const YarnType b = made({.diameter = 2 * a.radius, .packing = 0.6});
  const YarnType c = made({.diameter = 2 * a.radius, .linear_density = 20e-6});
  EXPECT_NEAR(b.linear_density, 20e-6, 1e-18);
  EXPECT_NEAR(c.packing, 0.6, 1e-12);
  EXPECT_NEAR(pi * a.radius * a.radius * a.fibre.density * a.packing, 20e-6, 1e-18);
}

TEST(Yarn, AMonofilamentIsSolid) {
  const YarnType yarn = made({.fibre = "polyester", .diameter = 0.2e-3, .monofilament = true});
  EXPECT_EQ(yarn.packing, 1);
  EXPECT_EQ(yarn.void_share(), 0);
  EXPECT_NEAR(yarn.linear_density, pi * 1e-8 * 1390, 1e-15);
  EXPECT_TRUE(contains(problems({.diameter = 0.2e-3, .packing = 0.5, .monofilament = true}), "packing 1"));
  EXPECT_TRUE(contains(problems({.diameter = 0.2e-3, .linear_density = 1e-6, .monofilament = true}), "leave one"));
}

TEST(Yarn, WhatCannotBeIsReported) {
  EXPECT_TRUE(contains(problems({}), "warp: needs a diameter (such as 0.4 mm) or a linear_density"));
  EXPECT_TRUE(contains(problems({.fibre = "wol", .diameter = 1e-4}), "warp.fibre: there is no fibre 'wol'; did you mean 'wool'?"));
  EXPECT_TRUE(contains(problems({.diameter = 1e-4, .linear_density = 20e-6}), "packed to"));
  EXPECT_TRUE(contains(problems({.diameter = 4e-4, .linear_density = 20e-6, .packing = 0.6}), "leave one of the three out"));
  EXPECT_TRUE(contains(problems({.diameter = -1.0}), "is not above 0"));
  EXPECT_TRUE(contains(problems({.diameter = std::nan("")}), "is not above 0"));
  EXPECT_TRUE(contains(problems({.diameter = 0.0, .packing = 2.0, .tortuosity_squared = 0.5}), "is above 1"));
  EXPECT_TRUE(contains(problems({.linear_density = 20e-6, .packing = 0.95}), "monofilament: true"));
  EXPECT_TRUE(contains(problems({.diameter = 20e-6, .fibre_radius = 1e-3}), "thicker than its yarn"));
}

TEST(Yarn, OwnValuesReplaceTheLibrarys) {
  const YarnType yarn = made({.fibre = "wool", .diameter = 4e-4, .fibre_radius = 9e-6, .tortuosity_squared = 7,
                              .absorption_coefficient = 0.5});
  EXPECT_EQ(yarn.fibre.radius, 9e-6);
  EXPECT_EQ(yarn.tortuosity_squared, 7);
  EXPECT_EQ(yarn.absorption_coefficient, 0.5);
  EXPECT_EQ(made({.fibre = "wool", .diameter = 4e-4}).fibre.radius, 10.5e-6);
}

}  // namespace
}  // namespace imbibe
