#include "imbibe/geometry/triangle_mesh.h"

#include <fmt/format.h>

#include <algorithm>

#include "imbibe/core/portable.h"
#include "imbibe/core/union_find.h"

namespace imbibe {
namespace {

// One side of a triangle, keyed by its two vertices in rising order.
struct Side {
  Index low, high;
  bool rising;  // the triangle runs from low to high
  friend bool operator<(const Side& a, const Side& b) {
    return a.low != b.low ? a.low < b.low : a.high < b.high;
  }
};

// Sides whose ends join are one loop: union-find over the vertices of the open sides.
std::size_t count_loops(const std::vector<Side>& open, std::size_t vertices) {
  std::vector<Index> parent;
  separate_all(parent, vertices);
  std::size_t loops = 0;
  std::vector<bool> seen(vertices);
  for (const Side& side : open) {
    for (const Index v : {side.low, side.high}) {
      if (!seen[v]) seen[v] = true, ++loops;
    }
    if (unite(parent, side.low, side.high)) --loops;
  }
  return loops;
}

void check_sides(const TriangleMesh& mesh, MeshDefects& defects) {
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = t[k], b = t[(k + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), a < b});
    }
  }
  std::sort(sides.begin(), sides.end());
  std::vector<Side> open;
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    while (end < sides.size() && !(sides[begin] < sides[end])) ++end;
    if (end - begin == 1) {
      open.push_back(sides[begin]);
    } else if (end - begin > 2) {
      ++defects.overfull_edges;
    } else if (sides[begin].rising == sides[begin + 1].rising) {
      ++defects.turned_edges;
    }
  }
  defects.open_edges = open.size();
  if (open.empty()) return;
  defects.holes = count_loops(open, mesh.vertices.size());
  defects.first_open_edge = 0.5 * (mesh.vertices[open[0].low] + mesh.vertices[open[0].high]);
}

}  // namespace

Vec3 area_vector(const TriangleMesh& mesh, std::size_t t) {
  return 0.5 * cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0));
}

Vec3 triangle_normal(const TriangleMesh& mesh, std::size_t t) { return normalized(area_vector(mesh, t)); }

Bounds triangle_bounds(const TriangleMesh& mesh, std::size_t t) {
  Bounds bounds;
  for (int k = 0; k < 3; ++k) bounds.include(mesh.corner(t, k));
  return bounds;
}

Bounds bounds_of(const TriangleMesh& mesh) {
  Bounds bounds;
  for (const Vec3& v : mesh.vertices) bounds.include(v);
  return bounds;
}

Real surface_area(const TriangleMesh& mesh) {
  Real area = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) area += norm(area_vector(mesh, t));
  return area;
}

Real enclosed_volume(const TriangleMesh& mesh) {
  if (mesh.vertices.empty()) return 0;
  const Vec3 origin = bounds_of(mesh).centre();  // near the mesh: no cancellation when it lies far from zero
  Real volume = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    volume += dot(mesh.corner(t, 0) - origin, area_vector(mesh, t)) / 3;
  }
  return volume;
}

std::vector<Vec3> vertex_normals(const TriangleMesh& mesh) {
  std::vector<Vec3> normals(mesh.vertices.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 normal = triangle_normal(mesh, t);
    for (int k = 0; k < 3; ++k) {
      const Vec3 u = normalized(mesh.corner(t, (k + 1) % 3) - mesh.corner(t, k));
      const Vec3 w = normalized(mesh.corner(t, (k + 2) % 3) - mesh.corner(t, k));
      normals[mesh.triangles[t][static_cast<std::size_t>(k)]] += portable::atan2(norm(cross(u, w)), dot(u, w)) * normal;
    }
  }
  for (Vec3& n : normals) n = normalized(n);
  return normals;
}

MeshDefects find_defects(const TriangleMesh& mesh) {
  MeshDefects defects;
  defects.empty = mesh.triangles.empty();
  for (const Vec3& v : mesh.vertices) defects.not_finite += !is_finite(v);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const Index v : mesh.triangles[t]) {
      if (v < mesh.vertices.size()) continue;
      if (defects.bad_indices++ == 0) defects.first_bad_triangle = t, defects.first_bad_index = v;
      break;
    }
  }
  if (defects.bad_indices + defects.not_finite > 0) return defects;  // the rest cannot be asked
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 ab = mesh.corner(t, 1) - mesh.corner(t, 0), ac = mesh.corner(t, 2) - mesh.corner(t, 0);
    // Relative to the sides: only what rounding cannot tell from a line counts, not thin triangles.
    const Real limit = 1e-14 * std::max(squared_norm(ab), squared_norm(ac));
    defects.without_area += !(norm(cross(ab, ac)) > limit);
  }
  check_sides(mesh, defects);
  defects.inside_out = defects.open_edges == 0 && enclosed_volume(mesh) < 0;
  return defects;
}

std::vector<Problem> describe_defects(const MeshDefects& d, const TriangleMesh& mesh, const std::string& file) {
  std::vector<Problem> problems;
  const auto say = [&](std::string message) { problems.push_back({.file = file, .message = std::move(message)}); };
  if (d.empty) say("the mesh has no triangle");
  if (d.bad_indices > 0) {
    say(fmt::format("{} triangle(s) name a vertex that does not exist (triangle {} names vertex {}, there are {})",
                    d.bad_indices, d.first_bad_triangle + 1, d.first_bad_index + 1, mesh.vertices.size()));
  }
  if (d.not_finite > 0) say(fmt::format("{} vertices have a coordinate that is not a finite number", d.not_finite));
  if (d.without_area > 0) say(fmt::format("{} triangle(s) have no area", d.without_area));
  if (d.open_edges > 0) {
    const Vec3& e = d.first_open_edge;
    say(fmt::format("the mesh is not closed: {} hole(s) with {} open edges, one of them at ({:.6g}, {:.6g}, {:.6g})",
                    d.holes, d.open_edges, e.x, e.y, e.z));
  }
  if (d.overfull_edges > 0) say(fmt::format("{} edge(s) have more than two triangles", d.overfull_edges));
  if (d.turned_edges > 0) say(fmt::format("{} edge(s) join triangles that face opposite ways", d.turned_edges));
  if (d.inside_out) say("the mesh is inside out (its triangles face inwards); set `flip: true`");
  return problems;
}

void require_closed(const TriangleMesh& mesh, const std::string& file) {
  const MeshDefects defects = find_defects(mesh);
  if (defects.any()) throw InputError(describe_defects(defects, mesh, file));
}

void flip(TriangleMesh& mesh) {
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
}

}  // namespace imbibe
