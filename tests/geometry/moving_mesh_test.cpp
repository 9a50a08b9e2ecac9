// Points that move against a moving surface: none crosses unseen.
#include "imbibe/geometry/moving_mesh.h"

#include <gtest/gtest.h>

#include "imbibe/core/parallel.h"
#include "imbibe/geometry/sampling.h"

namespace imbibe {
namespace {

// A sheet of n x n cells over [-1, 1]^2 whose height flaps.
struct Flapping {
  int n;
  std::vector<Vec3> at(Real time, Real amplitude = 0.3) const {
    std::vector<Vec3> x;
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        const Real u = -1 + 2.0 * i / n, v = -1 + 2.0 * j / n;
        x.push_back({u, v, amplitude * std::sin(5 * u + 3 * v - 40 * time) + 0.1 * std::cos(9 * v + 11 * time)});
      }
    return x;
  }
  std::vector<std::array<Index, 3>> triangles() const {
    std::vector<std::array<Index, 3>> t;
    const auto id = [&](int i, int j) { return static_cast<Index>(i + (n + 1) * j); };
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const bool turned = (i + j) % 2 == 0;
        t.push_back({id(i, j), id(i + 1, j), turned ? id(i + 1, j + 1) : id(i, j + 1)});
        t.push_back({turned ? id(i, j) : id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)});
      }
    return t;
  }
  // Height of the surface over (x, y): by hand from the cell that (x, y) lies in.
  Real height(const std::vector<Vec3>& nodes, Real x, Real y) const {
    const Real a = (x + 1) / 2 * n, b = (y + 1) / 2 * n;
    const int i = std::min(static_cast<int>(a), n - 1), j = std::min(static_cast<int>(b), n - 1);
    const Real s = a - i, t = b - j;
    const auto z = [&](int k, int l) { return nodes[static_cast<std::size_t>(i + k + (n + 1) * (j + l))].z; };
    if ((i + j) % 2 == 0)
      return s >= t ? z(0, 0) + s * (z(1, 0) - z(0, 0)) + t * (z(1, 1) - z(1, 0))
                    : z(0, 0) + t * (z(0, 1) - z(0, 0)) + s * (z(1, 1) - z(0, 1));
    return s + t <= 1 ? z(0, 0) + s * (z(1, 0) - z(0, 0)) + t * (z(0, 1) - z(0, 0))
                      : z(1, 1) + (1 - s) * (z(0, 1) - z(1, 1)) + (1 - t) * (z(1, 0) - z(1, 1));
  }
};

TEST(MovingMesh, AMillionPointsAgainstAFlappingSheetNoneCrossesUnseen) {
  constexpr std::size_t count = 1'000'000;
  const Flapping sheet{24};
  const std::vector<Vec3> start = sheet.at(0), end = sheet.at(0.02);
  MovingMesh moving;
  set_step(moving, start, end, sheet.triangles());
  struct Seen {
    std::size_t changed_side = 0, missed = 0, false_hits = 0;
    Seen& operator+=(const Seen& o) {
      changed_side += o.changed_side, missed += o.missed, false_hits += o.false_hits;
      return *this;
    }
  };
  const Bounds room{{-0.9, -0.9, -0.6}, {0.9, 0.9, 0.6}};
  const Seen seen = parallel_sum(count, [&](std::size_t begin, std::size_t stop) {
    Seen s;
    for (std::size_t i = begin; i < stop; ++i) {
      const RandomCounter id{5, i, 0};
      Vec3 p0 = random_in(room, id, 0), p1 = p0 + 0.3 * uniform(id, 3) * random_direction(id, 4);
      p1.x = std::clamp(p1.x, -0.99, 0.99), p1.y = std::clamp(p1.y, -0.99, 0.99);
      if (i % 3 == 0) p0.x = p1.x = -1 + 2.0 * static_cast<Real>(1 + i % 22) / 24;  // along the lines between triangles
      if (i % 9 == 0) p0.y = p1.y = -1 + 2.0 * static_cast<Real>(1 + i % 21) / 24;  // through a node
      const bool above0 = p0.z > sheet.height(start, p0.x, p0.y), above1 = p1.z > sheet.height(end, p1.x, p1.y);
      const auto hit = first_crossing(moving, p0, p1);
      s.changed_side += above0 != above1;
      s.missed += above0 != above1 && !hit;
      if (hit) {
        // Where it says, when it says.
        const auto& v = moving.mesh.triangles[hit->at.triangle];
        Vec3 at{};
        for (std::size_t k = 0; k < 3; ++k)
          at += hit->at.weight[k] * (start[v[k]] + hit->time_fraction * (end[v[k]] - start[v[k]]));
        s.false_hits += norm(at - (p0 + hit->time_fraction * (p1 - p0))) > 1e-7;
      }
    }
    return s;
  });
  EXPECT_GT(seen.changed_side, 100'000u);
  EXPECT_EQ(seen.missed, 0u);
  EXPECT_EQ(seen.false_hits, 0u);
}

TEST(MovingMesh, TheFirstCrossingIsTheEarliest) {
  // Two layers, the nearer one first in time; the normal points back to where the point came from.
  const std::vector<Vec3> nodes{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}, {-1, -1, 1}, {1, -1, 1}, {0, 1, 1}};
  const std::vector<std::array<Index, 3>> triangles{{0, 1, 2}, {3, 4, 5}};
  MovingMesh moving;
  set_step(moving, nodes, nodes, triangles);
  const auto hit = first_crossing(moving, {0, 0, 3}, {0, 0, -1});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->at.triangle, 1u);
  EXPECT_NEAR(hit->time_fraction, 0.5, 1e-14);
  EXPECT_EQ(hit->normal, (Vec3{0, 0, 1}));
  EXPECT_FALSE(first_crossing(moving, {0, 0, 0.9}, {0, 0, 0.1}));
}

TEST(MovingMesh, AStillPointIsMetByAMovingSheet) {
  const std::vector<std::array<Index, 3>> triangles{{0, 1, 2}};
  const std::vector<Vec3> start{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}, end{{-1, -1, 2}, {1, -1, 2}, {0, 1, 2}};
  MovingMesh moving;
  set_step(moving, start, end, triangles);
  const auto hit = first_crossing(moving, {0, 0, 0.5}, {0, 0, 0.5});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->time_fraction, 0.25, 1e-14);
  EXPECT_EQ(hit->normal, (Vec3{0, 0, 1}));
}

TEST(MovingMesh, TheNearestPointSaysOnWhichSideAndWhetherBeside) {
  const std::vector<Vec3> nodes{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  MovingMesh moving;
  set_step(moving, nodes, nodes, std::vector<std::array<Index, 3>>{{0, 1, 2}});
  const NearestOnSheet above = nearest_on(moving, {0, 0, 0.2}), below = nearest_on(moving, {0, 0, -0.2}),
                       beside = nearest_on(moving, {0, -1.3, 0.1});
  EXPECT_EQ(above.side, 1);
  EXPECT_EQ(below.side, -1);
  EXPECT_EQ(below.normal, (Vec3{0, 0, -1}));
  EXPECT_NEAR(above.distance, 0.2, 1e-15);
  EXPECT_FALSE(above.on_border);
  EXPECT_TRUE(beside.on_border);
}

}  // namespace
}  // namespace imbibe
