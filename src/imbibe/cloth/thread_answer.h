// What is left of nodes' velocities when the threads resist the stretch that a push over dt would give them.
//
//   w = v - M^-1 G^T l,   (C + G M^-1 G^T) l = G v,   C_e = 1/(dt k_e (dt + beta_e)),   (G v)_e = b_e d_e . (v_j - v_i)
// b, d, k, beta as in threads.h, d where the push begins, l_e impulses [J s]: backward Euler of the stretch that the push adds
// (a linear one: directions and what is stretched already stay as they are). Solved family by family, weft, warp, weft,
// each thread at once (three diagonals), from l = 0. The order reads the same from both ends, so w = S J with S symmetric
// (J = M v impulses), and S is never less than the exact answer: who puts it into the solver of what pushes (SheetContacts)
// keeps that solver's matrix symmetric and positive. Only threads through nodes that are pushed resist.
// Why: a push that nothing resists stores dt^2 k b^2/m times its own energy in stiff threads for a step.
// Source: symmetric block Gauss-Seidel, Saad, Iterative Methods for Sparse Linear Systems, 4.1.
// Tested in tests/cloth/thread_answer_test.cpp: symmetry, momentum, backward Euler where threads do not cross.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "imbibe/cloth/cloth_step.h"
#include "imbibe/cloth/topology.h"

namespace imbibe {

struct PieceMaterial;

class ThreadAnswer {
 public:
  // Threads of a grid sheet (model xpbd) as it lies after a step_cloth of dt, s; `pushed` nodes; inverse_mass: 1/kg per node, 0
  // where held; it must outlive the use. In other sheets nothing resists: springs are soft.
  void begin(const Sheet& sheet, const ClothParams& params, std::span<const Real> inverse_mass,
             std::span<const Index> pushed, Real dt, ClothScratch& scratch);
  bool empty() const { return edges_.empty(); }
  // v, m/s per node: in as the impulses would have it, 0 on nodes that are not pushed; out w. held: N s, what held nodes get from the
  // threads, added to; may be empty.
  void resist(std::span<Vec3> velocity, std::span<Vec3> held = {});
  // Nodes of the threads that resist, and those pushed: only their velocities change.
  std::span<const Index> nodes() const { return nodes_; }

 private:
  struct Edge {
    std::array<Index, 2> node{};
    Vec3 pull{};                         // b d, 1/m
    Real softness = 0;                   // C
    Real lower = 0, inverse_pivot = 0;   // of the factors L D L^T of the thread's matrix
    Real impulse = 0, side = 0;          // l, right-hand side
  };
  void add_edge(const Sheet& sheet, const StretchPiece<2>& piece, const PieceMaterial& material, bool starts_thread);
  void solve_family(std::size_t family, std::span<Vec3> velocity, std::span<Vec3> held);

  Real dt_ = 0;
  std::span<const Real> inverse_mass_;
  std::vector<Edge> edges_;
  std::vector<std::size_t> first_, families_;  // edge of each thread, thread of each family, and the ends
  std::vector<std::uint8_t> pushed_;           // per node of the sheet
  std::vector<Index> nodes_;
};

}  // namespace imbibe
