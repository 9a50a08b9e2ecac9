// Stretch and bending of whole threads at once: the impulses of all edges (all nodes) of a thread, backward in time.
//
// Stretch, unknowns J_e [J s]:
//   J_e/(dt k_e) + (dt + beta_e) D C'_e = -(C~_e + beta_e C'_e)
//   D C'_e = b_e [(w_i + w_j) b_e J_e - w_i b_(e-1) (d_e . d_(e-1)) J_(e-1) - w_j b_(e+1) (d_e . d_(e+1)) J_(e+1)]
// e edge from node i to node j, b_e 1/length at rest, d_e its direction and C~_e its strain where the velocities would
// carry the nodes in dt, C'_e strain rate, w 1/mass, k_e and beta_e as in impulse.h, D C' what all J change.
// Bending, unknowns the vectors J_i [N s]: the same with the linear form s_i = x_(i-1) - 2 x_i + x_(i+1) for C.
// The matrices have three and five diagonals and are positive, so one sweep down and one up solve them, at about the cost
// of one relaxation of the pieces. Each step of a sweep waits for the one before, so four threads go side by side.
//
// Why: relaxing edges one by one leaves each thread longer by dt^2 times its tension over a nodal mass, which for a cloth
// hung up by an edge asks for substeps of tens of microseconds. Here tension passes through a whole thread in one substep,
// and what is left comes only from the threads that cross it. A second or third pass removes that and what turning edges
// leave, without which stirred cloth gains energy at substeps near a millisecond. Directions are those at the predicted places; that is
// stable while the transverse waves of the tension are resolved,
//   2 dt |J| b^2 (w_i + w_j) < 2                                      (turn, below)
// Threads that the first pass finds tenser than a part of that are solved with their tension in the passes that follow: the
// unknowns are vectors P_e, which resist across the edge too,
//   P_e + E_e D C'_e = T_e d_e - P_e (before),   E_e = dt [(dt + beta_e) k_e d_e d_e^T + dt t_e (1 - d_e d_e^T)]
// T_e = -dt k_e (C~_e + beta_e C'_e), t_e the tension per length of the pass before (0 where pushed): blocks of three in place of
// numbers, positive for any substep, and where passes no longer change anything the same equation J = T.
// Source: direct solution of chains of constraints, Deul et al., Comput. Graph. Forum 37 (2018) 313, for rods.
// Tested in tests/cloth/threads_test.cpp (against a dense solution) and closed_forms_test.cpp.
#pragma once

#include <vector>

#include "imbibe/cloth/impulse.h"
#include "imbibe/cloth/lanes.h"
#include "imbibe/cloth/topology.h"

namespace imbibe {

struct PieceMaterial;

// One edge of each of four threads that are solved side by side.
struct EdgeLanes {
  Reals3 direction;
  Reals upper;         // eliminated upper diagonal
  Reals change;        // right-hand side of a pass, then what it adds to J
  Reals strain;        // that the pass found: C~ + beta C' + J/(dt k)
};

// Work space of the edges, thread by thread.
struct ThreadSolve {
  std::vector<EdgeLanes> edges;      // four threads use the places of the longest of them
  std::vector<Real> impulse;         // J of all passes [J s]
  std::vector<PassOutcome> outcome;  // of each thread
  std::vector<std::uint8_t> tense;   // threads solved with their tension
  std::vector<Vec3> direction, given;  // of tense threads: where the last pass found them, P of all passes
  std::vector<Real> strain;            // of tense threads, as in EdgeLanes
  struct Block {                     // N = (1/E + S)^-1, S what the edges before leave; and the right-hand side
    Vec3 row[3]{}, side{};
  };
  std::vector<Block> block;

  struct BendRow {
    Real diagonal = 0, lower1 = 0, lower2 = 0;  // of the factors L D L^T
    Vec3 side{};                                // right-hand side, then J
  };
  std::vector<BendRow> bend;
};

// One pass: all weft threads, then all warp threads (family by family), from where the passes before left the velocities (new directions, and
// what the warp and contacts did to the weft). begin_ comes before the first pass of a substep.
// Piece: StretchPiece<2> of the fabric, or SpringPiece.
template <class Piece>
void begin_thread_stretch(const ThreadList<Piece>& threads, ThreadSolve& work);
template <class Piece>
PassOutcome solve_thread_stretch(const ThreadList<Piece>& threads, const std::vector<PieceMaterial>& materials,
                                 const NodeMotion& nodes, Real dt, ThreadSolve& work, const PassScope& scope = {});
// Provot's correction (impulse.h) of the springs of all lines but those of flexion, where the pass before solved a line.
void correct_threads(const ThreadList<SpringPiece>& threads, const NodeMotion& nodes, Real limit, Real dt,
                     const ThreadSolve& work);
void solve_thread_bend(const ThreadList<BendPiece<3>>& threads, const std::vector<PieceMaterial>& materials,
                       const NodeMotion& nodes, Real dt, ThreadSolve& work);

}  // namespace imbibe
