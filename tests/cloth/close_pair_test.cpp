#include "imbibe/cloth/close_pair.h"

#include <gtest/gtest.h>

#include "imbibe/core/random.h"
#include "imbibe/geometry/sampling.h"

namespace imbibe {
namespace {

using Four = std::array<Vec3, 4>;

Four random_four(std::uint64_t id, std::uint64_t step, Real size) {
  Four x;
  const Bounds box{{-size, -size, -size}, {size, size, size}};
  for (std::size_t k = 0; k < 4; ++k) x[k] = random_in(box, {.seed = 7, .id = id, .step = step}, 3 * k);
  return x;
}

// Distance by trying many points of both pieces.
Real sampled_distance(PairKind kind, const Four& x) {
  Real least = 1e9;
  const int n = 60;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      const Real s = 1.0 * i / n, t = 1.0 * j / n;
      if (kind == PairKind::edge_edge) {
        least = std::min(least, norm(x[0] + s * (x[1] - x[0]) - x[2] - t * (x[3] - x[2])));
      } else if (i + j <= n) {
        least = std::min(least, norm(x[0] - x[1] - s * (x[2] - x[1]) - t * (x[3] - x[1])));
      }
    }
  }
  return least;
}

TEST(ClosePair, the_gap_is_the_least_distance_and_its_weights_make_it) {
  for (const PairKind kind : {PairKind::node_triangle, PairKind::edge_edge}) {
    for (std::uint64_t id = 0; id < 200; ++id) {
      const Four x = random_four(id, 0, 1);
      const PairGap gap = gap_of(kind, x);
      const Real sampled = sampled_distance(kind, x);
      EXPECT_LE(gap.distance, sampled + 1e-12);
      EXPECT_GE(gap.distance, sampled - 0.06);  // spacing of the samples: pieces to 3.5 long in 60 parts
      Vec3 sum;
      Real total = 0;
      for (std::size_t k = 0; k < 4; ++k) sum += gap.weight[k] * x[k], total += gap.weight[k];
      EXPECT_LT(norm(sum - gap.distance * gap.normal), 1e-12);
      EXPECT_NEAR(total, 0, 1e-12);
    }
  }
}

TEST(ClosePair, parallel_and_crossing_edges_have_the_right_distance) {
  const auto distance = [](Vec3 a, Vec3 b, Vec3 c, Vec3 d) { return gap_of(PairKind::edge_edge, {a, b, c, d}).distance; };
  EXPECT_NEAR(distance({0, 0, 0}, {1, 0, 0}, {0.2, 0.3, 0}, {0.9, 0.3, 0}), 0.3, 1e-15);
  EXPECT_NEAR(distance({0, 0, 0}, {1, 0, 0}, {3, 0, 0}, {4, 0, 0}), 2, 1e-15);
  EXPECT_NEAR(distance({0, 0, 0}, {1, 0, 0}, {4, 1, 0}, {3, 1, 0}), std::sqrt(5.0), 1e-15);
  EXPECT_NEAR(distance({0, 0, 0}, {1, 0, 0}, {0.5, -1, 0.1}, {0.5, 1, 0.1}), 0.1, 1e-15);
}

TEST(ClosePair, no_motion_that_meets_is_let_through) {
  // Signed volumes change sign where the pieces cross; sampled motions that come within 1e-3 must be reported.
  std::size_t met = 0, stopped = 0, early = 0, wrong = 0;
  for (const PairKind kind : {PairKind::node_triangle, PairKind::edge_edge}) {
    for (std::uint64_t id = 0; id < 3000; ++id) {
      const Four x = random_four(id, 0, 1), motion = random_four(id, 1, 1.5);
      Real least = 1e9;
      for (int k = 0; k <= 400; ++k) {
        Four y = x;
        for (std::size_t c = 0; c < 4; ++c) y[c] += (k / 400.0) * motion[c];
        least = std::min(least, gap_of(kind, y).distance);
      }
      const auto hit = swept_gap(kind, x, motion);
      const Real start = gap_of(kind, x).distance;
      stopped += hit ? 1 : 0;
      if (least < 0.05 * start) {
        ++met;
        EXPECT_TRUE(hit.has_value()) << id;
      }
      if (hit) { EXPECT_LT(hit->distance, 0.1 * start); }
      if (least > 0.12 * start) ++early, wrong += hit ? 1 : 0;
    }
  }
  EXPECT_GT(met, 100u);
  EXPECT_GT(stopped, met);
  // Samples at 400 times miss the least distance of a few quick passages.
  EXPECT_LT(wrong, early / 100);
}

TEST(ClosePair, a_common_motion_is_no_approach) {
  Four motion;
  motion.fill({100, -50, 3});
  EXPECT_LT(approach_bound(PairKind::edge_edge, motion), 1e-12);
  motion.fill({20, 0, 0});
  EXPECT_FALSE(swept_gap(PairKind::node_triangle, {Vec3{0, 0, 1e-6}, {-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}, motion));
}

}  // namespace
}  // namespace imbibe
