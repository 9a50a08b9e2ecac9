// A binary tree of axis-aligned boxes over any primitives that have boxes, and closest-point and sweep queries on it;
// then both queries over the triangles of a mesh. Flat arrays, no recursion, no allocation in a query.
// Built by splitting at the median of the longest axis: depth <= log2(n) + 1, the same tree on every machine.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "imbibe/core/types.h"
#include "imbibe/geometry/bounds.h"
#include "imbibe/geometry/closest.h"
#include "imbibe/geometry/triangle_mesh.h"

namespace imbibe {

struct BoxHierarchy {
  struct Node {
    Bounds bounds;    // a parent's is made of its children's corners
    Index first = 0;  // leaf: first place in `order`; inner: the first of two neighbouring children
    Index count = 0;  // primitives of a leaf; 0 for an inner node
  };
  std::vector<Node> nodes;   // [0] is the root; children come after their parent
  std::vector<Index> order;  // primitives, leaf by leaf
  bool empty() const { return nodes.empty(); }
};

BoxHierarchy build_hierarchy(std::span<const Bounds> boxes, std::size_t leaf_size = 4);

// New boxes for the same primitives (a moved mesh): the tree's shape stays, only boxes change.
void refit(BoxHierarchy& hierarchy, std::span<const Bounds> boxes);

// What a query cost.
struct QueryCounts {
  std::uint64_t boxes = 0;
  std::uint64_t primitives = 0;
};

// Squared distance of p from the box; 0 inside.
inline Real squared_distance(const Bounds& b, const Vec3& p) {
  const Real x = std::max({b.lower.x - p.x, Real(0), p.x - b.upper.x});
  const Real y = std::max({b.lower.y - p.y, Real(0), p.y - b.upper.y});
  const Real z = std::max({b.lower.z - p.z, Real(0), p.z - b.upper.z});
  return x * x + y * y + z * z;
}

// The time fraction in [0, latest] at which the path from + t * step enters the box grown by `margin`; > latest: never.
inline Real entry_time(const Bounds& box, const Vec3& from, const Vec3& step, Real margin, Real latest) {
  Real enter = 0, leave = latest;
  const auto clip = [&](Real lower, Real upper, Real start, Real speed) {
    lower -= margin, upper += margin;
    if (speed == 0) {
      if (start < lower || start > upper) leave = -1;
      return;
    }
    const Real a = (lower - start) / speed, b = (upper - start) / speed;
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b) * (1 + 1e-15));  // rounding must not let a path slip between two boxes
  };
  clip(box.lower.x, box.upper.x, from.x, step.x);
  clip(box.lower.y, box.upper.y, from.y, step.y);
  clip(box.lower.z, box.upper.z, from.z, step.z);
  return enter <= leave ? enter : std::numeric_limits<Real>::infinity();
}

inline constexpr std::size_t hierarchy_stack = 128;  // 2 per level; 64 levels hold more than any Index can count

// Calls visit(primitive) for every primitive whose leaf may hold something nearer than best_squared, nearest boxes
// first; visit lowers best_squared as it finds nearer points.
template <class Visit>
void visit_nearest(const BoxHierarchy& tree, const Vec3& p, Real& best_squared, QueryCounts& counts, Visit&& visit) {
  if (tree.empty()) return;
  struct Entry { Index node; Real squared; };
  std::array<Entry, hierarchy_stack> stack;
  std::size_t depth = 0;
  stack[depth++] = {0, squared_distance(tree.nodes[0].bounds, p)};
  ++counts.boxes;
  while (depth > 0) {
    const Entry entry = stack[--depth];
    // Equal distances are visited too, so that a tie goes to the lowest primitive whatever the tree looks like.
    if (entry.squared > best_squared) continue;
    const BoxHierarchy::Node& node = tree.nodes[entry.node];
    if (node.count > 0) {
      for (Index k = 0; k < node.count; ++k) visit(tree.order[node.first + k]);
      counts.primitives += node.count;
      continue;
    }
    Entry near{node.first, squared_distance(tree.nodes[node.first].bounds, p)};
    Entry far{node.first + 1, squared_distance(tree.nodes[node.first + 1].bounds, p)};
    counts.boxes += 2;
    if (far.squared < near.squared) std::swap(near, far);
    stack[depth++] = far;
    stack[depth++] = near;
  }
}

// Calls visit(primitive) for every primitive whose leaf the path from + t * step, t in [0, latest], grown by `margin`
// may touch, earliest boxes first; visit lowers `latest` as it finds hits.
template <class Visit>
void visit_swept(const BoxHierarchy& tree, const Vec3& from, const Vec3& step, Real margin, Real& latest,
                 QueryCounts& counts, Visit&& visit) {
  if (tree.empty()) return;
  struct Entry { Index node; Real time; };
  std::array<Entry, hierarchy_stack> stack;
  std::size_t depth = 0;
  stack[depth++] = {0, entry_time(tree.nodes[0].bounds, from, step, margin, latest)};
  ++counts.boxes;
  while (depth > 0) {
    const Entry entry = stack[--depth];
    if (entry.time > latest) continue;
    const BoxHierarchy::Node& node = tree.nodes[entry.node];
    if (node.count > 0) {
      for (Index k = 0; k < node.count; ++k) visit(tree.order[node.first + k]);
      counts.primitives += node.count;
      continue;
    }
    Entry near{node.first, entry_time(tree.nodes[node.first].bounds, from, step, margin, latest)};
    Entry far{node.first + 1, entry_time(tree.nodes[node.first + 1].bounds, from, step, margin, latest)};
    counts.boxes += 2;
    if (far.time < near.time) std::swap(near, far);
    stack[depth++] = far;
    stack[depth++] = near;
  }
}

// --- over the triangles of a mesh -----------------------------------------------------------------------------------

BoxHierarchy build_hierarchy(const TriangleMesh& mesh);

struct MeshPoint {
  Index triangle = no_index;
  TriangleFeature feature = TriangleFeature::face;
  Vec3 point{};
  Real squared_distance = std::numeric_limits<Real>::infinity();
};
// The point of the mesh nearest to p; of equally near triangles the lowest. An empty mesh, or none within the distance
// `within`, gives no_index.
MeshPoint closest_point(const BoxHierarchy& tree, const TriangleMesh& mesh, const Vec3& p, QueryCounts* counts = nullptr,
                        Real within = std::numeric_limits<Real>::infinity());

struct MeshCrossing {
  Index triangle = no_index;
  Real time_fraction = 0;  // along p0 -> p1
  Vec3 point{};
};
// The first triangle that the path p0 -> p1 crosses, from either side.
std::optional<MeshCrossing> first_crossing(const BoxHierarchy& tree, const TriangleMesh& mesh, const Vec3& p0,
                                           const Vec3& p1, QueryCounts* counts = nullptr);

}  // namespace imbibe
