#include "imbibe/wetting/graph_solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "imbibe/core/parallel.h"
#include "imbibe/core/random.h"

namespace imbibe {
namespace {

// A random column-dominant M-matrix on a chain with links that skip some nodes, `conductance` on the average.
GraphMatrix random_matrix(Index n, std::uint64_t seed, Real conductance = 10) {
  constexpr Index farthest = 37;
  std::vector<std::vector<std::pair<Index, float>>> rows(n);
  GraphMatrix m;
  m.order = order_in_halves(n, farthest);
  m.diagonal.assign(n, 1);
  m.scale.assign(n, 1);
  m.row_start = {0};
  for (Index i = 0; i < n; ++i) {
    for (const Index j : {i + 1, i + 1 + (i * 7 + 3) % farthest}) {
      if (j >= n) continue;
      const auto a = static_cast<Index>(m.order.place(i)), b = static_cast<Index>(m.order.place(j));
      for (const auto& [row, column] : {std::pair{a, b}, std::pair{b, a}}) {
        const auto value = static_cast<float>(-2 * conductance * uniform({.seed = seed, .id = row, .step = column}));
        rows[row].emplace_back(column, value);
        m.diagonal[column] -= value;
      }
    }
  }
  for (auto& row : rows) {
    std::ranges::sort(row);
    for (const auto& [column, value] : row) m.column.push_back(column), m.value.push_back(value);
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

LinearSolve solve(GraphMatrix m, const std::vector<Real>& b, std::vector<Real>& x, Real tolerance, Real floor = 0) {
  LinearWorkspace work;
  x.resize(b.size());
  return solve_bicgstab(m, b, x, tolerance, floor, 300, work);
}

// b - A x
std::vector<Real> left_of(const GraphMatrix& m, const std::vector<Real>& b, const std::vector<Real>& x) {
  std::vector<Real> left = b;
  for (Index i = 0; i < m.rows(); ++i) {
    left[i] -= m.diagonal[i] * x[i];
    for (Index k = m.row_start[i]; k < m.row_start[i + 1]; ++k) left[i] -= m.scale[i] * m.value[k] * x[m.column[k]];
  }
  return left;
}

Real largest(const std::vector<Real>& values) {
  Real most = 0;
  for (const Real value : values) most = std::max(most, std::abs(value));
  return most;
}

std::vector<Real> random_vector(Index n, std::uint64_t seed) {
  std::vector<Real> b(n);
  for (Index i = 0; i < n; ++i) b[i] = uniform({.seed = seed, .id = i}, 9) - 0.5;
  return b;
}

TEST(GraphSolver, AgreesWithDenseElimination) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const GraphMatrix m = random_matrix(60, seed);
    const std::vector<Real> b = random_vector(60, seed), exact = dense_solution(m, b);
    std::vector<Real> x;
    EXPECT_TRUE(solve(m, b, x, 1e-13).converged);
    for (Index i = 0; i < 60; ++i) EXPECT_NEAR(x[i], exact[i], 1e-10);
  }
}

// Long steps: what flows between nodes is many times what they hold.
TEST(GraphSolver, LeavesWhatItSaysHoweverMuchFlows) {
  for (const Real conductance : {1e-2, 1.0, 1e2, 1e4, 1e6, 1e8}) {
    const Index n = 5 * least_block + 100;
    const GraphMatrix m = random_matrix(n, 6, conductance);
    EXPECT_GT(m.order.late, 0);
    const std::vector<Real> b = random_vector(n, 7);
    std::vector<Real> x;
    const LinearSolve solved = solve(m, b, x, 1e-6);
    EXPECT_TRUE(solved.converged) << conductance;
    EXPECT_LE(largest(left_of(m, b, x)), 2 * solved.residual) << conductance;
  }
}

TEST(GraphSolver, DoesNotIterateWhenNothingMoves) {
  const GraphMatrix m = random_matrix(60, 3);
  std::vector<Real> x;
  EXPECT_EQ(solve(m, std::vector<Real>(60, 1e-13), x, 1e-6, 1e-11).iterations, 0);
}

TEST(GraphSolver, LinksNoTwoBlocksOfOneHalf) {
  const std::size_t farthest = 700;
  for (const std::size_t rows : {1, 512, 700, 701, 1399, 1400, 1401, 2800, 2900, 3600}) {
    const RowOrder order = order_in_halves(rows, farthest);
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < rows; ++i) places.push_back(order.place(i));
    const auto block = [&](std::size_t i) {  // number of the block, even in the first half
      return places[i] < order.late ? 2 * (places[i] / order.block) : 2 * ((places[i] - order.late) / order.block) + 1;
    };
    for (std::size_t i = 0; i < rows; ++i) {
      for (const std::size_t j : {i + 1, i + farthest}) {
        if (j >= rows || block(i) == block(j)) continue;
        EXPECT_NE(block(i) % 2, block(j) % 2) << rows << ' ' << i << ' ' << j;
      }
    }
    std::ranges::sort(places);
    for (std::size_t i = 0; i < rows; ++i) ASSERT_EQ(places[i], i);
  }
}

TEST(GraphSolver, GivesTheSameBitsForOneThreadAndForAll) {
  const Index n = 9 * least_block + 100;
  const GraphMatrix m = random_matrix(n, 4);
  const std::vector<Real> b = random_vector(n, 8);
  std::vector<Real> one, all;
  EXPECT_TRUE(solve(m, b, all, 1e-6).converged);
  const ThreadLimit limit(1);
  solve(m, b, one, 1e-6);
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
