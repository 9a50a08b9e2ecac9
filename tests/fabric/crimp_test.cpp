#include "imbibe/fabric/crimp.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace imbibe {
namespace {

// 1e-12 of lengths of order 1: a few roundings of trigonometric functions.
constexpr Real rounding = 1e-12;

TEST(Crimp, AFloatIsStraight) {
  const CrimpCurve c = crimp_curve(1, 0.3, 0.3, 0.5, 0.5);
  EXPECT_EQ(c.length, 1);
  EXPECT_EQ(point_at(c, 0.25).along, 0.25);
  EXPECT_EQ(point_at(c, 0.25).height, 0.3);
  EXPECT_EQ(arc_at(c, 0.7), 0.7);
}

TEST(Crimp, PeircesTwoEquationsHold) {
  for (const auto& [p, h, r0, r1] : std::vector<std::array<Real, 4>>{
           {1, 0.4, 0.4, 0.4}, {2, 0.5, 0.3, 0.7}, {1, 0.01, 0.2, 0.9}, {5, 1.9, 1, 1}, {1.8, 1, 1, 1}}) {
    const CrimpCurve c = crimp_curve(p, 0, -h, r0, r1);
    EXPECT_NEAR((r0 + r1) * std::sin(c.angle) + c.straight * std::cos(c.angle), p, rounding);
    EXPECT_NEAR((r0 + r1) * (1 - std::cos(c.angle)) + c.straight * std::sin(c.angle), h, rounding);
    EXPECT_NEAR(c.length, (r0 + r1) * c.angle + c.straight, rounding);
  }
}

TEST(Crimp, ThePathStartsAndEndsLevelAtItsHeightsAndIsSmooth) {
  const CrimpCurve c = crimp_curve(1, 0.2, -0.25, 0.4, 0.3);
  EXPECT_NEAR(point_at(c, 0).height, 0.2, rounding);
  EXPECT_NEAR(point_at(c, c.length).height, -0.25, rounding);
  EXPECT_NEAR(point_at(c, c.length).along, 1, rounding);
  const Real step = 1e-6;
  CrimpPoint before = point_at(c, 0);
  Real slope_before = 0;
  for (Real s = step; s < c.length; s += c.length / 997) {
    before = point_at(c, s - step);
    const CrimpPoint here = point_at(c, s);
    // Arc length is the parameter: chord = step up to step^3 / (24 R^2) and rounding of the difference.
    EXPECT_NEAR(std::hypot(here.along - before.along, here.height - before.height), step, 1e-12);
    const Real slope = std::atan2(here.height - before.height, here.along - before.along);
    // The direction turns by at most arc / R between two samples.
    EXPECT_LE(std::abs(slope - slope_before), c.length / 997 / 0.3 + 1e-5);
    slope_before = slope;
  }
}

TEST(Crimp, ArcAtUndoesPointAt) {
  const CrimpCurve c = crimp_curve(1, -0.2, 0.2, 0.4, 0.5);
  for (int i = 0; i <= 200; ++i) {
    const Real s = c.length * i / 200;
    EXPECT_NEAR(arc_at(c, point_at(c, s).along), s, 1e-11);
  }
}

TEST(Crimp, ThePathIsTheShortestThatKeepsItsDistanceFromBothCrossingYarns) {
  // Circles of radius R around the crossing yarns' centres: the path touches each and enters neither.
  const Real r0 = 0.4, r1 = 0.5, from = 0.2, to = -0.3;
  const CrimpCurve c = crimp_curve(1.2, from, to, r0, r1);
  Real nearest0 = 1e9, nearest1 = 1e9;
  for (int i = 0; i <= 1000; ++i) {
    const CrimpPoint p = point_at(c, c.length * i / 1000);
    nearest0 = std::min(nearest0, std::hypot(p.along, p.height - (from - r0)));
    nearest1 = std::min(nearest1, std::hypot(p.along - 1.2, p.height - (to + r1)));
  }
  EXPECT_NEAR(nearest0, r0, rounding);
  EXPECT_NEAR(nearest1, r1, rounding);
}

TEST(Crimp, TheJammedPitchOfAPlainWeaveIsTwoRootThreeRadii) {
  const Real r = 0.2;
  EXPECT_NEAR(least_span(2 * r, 2 * r, 2 * r), 2 * std::sqrt(3.0) * r, rounding);
  const CrimpCurve c = crimp_curve(least_span(2 * r, 2 * r, 2 * r), r, -r, 2 * r, 2 * r);
  EXPECT_NEAR(c.straight, 0, 1e-7);           // the root of a rounding
  EXPECT_NEAR(c.angle, pi / 3, 1e-7);
  // Crimp of jammed plain cloth: (4 r pi / 3) / (2 sqrt(3) r) - 1 = 20.9 %.
  EXPECT_NEAR(c.length / c.span, 2 * pi / 3 / std::sqrt(3.0), 1e-7);
}

TEST(Crimp, OfAnOpenClothIsHalfTheSquareOfTheSlope) {
  // h << p: l/p - 1 -> (h/p)^2 / 2; the arcs add terms of (R/p) (h/p)^2.
  const CrimpCurve c = crimp_curve(1, 0, 0.01, 0.001, 0.001);
  EXPECT_NEAR((c.length - 1) / (0.5 * 0.01 * 0.01), 1, 5e-3);
}

}  // namespace
}  // namespace imbibe
