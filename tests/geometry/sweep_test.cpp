#include "imbibe/geometry/sweep.h"

#include <gtest/gtest.h>

#include "imbibe/geometry/sampling.h"

namespace imbibe {
namespace {

Vec3 random_point(std::uint64_t id, std::uint64_t stream, Real half = 1) {
  return random_in({{-half, -half, -half}, {half, half, half}}, {.seed = 41, .id = id, .step = 0}, stream);
}

// Marches along the path in steps no longer than the gap that is left, so it cannot jump over a contact.
template <class Distance>
Real first_time_by_marching(const Vec3& p0, const Vec3& p1, Real reach, Distance&& distance) {
  const Real length = norm(p1 - p0);
  for (Real t = 0; t <= 1;) {
    const Real gap = distance(p0 + t * (p1 - p0)) - reach;
    if (gap < 1e-9) return t;
    t += gap / length;
  }
  return 2;
}

TEST(Sweep, ACapsuleIsMetWhenMarchingMeetsIt) {
  int hits = 0;
  for (std::uint64_t id = 0; id < 2000; ++id) {
    const Vec3 p0 = random_point(id, 0, 1.5), p1 = random_point(id, 3, 1.5), a = random_point(id, 6), b = random_point(id, 9);
    const Real radius = 0.3, reach = 0.1;
    const auto distance = [&](const Vec3& p) { return norm(p - closest_on_segment(p, a, b).point) - radius; };
    const Real expected = first_time_by_marching(p0, p1, reach, distance);
    const auto hit = sweep_capsule(p0, p1, reach, a, b, radius);
    if (!hit) {
      // Marching stops 1e-9 outside; only a graze by less may be a miss.
      EXPECT_GT(expected, 1) << id;
      continue;
    }
    ++hits;
    const Vec3 at = p0 + hit->time_fraction * (p1 - p0);
    EXPECT_LE(expected, hit->time_fraction + 1e-12) << id;
    if (hit->time_fraction > 0) {
      EXPECT_NEAR(distance(at), reach, 1e-12) << id;
    }
    EXPECT_NEAR(distance(at + 1e-3 * hit->normal) - distance(at), 1e-3, 1e-12);  // the normal is the gradient
  }
  EXPECT_GT(hits, 400);
}

TEST(Sweep, ACapsuleMuchSmallerThanThePathIsMetToTwelveDigits) {
  // 0.25 m of path, a yarn of 0.1 mm: the plain quadratic formula would lose half of the digits.
  const Vec3 a{-1e-3, 3e-5, 0}, b{1e-3, 3e-5, 0};
  const auto hit = sweep_capsule({0, 0, 0.2}, {0, 0, -0.05}, 5e-5, a, b, 1e-4);
  ASSERT_TRUE(hit);
  const Real height = std::sqrt(1.5e-4 * 1.5e-4 - 3e-5 * 3e-5);
  EXPECT_NEAR(hit->time_fraction * 0.25, 0.2 - height, 1e-15);
}

TEST(Sweep, ASegmentWithoutLengthIsABall) {
  const auto hit = sweep_capsule({0, 0, 2}, {0, 0, 0}, 0.25, {0, 0, 0}, {0, 0, 0}, 0.25);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->time_fraction, 0.75, 1e-15);
  EXPECT_FALSE(sweep_capsule({0, 0, 2}, {0, 0, 2}, 0.25, {0, 0, 0}, {0, 0, 0}, 0.25));  // a particle at rest far off
}

TEST(Sweep, ARoundedTriangleIsMetWhenMarchingMeetsIt) {
  int hits = 0;
  for (std::uint64_t id = 0; id < 2000; ++id) {
    const Vec3 p0 = random_point(id, 0, 1.5), p1 = random_point(id, 3, 1.5);
    const Vec3 a = random_point(id, 6), b = random_point(id, 9), c = random_point(id, 12);
    const Real reach = 0.2;
    const auto distance = [&](const Vec3& p) { return norm(p - closest_on_triangle(p, a, b, c).point); };
    const Real expected = first_time_by_marching(p0, p1, reach, distance);
    const auto hit = sweep_triangle(p0, p1, reach, a, b, c);
    if (!hit) {
      EXPECT_GT(expected, 1) << id;
      continue;
    }
    ++hits;
    EXPECT_LE(expected, hit->time_fraction + 1e-12) << id;
    if (hit->time_fraction > 0) {
      EXPECT_NEAR(distance(p0 + hit->time_fraction * (p1 - p0)), reach, 1e-11) << id;
    }
  }
  EXPECT_GT(hits, 200);
}

TEST(Sweep, ATriangleIsCrossedFromBothSidesAndOnlyWithinItsOutline) {
  const Vec3 a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0};
  EXPECT_NEAR(*cross_triangle({0.2, 0.2, 1}, {0.2, 0.2, -3}, a, b, c), 0.25, 1e-15);
  EXPECT_NEAR(*cross_triangle({0.2, 0.2, -3}, {0.2, 0.2, 1}, a, b, c), 0.75, 1e-15);
  EXPECT_FALSE(cross_triangle({0.6, 0.6, 1}, {0.6, 0.6, -3}, a, b, c));
  EXPECT_FALSE(cross_triangle({0.2, 0.2, 1}, {0.2, 0.2, 0.5}, a, b, c));
  EXPECT_FALSE(cross_triangle({-1, 0.2, 0}, {1, 0.2, 0}, a, b, c));  // in its plane
}

TEST(Sweep, APrismHoldsThePathWhereItsProjectionIsInsideTheTriangle) {
  const Vec3 a{0, 0, 0}, b{2, 0, 0}, c{0, 2, 0};
  const auto through = cross_prism({0.5, 0.5, 1}, {0, 0, -2}, a, b, c, 0.2, 0.1, 0);
  ASSERT_TRUE(through);
  EXPECT_NEAR(through->enter, 0.4, 1e-15);
  EXPECT_NEAR(through->leave, 0.55, 1e-15);
  const auto sideways = cross_prism({-1, 0.5, 0.1}, {4, 0, 0}, a, b, c, 0.2, 0.1, 0);
  ASSERT_TRUE(sideways);
  EXPECT_NEAR(sideways->enter, 0.25, 1e-15);
  EXPECT_NEAR(sideways->leave, 0.625, 1e-15);
  EXPECT_FALSE(cross_prism({-1, 0.5, 0.3}, {4, 0, 0}, a, b, c, 0.2, 0.1, 0));
}

}  // namespace
}  // namespace imbibe
