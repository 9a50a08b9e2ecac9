// Sparse linear systems on a graph, and the rules that keep Newton's method inside the physics.
//
// Solver: BiCGSTAB (van der Vorst 1992) with an incomplete factorisation that changes the diagonal only,
// M = (D + L) D^-1 (D + U), L and U those of the matrix itself (DILU; Pommerell 1992): it keeps one number a row where
// ILU(0) keeps the matrix over again. The matrices are column-dominant M-matrices (backward Euler of conservative flows),
// for which both exist. Half of M stands on either side of the matrix, and since A = (D + L) + (D + U) + (A_d - 2 D),
//   (D + L)^-1 A (D + U)^-1 p = z + (D + L)^-1 [p + (A_d - 2 D) z],   z = (D + U)^-1 p
// costs no more than solving with M (Eisenstat 1981): each entry is read once. Here all of it is divided by D.
// The residual that it sees is (I + L D^-1)^-1 (b - A x). It stops where the largest entry of that is `tolerance` times
// what it was, or `floor` absolute: with a relative test alone a system at rest (right-hand side zero) would iterate on
// rounding. Blocks belong to the matrix, sums are added tile by tile: the same bits for any number of threads.
// Damped Newton, the fallback of transport.cpp: a saturation moves by at most 0.3, stays above 0 by shrinking, does not
// run to and fro, and lands at the kink s = 1 (where the slope of p(s) jumps by two orders) before it crosses.
// Tested in tests/wetting/graph_solver_test.cpp against dense elimination.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "imbibe/core/types.h"

namespace imbibe {

inline constexpr std::size_t least_block = 512;  // rows

// An order of rows for factors that are worked out in parallel: blocks as long as the farthest link, every second of them
// first, then those between. So each block is linked to blocks of the other half only, which do not wait for each other,
// and every link stays in the factors: left out between blocks, links cost half as many iterations again.
struct RowOrder {
  std::size_t block = 0;  // rows
  std::size_t late = 0;   // the first row of the second half
  std::size_t place(std::size_t row) const {
    const std::size_t number = row / block;
    return (number % 2 == 1 ? late : 0) + number / 2 * block + row % block;
  }
};
constexpr RowOrder order_in_halves(std::size_t rows, std::size_t farthest_link) {
  const std::size_t block = farthest_link > least_block ? farthest_link : least_block;
  const std::size_t whole = rows / block, rest = rows % block;
  return {block, (whole + 1) / 2 * block + (whole % 2 == 0 ? rest : 0)};
}

// Compressed sparse rows: columns before the row itself, then those after it; the diagonal is held apart. The entry in row i is
// scale[i] * value[k]: the slopes of a flow are single numbers that stand in two rows, so in single precision the columns
// still add up, which rounded products would not (long steps live on that), and half as much is read.
struct GraphMatrix {
  std::vector<Index> row_start;  // rows + 1
  std::vector<Index> column;
  std::vector<float> value;
  std::vector<Real> scale;       // per row
  std::vector<Real> diagonal;
  RowOrder order;                // that the rows are in: no link between two blocks of one half
  std::size_t rows() const { return diagonal.size(); }
};

struct LinearSolve {
  int iterations = 0;
  bool converged = false;
  Real residual = 0;  // as above
};

// Scratch of the solver; reused between solves.
struct LinearWorkspace {
  std::vector<Index> after;  // per row: its first entry beyond the diagonal
  std::vector<Real> pivot;
  std::vector<Real> r, r0, p, v, t, z;
};

// Puts its factors in the place of the matrix's scale and diagonal.
LinearSolve solve_bicgstab(GraphMatrix& matrix, std::span<const Real> right_hand_side, std::span<Real> x,
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
