#include "imbibe/geometry/hierarchy.h"

#include <algorithm>
#include <numeric>

#include "imbibe/core/error.h"
#include "imbibe/geometry/sweep.h"

namespace imbibe {
namespace {

Real component(const Vec3& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

int longest_axis(const Bounds& bounds) {
  const Vec3 size = bounds.size();
  if (size.x >= size.y && size.x >= size.z) return 0;
  return size.y >= size.z ? 1 : 2;
}

Bounds leaf_bounds(const BoxHierarchy& tree, const BoxHierarchy::Node& leaf, std::span<const Bounds> boxes) {
  Bounds bounds;
  for (Index k = 0; k < leaf.count; ++k) bounds.include(boxes[tree.order[leaf.first + k]]);
  return bounds;
}

std::vector<Bounds> triangle_boxes(const TriangleMesh& mesh) {
  std::vector<Bounds> boxes(mesh.triangles.size());
  for (std::size_t t = 0; t < boxes.size(); ++t) boxes[t] = triangle_bounds(mesh, t);
  return boxes;
}

}  // namespace

BoxHierarchy build_hierarchy(std::span<const Bounds> boxes, std::size_t leaf_size) {
  BoxHierarchy tree;
  if (boxes.empty()) return tree;
  IMBIBE_ASSERT(leaf_size > 0 && boxes.size() < no_index / 2);
  tree.order.resize(boxes.size());
  std::iota(tree.order.begin(), tree.order.end(), Index{0});
  tree.nodes.reserve(2 * (boxes.size() / leaf_size + 1));
  tree.nodes.push_back({{}, 0, static_cast<Index>(boxes.size())});
  // Nodes are split in the order they were made, so children always come after their parent.
  for (std::size_t n = 0; n < tree.nodes.size(); ++n) {
    const Index first = tree.nodes[n].first, count = tree.nodes[n].count;
    if (count <= leaf_size) continue;
    Bounds centres;
    for (Index k = first; k < first + count; ++k) centres.include(boxes[tree.order[k]].centre());
    const int axis = longest_axis(centres);
    const Index half = count / 2;
    const auto begin = tree.order.begin() + first;
    std::nth_element(begin, begin + half, begin + count, [&](Index a, Index b) {
      const Real x = component(boxes[a].centre(), axis), y = component(boxes[b].centre(), axis);
      return x != y ? x < y : a < b;
    });
    const Index child = static_cast<Index>(tree.nodes.size());
    tree.nodes.push_back({{}, first, half});
    tree.nodes.push_back({{}, first + half, count - half});
    tree.nodes[n] = {{}, child, 0};
  }
  refit(tree, boxes);
  return tree;
}

void refit(BoxHierarchy& tree, std::span<const Bounds> boxes) {
  IMBIBE_ASSERT(boxes.size() == tree.order.size());
  for (std::size_t n = tree.nodes.size(); n-- > 0;) {
    BoxHierarchy::Node& node = tree.nodes[n];
    node.bounds = {};
    if (node.count > 0) {
      node.bounds = leaf_bounds(tree, node, boxes);
    } else {
      node.bounds.include(tree.nodes[node.first].bounds);
      node.bounds.include(tree.nodes[node.first + 1].bounds);
    }
  }
}

BoxHierarchy build_hierarchy(const TriangleMesh& mesh) { return build_hierarchy(triangle_boxes(mesh)); }

MeshPoint closest_point(const BoxHierarchy& tree, const TriangleMesh& mesh, const Vec3& p, QueryCounts* counts,
                        Real within) {
  MeshPoint best;
  QueryCounts local;
  Real best_squared = within * within;
  visit_nearest(tree, p, best_squared, local, [&](Index t) {
    const TrianglePoint found = closest_on_triangle(p, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2));
    const Real squared = squared_norm(p - found.point);
    if (squared > best_squared || (squared == best_squared && t > best.triangle)) return;
    best_squared = squared;
    best = {t, found.feature, found.point, squared};
  });
  if (counts) counts->boxes += local.boxes, counts->primitives += local.primitives;
  return best;
}

std::optional<MeshCrossing> first_crossing(const BoxHierarchy& tree, const TriangleMesh& mesh, const Vec3& p0,
                                           const Vec3& p1, QueryCounts* counts) {
  MeshCrossing best;
  QueryCounts local;
  Real latest = 1;
  visit_swept(tree, p0, p1 - p0, 0, latest, local, [&](Index t) {
    const auto time = cross_triangle(p0, p1, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2));
    if (!time || *time > latest || (*time == latest && t > best.triangle)) return;
    latest = *time;
    best = {t, *time, p0 + *time * (p1 - p0)};
  });
  if (counts) counts->boxes += local.boxes, counts->primitives += local.primitives;
  if (best.triangle == no_index) return std::nullopt;
  return best;
}

}  // namespace imbibe
