// One step of a textile's wetting: sorption, transport on the network, evaporation; implicit, mass exact.
//
// Order: sorption over half the step, vapour exchange, transport (backward Euler and Newton on all wet nodes), sorption
// over the other half. Transport takes liquid from `supplies` by complementarity: inflow = min(law x dt, available)
// stands inside the equations, so nothing is rescaled afterwards. A step that does not converge is cut and repeated
// inside; masses are updated from edge flows only, so they add up to rounding whatever the tolerance.
// Tested in tests/wetting/network_test.cpp, spreading_test.cpp and behaviour_test.cpp.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "imbibe/wetting/contents.h"
#include "imbibe/wetting/wetting_model.h"

namespace imbibe {

// Liquid that left a node to the outside because its pressure passed P_open; the caller owns it now.
struct ReleasedLiquid {
  Index node = 0;
  Real kg = 0;
  Real excess_pressure = 0;  // Pa, of the node at the face where it is highest, above what opens that face
  Real flow = 0;             // m3/s that this excess drives through the mouth
};

// Gravity where the sheet is not flat, per node: the potential g.x of its place in the world (m2/s2), and the part of g
// along the face's normal there (m/s2).
struct GravityField {
  std::span<const Real> potential, across;
};

inline constexpr Real longest_wetting_step = 300;  // s, of a suggested step

struct WettingReport {
  Real advanced_s = 0;          // how far it came; = dt unless `converged` is false
  bool converged = true;
  Real evaporated_kg = 0;       // to the air; negative when fibres took vapour up on balance
  Real taken_kg = 0;            // from all supplies, net
  std::vector<ReleasedLiquid> released;
  int newton_iterations = 0, linear_iterations = 0;
  int substeps = 0, rejected = 0;
  std::size_t active_nodes = 0; // most nodes in one solve
  Index hardest_node = 0;       // of the last attempt that failed: the node farthest from its equation
  Real largest_change = 0;      // of saturation in one substep
  Real suggested_step = 0;      // s, for the next call: by what moves, what dries, and how hard it was to solve
};

// Memory of the solver, kept from step to step; never part of a state, the results do not depend on it. One for each
// textile keeps the rows of the equations while the same nodes are wet.
struct WettingScratch {
  WettingScratch();
  ~WettingScratch();
  WettingScratch(WettingScratch&&) noexcept;
  WettingScratch& operator=(WettingScratch&&) noexcept;
  struct Parts;
  std::unique_ptr<Parts> parts;
};

// Advances `contents` by dt. taken_kg[i] (same length as supplies) is set to what supply i gave, >= 0, or was given
// back, < 0; it never exceeds available_kg. `gravity` in sheet coordinates, m/s2;
// `field`, when given, takes its place.
WettingReport step_wetting(const WettingModel& model, Contents& contents, std::span<const FaceSupply> supplies,
                           std::span<Real> taken_kg, const Air& air, const Vec3& gravity, Real dt,
                           WettingScratch& scratch, const GravityField* field = nullptr);
WettingReport step_wetting(const WettingModel& model, Contents& contents, std::span<const FaceSupply> supplies,
                           std::span<Real> taken_kg, const Air& air, const Vec3& gravity, Real dt,
                           const GravityField* field = nullptr);

// A first step when no report is at hand: no node changes its saturation by more than about 0.3, within [1e-4 s,
// longest_wetting_step].
Real suggested_wetting_step(const WettingModel& model, const Contents& contents, const Air& air, const Vec3& gravity);

}  // namespace imbibe
