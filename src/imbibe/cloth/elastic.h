// The elastic pieces of a sheet with their stiffness, and the passes of both models over them: `xpbd` (stretch, shear and
// bending of the fabric) and `provot` (springs, then the correction of over-stretched ones; Provot, Graphics Interface
// 1995, section 4).
// Tested in tests/cloth/elastic_test.cpp.
#pragma once

#include "imbibe/cloth/cloth_step.h"
#include "imbibe/cloth/impulse.h"
#include "imbibe/cloth/threads.h"
#include "imbibe/cloth/topology.h"

namespace imbibe {

// Of one piece in one step: dry constants times what wetting made of them.
struct PieceMaterial {
  Real stiffness = 0;  // of the energy stiffness C^2 / 2
  Real damping = 0;    // s
};

struct ElasticWork {
  std::vector<PieceMaterial> thread_stretch, triangle_stretch, cell_shear, triangle_shear, thread_bend, cell_bend, ring_bend,
      spring_threads, springs;
  std::vector<Real> given_stretch, given_cell_shear, given_triangle_shear;  // impulses of the passes of a substep [J s]
  std::vector<PassOutcome> tiles, cell_shear_groups, triangle_shear_groups, triangle_stretch_groups;
  ThreadSolve threads;
};

// Stiffness and damping of every piece, from the parameters and the nodes' wet factors.
void update_materials(const Sheet& sheet, const SheetTopology& topology, const ClothParams& params, ElasticWork& work);

// Once a substep: bending of the fabric.
void solve_bending(const SheetTopology& topology, const ClothParams& params, const NodeMotion& nodes, Real dt,
                   ElasticWork& work);

// One pass over what holds the sheet together in its plane: shear and stretch of the fabric, or the springs with their
// correction. The impulses of the passes of a substep add up to those of backward Euler; begin_ comes before the first.
void begin_in_plane(const SheetTopology& topology, const ClothParams& params, ElasticWork& work);
struct InPlaneOutcome {
  PassOutcome threads;  // solved at once
  PassOutcome relaxed;  // solved one by one
  Real part = 1;        // of the pieces that were solved
};
InPlaneOutcome solve_in_plane(const SheetTopology& topology, const ClothParams& params, const NodeMotion& nodes, Real dt,
                              const PassScope& scope, ElasticWork& work);

// J, of the positions as they are; and the elongation of the most stretched piece.
Real stored_energy(const Sheet& sheet, const SheetTopology& topology, const ElasticWork& work, const ClothParams& params);
Real greatest_strain(const Sheet& sheet, const SheetTopology& topology, const ClothParams& params);

}  // namespace imbibe
