// An indexed triangle mesh, counter-clockwise seen from outside, and what can be said of it: normals, area, volume,
// and whether it is closed.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "imbibe/core/error.h"
#include "imbibe/core/types.h"
#include "imbibe/geometry/bounds.h"

namespace imbibe {

struct TriangleMesh {
  std::vector<Vec3> vertices;                  // m
  std::vector<std::array<Index, 3>> triangles;  // vertex numbers

  const Vec3& corner(std::size_t triangle, int k) const {
    return vertices[triangles[triangle][static_cast<std::size_t>(k)]];
  }
};

// Half the cross product of two edges: length = area, direction = outward normal.
Vec3 area_vector(const TriangleMesh& mesh, std::size_t triangle);
Vec3 triangle_normal(const TriangleMesh& mesh, std::size_t triangle);  // unit; zero for a triangle without area
Bounds triangle_bounds(const TriangleMesh& mesh, std::size_t triangle);
Bounds bounds_of(const TriangleMesh& mesh);
Real surface_area(const TriangleMesh& mesh);
Real enclosed_volume(const TriangleMesh& mesh);  // m3 by the divergence theorem; < 0 when the mesh is inside out

// Unit normals at the vertices, faces weighted by their angle at the vertex: independent of how faces are cut.
std::vector<Vec3> vertex_normals(const TriangleMesh& mesh);

// What keeps a mesh from being the closed surface of a solid. Empty counts: it is one.
struct MeshDefects {
  std::size_t bad_indices = 0;       // triangles that name a vertex which is not there
  std::size_t not_finite = 0;        // vertices with NaN or infinite coordinates
  std::size_t without_area = 0;      // triangles that name a vertex twice or whose corners lie on a line
  std::size_t open_edges = 0;        // edges with one triangle
  std::size_t holes = 0;             // closed loops of open edges
  std::size_t overfull_edges = 0;    // edges with more than two triangles
  std::size_t turned_edges = 0;      // edges whose two triangles disagree about the outside
  bool inside_out = false;           // volume < 0
  bool empty = false;                // no triangle at all
  std::size_t first_bad_triangle = 0, first_bad_index = 0;
  Vec3 first_open_edge{};            // middle of it, so that a user finds the hole
  bool any() const {
    return bad_indices + not_finite + without_area + open_edges + overfull_edges + turned_edges > 0 || inside_out ||
           empty;
  }
};
MeshDefects find_defects(const TriangleMesh& mesh);

// One Problem for each kind of defect; `file` is put into each.
std::vector<Problem> describe_defects(const MeshDefects& defects, const TriangleMesh& mesh, const std::string& file);

// Throws InputError with all defects unless the mesh is the closed, outward surface of a solid.
void require_closed(const TriangleMesh& mesh, const std::string& file);

void flip(TriangleMesh& mesh);  // turns inside out

}  // namespace imbibe
