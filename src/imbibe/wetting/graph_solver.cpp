#include "imbibe/wetting/graph_solver.h"

#include <algorithm>

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

Real largest_entry(std::span<const Real> a) {
  return parallel_max(a.size(), Real(0), [&](std::size_t begin, std::size_t end) {
    Real largest = 0;
    // A number that is none compares false and stays, so it is seen.
    for (std::size_t i = begin; i < end; ++i) largest = std::abs(a[i]) <= largest ? largest : std::abs(a[i]);
    return largest;
  }, sum_tile);
}

// Pivots of the blocks, inverted: 1/d_i, d_i = a_ii - sum over j < i of a_ij a_ji / d_j.
void factorise(const GraphMatrix& m, std::span<Real> inverse_pivot) {
  parallel_tiles(m.rows(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Real pivot = m.diagonal[i];
      for (Index k = m.row_start[i]; k < m.row_start[i + 1] && m.column[k] < i; ++k) {
        const Index j = m.column[k];
        if (j < begin) continue;
        Real back = 0;
        for (Index n = m.row_start[j + 1]; n-- > m.row_start[j] && m.column[n] >= i;) {
          if (m.column[n] == i) back += m.value[n];
        }
        pivot -= m.scale[i] * m.value[k] * (m.scale[j] * back) * inverse_pivot[j];
      }
      inverse_pivot[i] = 1 / pivot;
    }
  }, factor_block);
}

// x = M^-1 b, block by block.
void apply_factors(const GraphMatrix& m, std::span<const Real> inverse_pivot, std::span<const Real> b, std::span<Real> x) {
  parallel_tiles(x.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Real sum = 0;
      for (Index k = m.row_start[i]; k < m.row_start[i + 1] && m.column[k] < i; ++k) {
        if (m.column[k] >= begin) sum += m.value[k] * x[m.column[k]];
      }
      x[i] = (b[i] - m.scale[i] * sum) * inverse_pivot[i];
    }
    for (std::size_t i = end; i-- > begin;) {
      Real sum = 0;
      for (Index k = m.row_start[i + 1]; k-- > m.row_start[i] && m.column[k] > i;) {
        if (m.column[k] < end) sum += m.value[k] * x[m.column[k]];
      }
      x[i] -= m.scale[i] * sum * inverse_pivot[i];
    }
  }, factor_block);
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
  factorise(matrix, w.inverse_pivot);
  w.r0 = w.r;
  Real rho = 1, alpha = 1, omega = 1;
  while (report.iterations < most_iterations) {
    ++report.iterations;
    const Real next_rho = dot_product(w.r0, w.r);
    if (next_rho == 0 || omega == 0) break;
    const Real beta = next_rho / rho * (alpha / omega);
    rho = next_rho;
    parallel_for(n, [&](std::size_t i) { w.p[i] = w.r[i] + beta * (w.p[i] - omega * w.v[i]); }, sum_tile);
    apply_factors(matrix, w.inverse_pivot, w.p, w.y);
    multiply(matrix, w.y, w.v);
    alpha = rho / dot_product(w.r0, w.v);
    if (!std::isfinite(alpha)) break;
    parallel_for(n, [&](std::size_t i) {  // r is the half-way residual until the end
      x[i] += alpha * w.y[i];
      w.r[i] -= alpha * w.v[i];
    }, sum_tile);
    apply_factors(matrix, w.inverse_pivot, w.r, w.y);
    multiply(matrix, w.y, w.t);
    const Real tt = dot_product(w.t, w.t);
    omega = tt > 0 ? dot_product(w.t, w.r) / tt : 0;
    parallel_for(n, [&](std::size_t i) {
      x[i] += omega * w.y[i];
      w.r[i] -= omega * w.t[i];
    }, sum_tile);
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
