// Signed distance to the surface of a closed triangle mesh.
//
// The sign is that of (p - q) . n, where q is the nearest point of the mesh and n the normal of the feature on which q
// lies: the face's, the sum of both faces' at an edge, the angle-weighted sum of all faces' at a vertex. With these
// weights the sign is right everywhere (Baerentzen & Aanaes, IEEE TVCG 11(3), 2005).
// Tested in tests/geometry/mesh_distance_test.cpp.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "imbibe/geometry/hierarchy.h"
#include "imbibe/geometry/shapes.h"
#include "imbibe/geometry/triangle_mesh.h"

namespace imbibe {

class MeshDistance {
 public:
  // Throws InputError naming every defect unless the mesh is the closed, outward surface of a solid.
  explicit MeshDistance(TriangleMesh mesh, const std::string& file = "");

  SurfaceSample nearest(const Vec3& point, QueryCounts* counts = nullptr) const;
  // Nothing when the surface is farther than `within`: costs a few boxes far away.
  std::optional<SurfaceSample> nearest_within(const Vec3& point, Real within) const;
  const TriangleMesh& mesh() const { return mesh_; }
  const BoxHierarchy& hierarchy() const { return hierarchy_; }
  const Bounds& bounds() const { return hierarchy_.nodes[0].bounds; }

 private:
  Vec3 normal_at(const MeshPoint& nearest) const;
  SurfaceSample sample_at(const MeshPoint& nearest, const Vec3& point) const;

  TriangleMesh mesh_;
  BoxHierarchy hierarchy_;
  std::vector<Vec3> vertex_normals_;
  std::vector<std::array<Vec3, 3>> edge_normals_;  // of the edges ab, bc, ca of each triangle
};

}  // namespace imbibe
