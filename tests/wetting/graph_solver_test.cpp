#include "imbibe/wetting/graph_solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "imbibe/core/parallel.h"
#include "imbibe/core/random.h"

namespace imbibe {
namespace {

// A random column-dominant M-matrix on a ring with chords.
GraphMatrix random_matrix(Index n, std::uint64_t seed) {
  GraphMatrix m;
  m.diagonal.assign(n, 1);
  m.scale.assign(n, 1);
  m.row_start = {0};
  for (Index i = 0; i < n; ++i) {
    std::array<Index, 3> columns{(i + 1) % n, (i + n - 1) % n, (i * 7 + 3) % n};
    std::ranges::sort(columns);
    for (const Index j : columns) {
      if (j == i) continue;
      const auto value = static_cast<float>(-10 * uniform({.seed = seed, .id = i, .step = j}));
      m.column.push_back(j);
      m.value.push_back(value);
      m.diagonal[j] -= value;
    }
    m.row_start.push_back(static_cast<Index>(m.column.size()));
  }
  return m;
}

std::vector<Real> dense_solution(const GraphMatrix& m, std::vector<Real> b) {
  const std::size_t n = m.rows();
  std::vector<Real> a(n * n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    a[i * n + i] += m.diagonal[i];
    for (Index k = m.row_start[i]; k < m.row_start[i + 1]; ++k) a[i * n + m.column[k]] += m.value[k];
  }
  for (std::size_t c = 0; c < n; ++c) {
    for (std::size_t r = c + 1; r < n; ++r) {
      const Real f = a[r * n + c] / a[c * n + c];
      for (std::size_t k = c; k < n; ++k) a[r * n + k] -= f * a[c * n + k];
      b[r] -= f * b[c];
    }
  }
  for (std::size_t c = n; c-- > 0;) {
    for (std::size_t k = c + 1; k < n; ++k) b[c] -= a[c * n + k] * b[k];
    b[c] /= a[c * n + c];
  }
  return b;
}

TEST(GraphSolver, AgreesWithDenseElimination) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const GraphMatrix m = random_matrix(60, seed);
    std::vector<Real> b(60), x(60);
    for (Index i = 0; i < 60; ++i) b[i] = uniform({.seed = seed, .id = i}, 9) - 0.5;
    LinearWorkspace work;
    EXPECT_TRUE(solve_bicgstab(m, b, x, 1e-13, 0, 300, work).converged);
    const std::vector<Real> exact = dense_solution(m, b);
    for (Index i = 0; i < 60; ++i) EXPECT_NEAR(x[i], exact[i], 1e-10);
  }
}

TEST(GraphSolver, DoesNotIterateWhenNothingMoves) {
  const GraphMatrix m = random_matrix(60, 3);
  std::vector<Real> b(60, 1e-13), x(60);
  LinearWorkspace work;
  EXPECT_EQ(solve_bicgstab(m, b, x, 1e-6, 1e-11, 300, work).iterations, 0);
}

TEST(GraphSolver, GivesTheSameBitsForOneThreadAndForAll) {
  const Index n = 3 * factor_block + 100;
  const GraphMatrix m = random_matrix(n, 4);
  std::vector<Real> b(n), one(n), all(n);
  for (Index i = 0; i < n; ++i) b[i] = uniform({.seed = 8, .id = i}) - 0.5;
  LinearWorkspace work;
  EXPECT_TRUE(solve_bicgstab(m, b, all, 1e-10, 0, 300, work).converged);
  const ThreadLimit limit(1);
  solve_bicgstab(m, b, one, 1e-10, 0, 300, work);
  EXPECT_TRUE(std::ranges::equal(one, all));
}

TEST(Newton, LandsAtTheKinkAndStaysAboveZero) {
  EXPECT_DOUBLE_EQ(limited_saturation(0.9, 0.25), 1 + kink_landing);
  EXPECT_DOUBLE_EQ(limited_saturation(1.1, -0.25), 1 - kink_landing);
  EXPECT_DOUBLE_EQ(limited_saturation(0.2, 5), 0.5);
  EXPECT_DOUBLE_EQ(limited_saturation(0.2, -5), 0.02);
  EXPECT_EQ(limited_saturation(0, -1), 0);
  EXPECT_DOUBLE_EQ(damped_saturation(0.01, 0.3, 0.04), 0.02);
  EXPECT_DOUBLE_EQ(damped_saturation(0.01, 0.02, 0.04), 0.03);
}

}  // namespace
}  // namespace imbibe
