#include "imbibe/wetting/graph_solver.h"

#include <algorithm>
#include <array>

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

// Where each entry of the matrix stands in the factors: rows keep their places, entries between blocks drop out, columns
// ascend, parallel links between the same two nodes share one entry.
void find_places(const GraphMatrix& m, BlockFactors& f) {
  const std::size_t n = m.rows();
  f.first.resize(n), f.upper.resize(n), f.last.resize(n);
  f.column.resize(m.column.size()), f.value.resize(m.column.size()), f.place.resize(m.column.size());
  f.inverse_diagonal.resize(n);
  parallel_tiles(n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Index first = m.row_start[i];
      Index last = first;
      for (Index k = first; k < m.row_start[i + 1]; ++k) {
        const Index column = m.column[k];
        if (column < begin || column >= end) continue;
        Index at = last;
        while (at > first && f.column[at - 1] > column) --at;
        if (at > first && f.column[at - 1] == column) continue;
        for (Index j = last++; j > at; --j) f.column[j] = f.column[j - 1];
        f.column[at] = column;
      }
      for (Index k = first; k < m.row_start[i + 1]; ++k) {
        const auto end_of_row = f.column.begin() + last;
        const auto at = std::find(f.column.begin() + first, end_of_row, m.column[k]);
        f.place[k] = at == end_of_row ? no_index : static_cast<Index>(at - f.column.begin());
      }
      f.first[i] = first, f.last[i] = last, f.upper[i] = first;
      while (f.upper[i] < last && f.column[f.upper[i]] < i) ++f.upper[i];
    }
  }, factor_block);
  f.pattern = m.pattern;
}

// Incomplete factors of one block of rows, in place.
void factorise_block(BlockFactors& f, std::size_t begin, std::size_t end) {
  std::array<Index, factor_block> place;
  std::fill_n(place.begin(), end - begin, no_index);
  for (std::size_t i = begin; i < end; ++i) {
    for (Index k = f.first[i]; k < f.last[i]; ++k) place[f.column[k] - begin] = k;
    for (Index k = f.first[i]; k < f.upper[i]; ++k) {
      const Index j = f.column[k];
      const Real lower = f.value[k] *= f.inverse_diagonal[j];
      for (Index n = f.upper[j]; n < f.last[j]; ++n) {
        const Index c = f.column[n];
        if (c == i) {
          f.inverse_diagonal[i] -= lower * f.value[n];
        } else if (place[c - begin] != no_index) {
          f.value[place[c - begin]] -= lower * f.value[n];
        }
      }
    }
    for (Index k = f.first[i]; k < f.last[i]; ++k) place[f.column[k] - begin] = no_index;
    f.inverse_diagonal[i] = 1 / f.inverse_diagonal[i];
  }
}

void factorise(const GraphMatrix& m, BlockFactors& f) {
  if (m.pattern == 0 || f.pattern != m.pattern) find_places(m, f);
  parallel_tiles(m.rows(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      f.inverse_diagonal[i] = m.diagonal[i];
      for (Index k = f.first[i]; k < f.last[i]; ++k) f.value[k] = 0;
      for (Index k = m.row_start[i]; k < m.row_start[i + 1]; ++k) {
        if (f.place[k] != no_index) f.value[f.place[k]] += m.value[k];
      }
    }
    factorise_block(f, begin, end);
  }, factor_block);
}

// x = (L U)^-1 b, block by block.
void apply_factors(const BlockFactors& f, std::span<const Real> b, std::span<Real> x) {
  parallel_tiles(x.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Real sum = b[i];
      for (Index k = f.first[i]; k < f.upper[i]; ++k) sum -= f.value[k] * x[f.column[k]];
      x[i] = sum;
    }
    for (std::size_t i = end; i-- > begin;) {
      Real sum = x[i];
      for (Index k = f.last[i]; k-- > f.upper[i];) sum -= f.value[k] * x[f.column[k]];
      x[i] = sum * f.inverse_diagonal[i];
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
    parallel_for(n, [&](std::size_t i) { w.p[i] = w.r[i] + beta * (w.p[i] - omega * w.v[i]); }, sum_tile);
    apply_factors(w.factors, w.p, w.y);
    multiply(matrix, w.y, w.v);
    alpha = rho / dot_product(w.r0, w.v);
    if (!std::isfinite(alpha)) break;
    parallel_for(n, [&](std::size_t i) { w.s[i] = w.r[i] - alpha * w.v[i]; }, sum_tile);
    apply_factors(w.factors, w.s, w.z);
    multiply(matrix, w.z, w.t);
    const Real tt = dot_product(w.t, w.t);
    omega = tt > 0 ? dot_product(w.t, w.s) / tt : 0;
    parallel_for(n, [&](std::size_t i) {
      x[i] += alpha * w.y[i] + omega * w.z[i];
      w.r[i] = w.s[i] - omega * w.t[i];
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
