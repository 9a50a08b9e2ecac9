#include "imbibe/view/frame.h"

#include <variant>

#include "imbibe/core/error.h"

namespace imbibe {

void add_yarn(DrawnYarns& yarns, const std::vector<Vec3f>& points, const std::vector<float>& saturation, float radius,
              const Vec3f& colour) {
  IMBIBE_ASSERT(points.size() == saturation.size());
  yarns.points.insert(yarns.points.end(), points.begin(), points.end());
  yarns.saturation.insert(yarns.saturation.end(), saturation.begin(), saturation.end());
  yarns.first_point.push_back(static_cast<Index>(yarns.points.size()));
  yarns.radius.push_back(radius);
  yarns.colour.push_back(colour);
}

void set_normals(DrawnMesh& mesh) {
  mesh.normals.assign(mesh.vertices.size(), Vec3f{});
  for (const auto& t : mesh.triangles) {
    const Vec3f n = cross(mesh.vertices[t[1]] - mesh.vertices[t[0]], mesh.vertices[t[2]] - mesh.vertices[t[0]]);
    for (const Index v : t) mesh.normals[v] += n;
  }
  for (Vec3f& n : mesh.normals) n = normalized(n);
}

Bounds bounds_of_cloth(const Frame& frame) {
  Bounds bounds;
  for (const DrawnCloth& cloth : frame.cloths)
    for (const Vec3f& v : cloth.mesh.vertices) bounds.include(Vec3(v));
  for (std::size_t y = 0; y < frame.yarns.yarns(); ++y) {
    const Real r = frame.yarns.radius[y];
    for (Index i = frame.yarns.first_point[y]; i < frame.yarns.first_point[y + 1]; ++i) {
      const Vec3 p(frame.yarns.points[i]);
      bounds.include(p - Vec3{r, r, r});
      bounds.include(p + Vec3{r, r, r});
    }
  }
  return bounds;
}

Bounds bounds_of_solids(const Frame& frame) {
  Bounds bounds;
  for (const DrawnSolid& solid : frame.solids) {
    if (!solid.mesh.triangles.empty()) {
      for (const Vec3f& v : solid.mesh.vertices) bounds.include(Vec3(v));
    } else if (!std::holds_alternative<Plane>(solid.shape)) {
      bounds.include(bounds_of(solid.shape));
    }
  }
  return bounds;
}

Bounds bounds_of_liquid(const Frame& frame) {
  Bounds bounds;
  for (const Vec3f& p : frame.particles) bounds.include(Vec3(p));
  if (!bounds.empty()) bounds.grow(0.5 * frame.particle_spacing);
  return bounds;
}

}  // namespace imbibe
