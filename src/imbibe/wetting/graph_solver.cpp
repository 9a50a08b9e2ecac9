#include "imbibe/wetting/graph_solver.h"

#include <algorithm>
#include <array>

#include "imbibe/core/error.h"
#include "imbibe/core/parallel.h"

namespace imbibe {
namespace {

constexpr std::size_t sum_tile = 4096;

Real dot_product(std::span<const Real> a, std::span<const Real> b) {
  return parallel_sum(a.size(), [&](std::size_t begin, std::size_t end) {
    Real sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += a[i] * b[i];
    return sum;
  }, sum_tile);
}

// A number that is none compares false and stays, so it is seen.
Real largest_between(std::span<const Real> a, std::size_t begin, std::size_t end) {
  Real largest = 0;
  for (std::size_t i = begin; i < end; ++i) largest = std::abs(a[i]) <= largest ? largest : std::abs(a[i]);
  return largest;
}

Real largest_entry(std::span<const Real> a) {
  return parallel_max(a.size(), Real(0), [&](std::size_t begin, std::size_t end) { return largest_between(a, begin, end); },
                      sum_tile);
}

struct Block {
  std::size_t begin = 0, end = 0;
};

// In a block each row waits for the one before it, some 25 cycles on end; rows of other blocks can be worked out meanwhile.
// So a thread takes two blocks row by row in turn. What comes out is the same. More hide the wait better while all is in the
// caches (10 % of a step at 10^4 nodes), but are too many streams to fetch ahead: at 10^6 nodes a step of four in turn took 1.4
// times as long, one of eight 1.6 times.
constexpr std::size_t most_in_turn = 2;

// Calls each(block, row) for the rows of all blocks, from first to last in each, then back(block, row) from last to first.
template <class Each, class Back>
void for_rows_of_blocks(std::size_t rows, Each&& each, Back&& back) {
  const std::size_t blocks = (rows + factor_block - 1) / factor_block;
  const auto threads = static_cast<std::size_t>(std::max(1, available_threads()));
  parallel_tiles(blocks, [&](std::size_t first, std::size_t last) {
    std::array<Block, most_in_turn> turn;
    const std::size_t count = last - first;
    for (std::size_t k = 0; k < count; ++k)
      turn[k] = {(first + k) * factor_block, std::min(rows, (first + k + 1) * factor_block)};
    const std::size_t longest = turn[0].end - turn[0].begin;  // only the last of all blocks may be shorter
    for (std::size_t r = 0; r < longest; ++r)
      for (std::size_t k = 0; k < count; ++k)
        if (turn[k].begin + r < turn[k].end) each(turn[k], turn[k].begin + r);
    for (std::size_t r = 1; r <= longest; ++r)
      for (std::size_t k = 0; k < count; ++k)
        if (turn[k].begin + r <= turn[k].end) back(turn[k], turn[k].end - r);
  }, std::clamp<std::size_t>((blocks + threads - 1) / threads, 1, most_in_turn));
}

// Pivots of the blocks, inverted: 1/d_i, d_i = a_ii - sum over j < i of a_ij a_ji / d_j. And where in each row the entries
// before and after the diagonal stand that belong to its block.
void factorise(const GraphMatrix& m, std::span<Real> inverse_pivot, std::span<BlockRow> rows) {
  for_rows_of_blocks(m.rows(), [&](const Block& block, std::size_t i) {
    BlockRow& row = rows[i];
    Index k = m.row_start[i];
    const Index end = m.row_start[i + 1];
    while (k < end && m.column[k] < block.begin) ++k;
    row.first = k;
    while (k < end && m.column[k] < i) ++k;
    row.middle = k;
    while (k < end && m.column[k] < block.end) ++k;
    row.last = k;
    Real pivot = m.diagonal[i];
    for (k = row.first; k < row.middle; ++k) {
      const Index j = m.column[k];
      Real back = 0;
      for (Index n = m.row_start[j + 1]; n-- > m.row_start[j] && m.column[n] >= i;) {
        if (m.column[n] == i) back += m.value[n];
      }
      pivot -= m.scale[i] * m.value[k] * (m.scale[j] * back) * inverse_pivot[j];
    }
    inverse_pivot[i] = 1 / pivot;
  }, [](const Block&, std::size_t) {});
}

// x = M^-1 b, block by block.
void apply_factors(const GraphMatrix& m, const LinearWorkspace& w, std::span<const Real> b, std::span<Real> x) {
  for_rows_of_blocks(x.size(), [&](const Block&, std::size_t i) {
    Real sum = 0;
    for (Index k = w.rows[i].first; k < w.rows[i].middle; ++k) sum += m.value[k] * x[m.column[k]];
    x[i] = (b[i] - m.scale[i] * sum) * w.inverse_pivot[i];
  }, [&](const Block&, std::size_t i) {
    Real sum = 0;
    for (Index k = w.rows[i].last; k-- > w.rows[i].middle;) sum += m.value[k] * x[m.column[k]];
    x[i] -= m.scale[i] * sum * w.inverse_pivot[i];
  });
}

}  // namespace

void multiply(const GraphMatrix& m, std::span<const Real> x, std::span<Real> result) {
  parallel_for(m.rows(), [&](std::size_t i) {
    Real sum = 0;
    for (Index k = m.row_start[i]; k < m.row_start[i + 1]; ++k) sum += m.value[k] * x[m.column[k]];
    result[i] = m.diagonal[i] * x[i] + m.scale[i] * sum;
  }, factor_block / 2);
}

LinearSolve solve_bicgstab(const GraphMatrix& matrix, std::span<const Real> right_hand_side, std::span<Real> x,
                           Real tolerance, Real floor, int most_iterations, LinearWorkspace& w) {
  const std::size_t n = matrix.rows();
  LinearSolve report;
  for (auto* vector : {&w.r, &w.r0, &w.p, &w.v, &w.t, &w.y}) vector->assign(n, 0);
  std::fill(x.begin(), x.end(), 0);
  std::copy(right_hand_side.begin(), right_hand_side.end(), w.r.begin());
  report.residual = largest_entry(w.r);
  const Real wanted = std::max(floor, tolerance * report.residual);
  if (report.residual <= wanted) {
    report.converged = true;
    return report;
  }
  w.inverse_pivot.resize(n);
  w.rows.resize(n);
  factorise(matrix, w.inverse_pivot, w.rows);
  w.r0 = w.r;
  Real rho = 1, alpha = 1, omega = 1;
  while (report.iterations < most_iterations) {
    ++report.iterations;
    const Real next_rho = dot_product(w.r0, w.r);
    if (next_rho == 0 || omega == 0) break;
    const Real beta = next_rho / rho * (alpha / omega);
    rho = next_rho;
    parallel_for(n, [&](std::size_t i) { w.p[i] = w.r[i] + beta * (w.p[i] - omega * w.v[i]); }, sum_tile);
    apply_factors(matrix, w, w.p, w.y);
    multiply(matrix, w.y, w.v);
    alpha = rho / dot_product(w.r0, w.v);
    if (!std::isfinite(alpha)) break;
    parallel_for(n, [&](std::size_t i) {  // r is the half-way residual until the end
      x[i] += alpha * w.y[i];
      w.r[i] -= alpha * w.v[i];
    }, sum_tile);
    apply_factors(matrix, w, w.r, w.y);
    multiply(matrix, w.y, w.t);
    const Real tt = dot_product(w.t, w.t);
    omega = tt > 0 ? dot_product(w.t, w.r) / tt : 0;
    report.residual = parallel_max(n, Real(0), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        x[i] += omega * w.y[i];
        w.r[i] -= omega * w.t[i];
      }
      return largest_between(w.r, begin, end);
    }, sum_tile);
    if (!std::isfinite(report.residual)) break;
    if (report.residual <= wanted) {
      report.converged = true;
      break;
    }
  }
  return report;
}

}  // namespace imbibe
