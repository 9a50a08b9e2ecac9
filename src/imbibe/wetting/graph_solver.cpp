#include "imbibe/wetting/graph_solver.h"

#include <algorithm>

#include "imbibe/core/parallel.h"

namespace imbibe {
namespace {

constexpr std::size_t sum_tile = 16384;

Real dot_product(std::span<const Real> a, std::span<const Real> b) {
  return parallel_sum(a.size(), [&](std::size_t begin, std::size_t end) {
    Real sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += a[i] * b[i];
    return sum;
  }, sum_tile);
}

Real largest_entry(std::span<const Real> a) {
  Real largest = 0;
  for (const Real value : a) largest = std::max(largest, std::abs(value));
  return largest;
}

// Incomplete factors of one block of rows, in place (columns of a row ascending). The stored diagonal is its inverse.
void factorise_block(GraphMatrix& m, std::size_t begin, std::size_t end, std::vector<Index>& place) {
  for (std::size_t i = begin; i < end; ++i) {
    for (Index k = m.row_start[i]; k < m.row_start[i + 1]; ++k) place[m.column[k] - begin] = k;
    for (Index k = m.row_start[i]; k < m.row_start[i + 1]; ++k) {
      const Index j = m.column[k];
      if (j >= i) break;
      const Real lower = m.value[k] *= m.diagonal[j];
      for (Index n = m.row_start[j]; n < m.row_start[j + 1]; ++n) {
        const Index c = m.column[n];
        if (c < j) continue;
        if (c == i) {
          m.diagonal[i] -= lower * m.value[n];
        } else if (place[c - begin] != no_index) {
          m.value[place[c - begin]] -= lower * m.value[n];
        }
      }
    }
    for (Index k = m.row_start[i]; k < m.row_start[i + 1]; ++k) place[m.column[k] - begin] = no_index;
    m.diagonal[i] = 1 / m.diagonal[i];
  }
}

// The matrix without entries between blocks, each row's columns ascending, factorised.
void factorise(const GraphMatrix& matrix, GraphMatrix& factors) {
  const std::size_t n = matrix.rows();
  factors.row_start.resize(n + 1);
  factors.row_start[0] = 0;
  factors.column.resize(matrix.column.size());
  factors.value.resize(matrix.value.size());
  factors.diagonal = matrix.diagonal;
  Index filled = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t block = i / factor_block;
    const Index first = filled;
    for (Index k = matrix.row_start[i]; k < matrix.row_start[i + 1]; ++k) {
      if (matrix.column[k] / factor_block != block) continue;
      // Insertion keeps columns ascending; parallel links between the same two nodes are added up.
      Index at = filled;
      while (at > first && factors.column[at - 1] > matrix.column[k]) --at;
      if (at > first && factors.column[at - 1] == matrix.column[k]) {
        factors.value[at - 1] += matrix.value[k];
        continue;
      }
      for (Index m = filled; m > at; --m) {
        factors.column[m] = factors.column[m - 1];
        factors.value[m] = factors.value[m - 1];
      }
      factors.column[at] = matrix.column[k];
      factors.value[at] = matrix.value[k];
      ++filled;
    }
    factors.row_start[i + 1] = filled;
  }
  parallel_tiles(n, [&](std::size_t begin, std::size_t end) {
    std::vector<Index> place(end - begin, no_index);
    factorise_block(factors, begin, end, place);
  }, factor_block);
}

// x = (L U)^-1 b, block by block.
void apply_factors(const GraphMatrix& m, std::span<const Real> b, std::span<Real> x) {
  parallel_tiles(m.rows(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Real sum = b[i];
      for (Index k = m.row_start[i]; k < m.row_start[i + 1] && m.column[k] < i; ++k) sum -= m.value[k] * x[m.column[k]];
      x[i] = sum;
    }
    for (std::size_t i = end; i-- > begin;) {
      Real sum = x[i];
      for (Index k = m.row_start[i + 1]; k-- > m.row_start[i] && m.column[k] > i;) sum -= m.value[k] * x[m.column[k]];
      x[i] = sum * m.diagonal[i];
    }
  }, factor_block);
}

}  // namespace

void multiply(const GraphMatrix& m, std::span<const Real> x, std::span<Real> result) {
  parallel_for(m.rows(), [&](std::size_t i) {
    Real sum = m.diagonal[i] * x[i];
    for (Index k = m.row_start[i]; k < m.row_start[i + 1]; ++k) sum += m.value[k] * x[m.column[k]];
    result[i] = sum;
  }, factor_block / 2);
}

LinearSolve solve_bicgstab(const GraphMatrix& matrix, std::span<const Real> right_hand_side, std::span<Real> x,
                           Real tolerance, Real floor, int most_iterations, LinearWorkspace& w) {
  const std::size_t n = matrix.rows();
  LinearSolve report;
  for (auto* vector : {&w.r, &w.r0, &w.p, &w.v, &w.s, &w.t, &w.y, &w.z}) vector->assign(n, 0);
  std::fill(x.begin(), x.end(), 0);
  std::copy(right_hand_side.begin(), right_hand_side.end(), w.r.begin());
  report.residual = largest_entry(w.r);
  const Real wanted = std::max(floor, tolerance * report.residual);
  if (report.residual <= wanted) {
    report.converged = true;
    return report;
  }
  factorise(matrix, w.factors);
  w.r0 = w.r;
  Real rho = 1, alpha = 1, omega = 1;
  while (report.iterations < most_iterations) {
    ++report.iterations;
    const Real next_rho = dot_product(w.r0, w.r);
    if (next_rho == 0 || omega == 0) break;
    const Real beta = next_rho / rho * (alpha / omega);
    rho = next_rho;
    for (std::size_t i = 0; i < n; ++i) w.p[i] = w.r[i] + beta * (w.p[i] - omega * w.v[i]);
    apply_factors(w.factors, w.p, w.y);
    multiply(matrix, w.y, w.v);
    alpha = rho / dot_product(w.r0, w.v);
    if (!std::isfinite(alpha)) break;
    for (std::size_t i = 0; i < n; ++i) w.s[i] = w.r[i] - alpha * w.v[i];
    apply_factors(w.factors, w.s, w.z);
    multiply(matrix, w.z, w.t);
    const Real tt = dot_product(w.t, w.t);
    omega = tt > 0 ? dot_product(w.t, w.s) / tt : 0;
    for (std::size_t i = 0; i < n; ++i) x[i] += alpha * w.y[i] + omega * w.z[i];
    for (std::size_t i = 0; i < n; ++i) w.r[i] = w.s[i] - omega * w.t[i];
    report.residual = largest_entry(w.r);
    if (!std::isfinite(report.residual)) break;
    if (report.residual <= wanted) {
      report.converged = true;
      break;
    }
  }
  return report;
}

}  // namespace imbibe
