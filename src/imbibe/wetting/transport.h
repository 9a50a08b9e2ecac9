// One implicit step of liquid on the network: backward Euler, Newton, and a last update of masses from edge flows.
//
//   V_i (s_i - s_i^n) + dt [sum_j q_ij - q_supply,i + q_release,i] = 0,   |residual| <= residual V_i
//   supply   inflow_i dt = min(law_i(s_i) dt, available_i)                (complementarity, inside the residual)
//   release  q = T max(p_i + rho |g_n| z - P_open,i, 0) to the lower of the faces that no liquid covers, z m below the
//            node; and what stands above s = 1 + delta when the step is done
//
// V_i m3 held at s = 1 (swelling counted), q_ij m3/s. The laws of q_ij: along_yarn.h, crossing.h, capillary.h, entry.h.
// Newton's unknown is Y_i(s_i) = s_i + (dt/V_i) C_i u_i(s_i), each node's own side of its equation (C_i the sum of its
// conductances, u_i its potential): saturation where storage rules, potential where flow does. In s alone full nodes
// would halt one by one at the kink of p(s) at s = 1.
// Only wet nodes, supplied nodes and their neighbours are solved; the set grows when liquid reaches its rim. The final
// masses come from the flows, each computed once per edge, so they add up to rounding whatever the residual, which is
// an error of flows then, far below that of a step in which a twentieth of the liquid changes its node; a node that
// this would leave below zero has its outflows cut to what it holds.
// The maximum principle holds without gravity and supply: at the node of highest pressure every link flows outward.
// Tested in tests/wetting/network_test.cpp, spreading_test.cpp and behaviour_test.cpp.
#pragma once

#include <span>
#include <vector>

#include "imbibe/wetting/graph_solver.h"
#include "imbibe/wetting/wetting_model.h"
#include "imbibe/wetting/wetting_step.h"

namespace imbibe {

struct TransportInput {
  const WettingModel* model = nullptr;
  std::span<const FaceSupply> supplies;
  std::span<const Real> available_kg;  // per supply, left in this call
  Vec3 gravity{};
  const GravityField* field = nullptr;  // in place of `gravity`
  Real dt = 0;
  Real across(Index node) const { return field ? field->across[node] : gravity.z; }
};

struct TransportResult {
  bool converged = false;
  int newton_iterations = 0, linear_iterations = 0;
  std::size_t active_nodes = 0;
  Index hardest_node = 0;   // where `converged` is false: the node farthest from its equation
  Real largest_change = 0;  // of a saturation
  Real moved_share = 0;     // of the liquid in the network: what came to other nodes, in or out
};

// Node numbers of the solved set and everything that is computed on it. Reused between steps; never part of a state.
struct TransportWorkspace {
  // Of a link, from its node a (the lower node number) to b: m3/s, and per saturation of a and b. Single precision is
  // enough for the slopes: both rows of the matrix take them from here, so they still add up.
  struct LinkFlow {
    Real flow = 0;
    float slope_a = 0, slope_b = 0;
  };
  struct LocalSupply {
    std::size_t supply = 0;
    Index node = 0;
    Real flow = 0, slope = 0;           // m3/s into the node
    bool limited = false;
  };
  std::vector<Index> local_of;          // per node: its place in `active`, or no_index
  std::vector<Index> active;
  std::vector<char> at_rim;             // while the set is chosen
  // Per solved node; `height` is rho g z downwards, Pa. In single precision: slopes, what only finds the way to the solution,
  // what is compared only, and the weight of a column as high as half the cloth.
  std::vector<Real> volume, old_saturation, saturation, previous, pressure, potential, height, residual, change, reached,
      curve_entry;
  std::vector<float> pressure_slope, potential_slope, own_share, own_entry, old_pressure, face_head, face_share;
  std::vector<Index> kind;              // per node, as in the model
  std::vector<LinkFlow> links;          // each once
  std::vector<Index> link_kind;         // per link, as in the model
  std::vector<Index> row_link;          // per entry of the matrix: into `links`
  std::vector<LocalSupply> supplies;
  Real redistribution = 1;              // of Kuenzel's diffusivity in this step
  // What the rows were built for: they are kept while the solved set stays the same.
  std::vector<Index> rows_for;
  const WettingModel* rows_of = nullptr;
  std::vector<Real> supply_kg;          // per supply: taken in this step
  GraphMatrix matrix;
  LinearWorkspace linear;
};

// Advances contents.liquid_kg by input.dt, adds to `released` and sets work.supply_kg. On failure (result.converged
// false) contents are unchanged.
TransportResult advance_transport(const TransportInput& input, Contents& contents, TransportWorkspace& work,
                                  std::vector<ReleasedLiquid>& released);

// The largest rate of change of any saturation now, 1/s.
Real largest_saturation_rate(const TransportInput& input, const Contents& contents, TransportWorkspace& work);

}  // namespace imbibe
