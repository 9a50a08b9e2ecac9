#include "imbibe/geometry/mesh_distance.h"

#include <algorithm>

namespace imbibe {
namespace {

// The normals of each triangle's three edges: the sum of the normals of the two triangles that share it.
std::vector<std::array<Vec3, 3>> edge_normals(const TriangleMesh& mesh) {
  struct Side {
    Index low, high, triangle;
    std::size_t edge;
  };
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), static_cast<Index>(t), k});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    if (a.low != b.low) return a.low < b.low;
    return a.high != b.high ? a.high < b.high : a.triangle < b.triangle;
  });
  std::vector<std::array<Vec3, 3>> normals(mesh.triangles.size());
  for (std::size_t s = 0; s + 1 < sides.size(); s += 2) {  // a closed mesh: sides come in pairs
    const Side &one = sides[s], &two = sides[s + 1];
    const Vec3 normal = normalized(triangle_normal(mesh, one.triangle) + triangle_normal(mesh, two.triangle));
    normals[one.triangle][one.edge] = normals[two.triangle][two.edge] = normal;
  }
  return normals;
}

}  // namespace

MeshDistance::MeshDistance(TriangleMesh mesh, const std::string& file) : mesh_(std::move(mesh)) {
  require_closed(mesh_, file);
  hierarchy_ = build_hierarchy(mesh_);
  vertex_normals_ = vertex_normals(mesh_);
  edge_normals_ = edge_normals(mesh_);
}

Vec3 MeshDistance::normal_at(const MeshPoint& nearest) const {
  const auto& corners = mesh_.triangles[nearest.triangle];
  switch (nearest.feature) {
    case TriangleFeature::vertex_a: return vertex_normals_[corners[0]];
    case TriangleFeature::vertex_b: return vertex_normals_[corners[1]];
    case TriangleFeature::vertex_c: return vertex_normals_[corners[2]];
    case TriangleFeature::edge_ab: return edge_normals_[nearest.triangle][0];
    case TriangleFeature::edge_bc: return edge_normals_[nearest.triangle][1];
    case TriangleFeature::edge_ca: return edge_normals_[nearest.triangle][2];
    case TriangleFeature::face: break;
  }
  return triangle_normal(mesh_, nearest.triangle);
}

SurfaceSample MeshDistance::nearest(const Vec3& point, QueryCounts* counts) const {
  return sample_at(closest_point(hierarchy_, mesh_, point, counts), point);
}

std::optional<SurfaceSample> MeshDistance::nearest_within(const Vec3& point, Real within) const {
  const MeshPoint found = closest_point(hierarchy_, mesh_, point, nullptr, within);
  if (found.triangle == no_index) return std::nullopt;
  return sample_at(found, point);
}

SurfaceSample MeshDistance::sample_at(const MeshPoint& found, const Vec3& point) const {
  const Vec3 normal = normal_at(found);
  const Vec3 away = point - found.point;
  const Real distance = std::sqrt(found.squared_distance);
  const bool inside = dot(away, normal) < 0;
  // On the surface the direction to the nearest point is rounding only: the feature's own normal is better.
  const Vec3 size = bounds().size();
  if (distance <= 1e-12 * (size.x + size.y + size.z)) return {inside ? -distance : distance, normal};
  return inside ? SurfaceSample{-distance, away / -distance} : SurfaceSample{distance, away / distance};
}

}  // namespace imbibe
