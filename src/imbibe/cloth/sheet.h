// A deformable sheet: nodes with masses on a triangle mesh whose material coordinates say how far apart any two nodes
// lie in the cloth at rest. The cloth at rest is flat and has no tension where its triangles have the lengths that (u, v)
// say; where its nodes are in space is the state.
//
// Tested in tests/cloth/sheet_test.cpp.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "imbibe/core/types.h"
#include "imbibe/geometry/triangle_mesh.h"

namespace imbibe {

// Where a group of pins goes: displacement from its anchors, linear between keys, held before the first and after the
// last. Times rise.
struct PinKey {
  Real time = 0;        // s, the sheet's clock
  Vec3 displacement{};  // m
};
struct PinPath {
  std::vector<PinKey> keys;
};
Vec3 displacement_at(const PinPath& path, Real time);

// A node held by a support that any force leaves where it is.
struct Pin {
  Index node = no_index;
  Vec3 anchor{};           // m, where the node is held at displacement zero
  Index path = no_index;   // in Sheet::pin_paths; no_index: the anchor does not move
  Real until = std::numeric_limits<Real>::infinity();  // s, released then
};

struct Sheet {
  // State, one entry per node.
  std::vector<Vec3> position;     // m
  std::vector<Vec3> velocity;     // m/s
  std::vector<Real> added_mass;   // kg, the water it carries; set by the coupling
  Real time = 0;                  // s, the sheet's own clock (pins' keys)
  Real substep = 0;               // s, the substep that the last step ended with; 0: not stepped yet

  // What wetting does to the cloth, one entry per node; set by the coupling, 1 and 0 for dry cloth.
  std::vector<Real> stiffness_factor;  // multiplies stretch, shear and bending stiffness, in (0, 1]
  std::vector<Real> damping_added;     // s, added to ClothParams::damping
  std::vector<Real> cling;             // Pa, greatest pull per area of the liquid bridges to what it touches

  // What the cloth is.
  std::vector<Real> u, v;         // m, material coordinates: u along the weft, v along the warp
  std::vector<Real> dry_mass;     // kg per node
  std::vector<std::array<Index, 3>> triangles;  // counter-clockwise in (u, v)
  std::vector<Pin> pins;          // by rising node, each node once
  std::vector<PinPath> pin_paths;
  Real areal_mass = 0;            // kg/m2, dry
  Index columns = 0, rows = 0;    // nodes along u and v of a rectangular grid (node = column + columns * row); 0: a mesh
  bool fixed = false;             // never moves: a step costs nothing
  std::uint64_t topology_key = 0; // changes with triangles and material coordinates; set by the builders

  std::size_t size() const { return position.size(); }
  bool is_grid() const { return columns > 0; }
  Real mass(std::size_t node) const { return dry_mass[node] + added_mass[node]; }
};

// --- builders: each throws InputError with all problems --------------------------------------------------------------

struct GridSheet {
  Vec3 corner{};               // m, node (0, 0)
  Vec3 along_u{1, 0, 0};       // direction of the weft, any length
  Vec3 along_v{0, 1, 0};       // direction of the warp, any length; made square to along_u
  Real width = 0, height = 0;  // m along u and v
  Index columns = 0, rows = 0; // nodes, each >= 2
  Real areal_mass = 0;         // kg/m2
};
std::vector<Problem> find_problems(const GridSheet& grid);
Sheet make_sheet(const GridSheet& grid);

// A free-form sheet. uv has one entry (m) per vertex of the mesh; `name` stands in messages.
Sheet make_sheet(const TriangleMesh& mesh, std::span<const std::array<Real, 2>> uv, Real areal_mass,
                 const std::string& name = "mesh");

// --- pins -----------------------------------------------------------------------------------------------------------

// Nodes to be pinned, by where they are in the cloth. `edge` and `corner` know left and right (least and greatest u),
// bottom and top (least and greatest v), and corners as bottom_left, bottom_right, top_left, top_right; these ask for a
// grid. Throws InputError for a name that does not exist (with the nearest known one).
std::vector<Index> nodes_of_corner(const Sheet& sheet, const std::string& corner);
std::vector<Index> nodes_of_edge(const Sheet& sheet, const std::string& edge);
// The node whose material coordinates are nearest to (u, v).
Index node_nearest(const Sheet& sheet, Real u, Real v);

// Pins nodes where they are now. Throws InputError for nodes that do not exist, nodes pinned twice on different paths,
// and keys whose times do not rise.
void pin_nodes(Sheet& sheet, std::span<const Index> nodes, const PinPath& path = {},
               Real until = std::numeric_limits<Real>::infinity());

// --- measures -------------------------------------------------------------------------------------------------------

Vec3 momentum(const Sheet& sheet);          // kg m/s
Real kinetic_energy(const Sheet& sheet);    // J
Real total_mass(const Sheet& sheet);        // kg, with the added mass
// The surface as a mesh (for pictures, files and queries) and the area in the cloth (m2) that each node stands for.
TriangleMesh surface_mesh(const Sheet& sheet);
std::vector<Real> node_areas(const Sheet& sheet);

}  // namespace imbibe
