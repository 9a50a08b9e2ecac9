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

struct ElasticMaterials {
  std::vector<PieceMaterial> thread_stretch, triangle_stretch, cell_shear, triangle_shear, thread_bend, cell_bend, springs;
  std::vector<Real> tile_error;  // greatest strain error of each tile of a pass
  ThreadSolve thread_solve;
};

// Stiffness and damping of every piece, from the parameters and the nodes' wet factors.
void update_materials(const Sheet& sheet, const SheetTopology& topology, const ClothParams& params,
                      ElasticMaterials& materials);

// How well a substep was resolved.
struct ElasticErrors {
  Real strain = 0;  // greatest strain that relaxation left beyond the material's own (impulse.h)
  Real turn = 0;    // greatest of the threads (threads.h)
};

// One pass over all pieces.
ElasticErrors solve_elastic(const SheetTopology& topology, ElasticMaterials& materials, const ClothParams& params,
                   const NodeMotion& nodes, Real dt);

// J, of the positions as they are; and the elongation of the most stretched piece.
Real stored_energy(const Sheet& sheet, const SheetTopology& topology, const ElasticMaterials& materials,
                   const ClothParams& params);
Real greatest_strain(const Sheet& sheet, const SheetTopology& topology, const ClothParams& params);

}  // namespace imbibe
