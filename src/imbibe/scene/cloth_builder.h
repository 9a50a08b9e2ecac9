// Soft sheets, seed B's cloths and pipes of a scene: what they mean, and everything that can be wrong with them.
// Tested in tests/scene/cloth_builder_test.cpp.
#pragma once

#include <string>
#include <vector>

#include "imbibe/scene/scene.h"
#include "imbibe/sim/world.h"

namespace imbibe {

// Hands of presets go under the values that the scene gives itself. Problems (unknown names) are appended.
void apply_presets(Scene& scene, std::vector<Problem>& problems);

// What is wrong with the keys of a cell cloth, a soft sheet, or the pipes, against each other.
void check_cloth_keys(const Scene& scene, std::size_t textile, std::vector<Problem>& problems);
void check_pipe_keys(const Scene& scene, std::vector<Problem>& problems);

// The soft (or, with cells, fixed) sheet of a textile. Throws InputError; keys start with "textiles[i]".
// Under a woven fabric the sheet has its size, mass and thickness.
SoftSheet build_soft_sheet(const Scene& scene, std::size_t textile, const Fabric* fabric = nullptr);
CellCloth build_cell_cloth(const Scene& scene, std::size_t textile);
// The soft sheet that the network of a built textile rides on.
NetworkCloth build_network_cloth(const Scene& scene, std::size_t textile, const Textile& built, const Air& air);

// Bore and place of a pipe, and its mesh to be drawn. Throws InputError when the file cannot be read.
struct PipeGeometry {
  Vec3 mouth{}, axis{0, 0, 1};
  Real radius = 0, length = 0;  // m
  TriangleMesh mesh;
};
PipeGeometry pipe_geometry(const PipeSpec& spec);
Source source_of_pipe(const Scene& scene, std::size_t pipe, Real particle_mass, Real density);
Real particles_of_pipe(const PipeSpec& spec, Real duration, Real particle_volume);

// Pipes against the world: wider than the domain, mouth outside it, a jet fuller than its bore.
void check_pipes(const Scene& scene, const World& world, std::vector<Problem>& problems);

}  // namespace imbibe
