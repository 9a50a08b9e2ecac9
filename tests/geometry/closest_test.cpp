#include "imbibe/geometry/closest.h"

#include <gtest/gtest.h>

#include "imbibe/geometry/curve.h"
#include "imbibe/geometry/sampling.h"

namespace imbibe {
namespace {

Vec3 random_point(std::uint64_t id, std::uint64_t stream, Real half = 1) {
  return random_in({{-half, -half, -half}, {half, half, half}}, {.seed = 21, .id = id, .step = 0}, stream);
}

TEST(ClosestPoint, OnASegmentNoSampleOfItIsNearer) {
  for (std::uint64_t id = 0; id < 200; ++id) {
    const Vec3 p = random_point(id, 0, 2), a = random_point(id, 3), b = random_point(id, 6);
    const SegmentPoint found = closest_on_segment(p, a, b);
    EXPECT_NEAR(norm(found.point - (a + found.parameter * (b - a))), 0, 1e-14);
    for (int k = 0; k <= 50; ++k) {
      EXPECT_LE(norm(p - found.point), norm(p - (a + k / 50.0 * (b - a))) + 1e-14);
    }
  }
}

TEST(ClosestPoint, OnATriangleNoSampleOfItIsNearerAndTheFeatureIsTheOneItLiesOn) {
  int features[7] = {};
  for (std::uint64_t id = 0; id < 500; ++id) {
    const Vec3 p = random_point(id, 0, 2), a = random_point(id, 3), b = random_point(id, 6), c = random_point(id, 9);
    const TrianglePoint found = closest_on_triangle(p, a, b, c);
    ++features[static_cast<int>(found.feature)];
    for (int i = 0; i <= 20; ++i) {
      for (int j = 0; i + j <= 20; ++j) {
        const Vec3 q = a + i / 20.0 * (b - a) + j / 20.0 * (c - a);
        ASSERT_LE(norm(p - found.point), norm(p - q) + 1e-14);
      }
    }
    const Vec3 normal = normalized(cross(b - a, c - a));
    EXPECT_NEAR(dot(found.point - a, normal), 0, 1e-13);
    if (found.feature == TriangleFeature::face) {
      EXPECT_NEAR(norm(cross(p - found.point, normal)), 0, 1e-12);
    }
    if (found.feature == TriangleFeature::edge_bc) {
      EXPECT_NEAR(norm(cross(found.point - b, normalized(c - b))), 0, 1e-13);
    }
    if (found.feature == TriangleFeature::vertex_b) {
      EXPECT_EQ(found.point, b);
    }
  }
  for (const int count : features) EXPECT_GT(count, 0);
}

TEST(ClosestPoint, ATriangleWithoutAreaIsTreatedAsItsEdges) {
  const TrianglePoint found = closest_on_triangle({0.3, 1, 0}, {0, 0, 0}, {0.5, 0, 0}, {1, 0, 0});
  EXPECT_NEAR(norm(found.point - Vec3{0.3, 0, 0}), 0, 1e-15);
}

TEST(Curve, APointAtALengthLiesThatFarAlongIt) {
  std::vector<Vec3> helix;
  for (int i = 0; i <= 100; ++i) helix.push_back({std::cos(0.1 * i), std::sin(0.1 * i), 0.05 * i});
  const auto lengths = arc_lengths(helix);
  EXPECT_EQ(lengths.back(), curve_length(helix));
  EXPECT_EQ(point_at_length(helix, lengths, -1), helix.front());
  EXPECT_EQ(point_at_length(helix, lengths, 1e9), helix.back());
  for (std::size_t i = 0; i < helix.size(); ++i) {
    EXPECT_NEAR(norm(point_at_length(helix, lengths, lengths[i]) - helix[i]), 0, 1e-13);
  }
  const Real half = 0.5 * (lengths[4] + lengths[5]);
  EXPECT_NEAR(norm(point_at_length(helix, lengths, half) - 0.5 * (helix[4] + helix[5])), 0, 1e-14);
}

TEST(Curve, TheClosestPointKnowsItsPiece) {
  const std::vector<Vec3> corner{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
  const CurvePoint near = closest_on_curve(corner, {2, 0.5, 0});
  EXPECT_EQ(near.piece, 1u);
  EXPECT_NEAR(near.parameter, 0.5, 1e-15);
  EXPECT_NEAR(near.squared_distance, 1, 1e-15);
}

TEST(Curve, TheFrameBesideATangentIsARightHandedTriad) {
  for (std::uint64_t id = 0; id < 50; ++id) {
    const Vec3 tangent = random_direction({.seed = 2, .id = id, .step = 0});
    const CrossFrame frame = frame_beside(tangent, {0, 1, 0});
    EXPECT_NEAR(dot(cross(frame.side, frame.up), tangent), 1, 1e-12);
  }
}

TEST(Sampling, ALatticeFillsABoxWithItsVolumeOverTheSpacingCubed) {
  const auto points = lattice_in_box({{0, 0, 0}, {1, 2, 3}}, 0.1);
  EXPECT_EQ(points.size(), 6000u);
  Vec3 mean{};
  for (const Vec3& p : points) mean += p / 6000.0;
  EXPECT_NEAR(norm(mean - Vec3{0.5, 1, 1.5}), 0, 1e-12);
}

TEST(Sampling, DirectionsOnTheSphereBalance) {
  Vec3 sum{};
  for (const Vec3& d : directions_on_sphere(1000)) {
    EXPECT_NEAR(norm(d), 1, 1e-14);
    sum += d;
  }
  EXPECT_LT(norm(sum) / 1000, 1e-3);  // error of the spiral, of the order of 1/n
}

}  // namespace
}  // namespace imbibe
