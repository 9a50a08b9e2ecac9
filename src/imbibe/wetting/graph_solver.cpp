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
      IMBIBE_ASSERT(m.row_start[i + 1] - first < BlockFactors::dropped);
      std::uint16_t* columns = f.column.data() + first;
      std::uint16_t last = 0;
      for (Index k = first; k < m.row_start[i + 1]; ++k) {
        if (m.column[k] < begin || m.column[k] >= end) continue;
        const auto column = static_cast<std::uint16_t>(m.column[k] - begin);
        std::uint16_t at = last;
        while (at > 0 && columns[at - 1] > column) --at;
        if (at > 0 && columns[at - 1] == column) continue;
        std::copy_backward(columns + at, columns + last, columns + last + 1);
        ++last;
        columns[at] = column;
      }
      for (Index k = first; k < m.row_start[i + 1]; ++k) {
        const std::uint16_t* at = columns + last;
        if (m.column[k] >= begin && m.column[k] < end) at = std::find(columns, columns + last, m.column[k] - begin);
        f.place[k] = at == columns + last ? BlockFactors::dropped : static_cast<std::uint16_t>(at - columns);
      }
      f.first[i] = first, f.last[i] = last, f.upper[i] = 0;
      while (f.upper[i] < last && columns[f.upper[i]] < i - begin) ++f.upper[i];
    }
  }, factor_block);
  f.pattern = m.pattern;
}

// Incomplete factors of one block of rows, in place.
void factorise_block(BlockFactors& f, std::size_t begin, std::size_t end) {
  std::array<Index, factor_block> place;
  std::fill_n(place.begin(), end - begin, no_index);
  for (std::size_t i = begin; i < end; ++i) {
    const Index first = f.first[i], upper = first + f.upper[i], last = first + f.last[i];
    for (Index k = first; k < last; ++k) place[f.column[k]] = k;
    for (Index k = first; k < upper; ++k) {
      const std::size_t j = begin + f.column[k];
      const Real lower = f.value[k] *= f.inverse_diagonal[j];
      for (Index n = f.first[j] + f.upper[j]; n < f.first[j] + f.last[j]; ++n) {
        const std::size_t c = f.column[n];
        if (begin + c == i) {
          f.inverse_diagonal[i] -= lower * f.value[n];
        } else if (place[c] != no_index) {
          f.value[place[c]] -= lower * f.value[n];
        }
      }
    }
    for (Index k = first; k < last; ++k) place[f.column[k]] = no_index;
    f.inverse_diagonal[i] = 1 / f.inverse_diagonal[i];
  }
}

void factorise(const GraphMatrix& m, BlockFactors& f) {
  if (m.pattern == 0 || f.pattern != m.pattern) find_places(m, f);
  parallel_tiles(m.rows(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      f.inverse_diagonal[i] = m.diagonal[i];
      const Index first = f.first[i];
      for (Index k = first; k < first + f.last[i]; ++k) f.value[k] = 0;
      for (Index k = m.row_start[i]; k < m.row_start[i + 1]; ++k) {
        if (f.place[k] != BlockFactors::dropped) f.value[first + f.place[k]] += m.value[k];
      }
    }
    factorise_block(f, begin, end);
  }, factor_block);
}

// x = (L U)^-1 b, block by block.
void apply_factors(const BlockFactors& f, std::span<const Real> b, std::span<Real> x) {
  parallel_tiles(x.size(), [&](std::size_t begin, std::size_t end) {
    Real* own = x.data() + begin;
    for (std::size_t i = begin; i < end; ++i) {
      Real sum = b[i];
      const Index first = f.first[i], upper = first + f.upper[i];
      for (Index k = first; k < upper; ++k) sum -= f.value[k] * own[f.column[k]];
      x[i] = sum;
    }
    for (std::size_t i = end; i-- > begin;) {
      Real sum = x[i];
      const Index upper = f.first[i] + f.upper[i], last = f.first[i] + f.last[i];
      for (Index k = upper; k < last; ++k) sum -= f.value[k] * own[f.column[k]];
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
  for (auto* vector : {&w.r, &w.r0, &w.p, &w.v, &w.t, &w.y}) vector->assign(n, 0);
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
    parallel_for(n, [&](std::size_t i) {  // r is the half-way residual until the end
      x[i] += alpha * w.y[i];
      w.r[i] -= alpha * w.v[i];
    }, sum_tile);
    apply_factors(w.factors, w.r, w.y);
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
