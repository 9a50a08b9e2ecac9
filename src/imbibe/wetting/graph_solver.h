// Sparse linear systems on a graph, and the rules that keep Newton's method inside the physics.
//
// Solver: BiCGSTAB (van der Vorst 1992) with an incomplete factorisation of fixed blocks of rows that changes the
// diagonal only, M = (D + L) D^-1 (D + U), L and U those of the matrix itself (DILU; Pommerell 1992): it keeps one number
// a row where ILU(0) keeps the matrix over again. The matrices are column-dominant M-matrices (backward Euler of
// conservative flows), for which both exist.
// Stops at `tolerance` times the right-hand side, or at `floor` absolute: with a relative test alone a system at rest
// (right-hand side zero) would iterate on rounding. Blocks are fixed, sums are added tile by tile: the same bits for
// any number of threads.
// Damped Newton, the fallback of transport.cpp: a saturation moves by at most 0.3, stays above 0 by shrinking, does not
// run to and fro, and lands at the kink s = 1 (where the slope of p(s) jumps by two orders) before it crosses.
// Tested in tests/wetting/graph_solver_test.cpp against dense elimination.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "imbibe/core/types.h"

namespace imbibe {

// Compressed sparse rows, their columns rising (equal ones allowed); the diagonal is held apart. The entry in row i is
// scale[i] * value[k]: the slopes of a flow are single numbers that stand in two rows, so in single precision the columns
// still add up, which rounded products would not (long steps live on that), and half as much is read.
struct GraphMatrix {
  std::vector<Index> row_start;  // rows + 1
  std::vector<Index> column;
  std::vector<float> value;
  std::vector<Real> scale;       // per row
  std::vector<Real> diagonal;
  std::size_t rows() const { return diagonal.size(); }
};

void multiply(const GraphMatrix& matrix, std::span<const Real> x, std::span<Real> result);

inline constexpr std::size_t factor_block = 4096;  // rows; entries between blocks stay out of the factors

struct LinearSolve {
  int iterations = 0;
  bool converged = false;
  Real residual = 0;  // largest entry of |b - A x|
};

// The entries of a row that belong to its block: [first, middle) before the diagonal, [middle, last) after it.
struct BlockRow {
  Index first = 0, middle = 0, last = 0;
};

// Scratch of the solver; reused between solves.
struct LinearWorkspace {
  std::vector<BlockRow> rows;
  std::vector<Real> inverse_pivot;
  std::vector<Real> r, r0, p, v, t, y;
};

LinearSolve solve_bicgstab(const GraphMatrix& matrix, std::span<const Real> right_hand_side, std::span<Real> x,
                           Real tolerance, Real floor, int most_iterations, LinearWorkspace& work);

inline constexpr Real largest_newton_change = 0.3;
inline constexpr Real kink_landing = 1e-3;

// The saturation after Newton's `change`, by the rules above.
constexpr Real limited_saturation(Real saturation, Real change) {
  Real next = saturation + (change > largest_newton_change    ? largest_newton_change
                            : change < -largest_newton_change ? -largest_newton_change
                                                              : change);
  if (saturation < 1 && next > 1 + kink_landing) next = 1 + kink_landing;
  if (saturation > 1 && next < 1 - kink_landing) next = 1 - kink_landing;
  const Real least = 0.1 * saturation;
  return next > least ? next : least;
}

// As above; where the step would run back past `previous` (the iterate before), it goes to their geometric mean
// instead: laws that are flat on one side of a bend and steep on the other would send Newton to and fro.
inline Real damped_saturation(Real saturation, Real change, Real previous) {
  const Real next = limited_saturation(saturation, change);
  const bool turned = (saturation - previous) * (next - saturation) < 0;
  const bool past = turned && (saturation < previous ? next >= previous : next <= previous);
  return past && previous > 0 && saturation > 0 ? std::sqrt(saturation * previous) : next;
}

}  // namespace imbibe
