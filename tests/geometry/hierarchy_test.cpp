#include "imbibe/geometry/hierarchy.h"

#include <gtest/gtest.h>

#include "imbibe/geometry/sampling.h"
#include "imbibe/geometry/sweep.h"
#include "support/meshes.h"

namespace imbibe {
namespace {

using testing::torus_mesh;

Vec3 random_point(std::uint64_t id, std::uint64_t stream) {
  return random_in({{-4, -4, -2}, {4, 4, 2}}, {.seed = 31, .id = id, .step = 0}, stream);
}

TEST(Hierarchy, EveryParentHoldsItsChildrenAndEveryPrimitiveIsInOneLeaf) {
  const TriangleMesh mesh = torus_mesh(2, 0.7, 40, 20);
  const BoxHierarchy tree = build_hierarchy(mesh);
  std::vector<int> seen(mesh.triangles.size());
  for (const auto& node : tree.nodes) {
    if (node.count == 0) {
      for (const Index child : {node.first, node.first + 1}) {
        EXPECT_TRUE(node.bounds.contains(tree.nodes[child].bounds.lower));
        EXPECT_TRUE(node.bounds.contains(tree.nodes[child].bounds.upper));
      }
    }
    for (Index k = 0; k < node.count; ++k) {
      const Index t = tree.order[node.first + k];
      ++seen[t];
      EXPECT_TRUE(node.bounds.contains(triangle_bounds(mesh, t).lower));
      EXPECT_TRUE(node.bounds.contains(triangle_bounds(mesh, t).upper));
    }
  }
  for (const int count : seen) EXPECT_EQ(count, 1);
}

TEST(Hierarchy, TheClosestPointIsThatOfBruteForceAtAFractionOfTheCost) {
  const TriangleMesh mesh = torus_mesh(2, 0.7, 60, 30);
  const BoxHierarchy tree = build_hierarchy(mesh);
  QueryCounts counts;
  for (std::uint64_t id = 0; id < 300; ++id) {
    const Vec3 p = random_point(id, 0);
    Real squared = std::numeric_limits<Real>::infinity();
    Index nearest = no_index;
    for (Index t = 0; t < mesh.triangles.size(); ++t) {
      const Vec3 q = closest_on_triangle(p, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)).point;
      if (squared_norm(p - q) < squared) squared = squared_norm(p - q), nearest = t;
    }
    const MeshPoint found = closest_point(tree, mesh, p, &counts);
    EXPECT_EQ(found.squared_distance, squared);
    EXPECT_EQ(found.triangle, nearest);  // ties go to the lowest, as in the simple loop
  }
  EXPECT_LT(counts.primitives, 300u * mesh.triangles.size() / 20);
}

TEST(Hierarchy, TheFirstCrossingOfAPathIsThatOfBruteForce) {
  const TriangleMesh mesh = torus_mesh(2, 0.7, 60, 30);
  const BoxHierarchy tree = build_hierarchy(mesh);
  int crossings = 0;
  for (std::uint64_t id = 0; id < 1000; ++id) {
    const Vec3 p0 = random_point(id, 0), p1 = random_point(id, 3);
    Real first = 2;
    for (Index t = 0; t < mesh.triangles.size(); ++t) {
      const auto time = cross_triangle(p0, p1, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2));
      if (time) first = std::min(first, *time);
    }
    const auto found = first_crossing(tree, mesh, p0, p1);
    ASSERT_EQ(found.has_value(), first <= 1);
    if (!found) continue;
    ++crossings;
    EXPECT_EQ(found->time_fraction, first);
  }
  EXPECT_GT(crossings, 200);
}

TEST(Hierarchy, NoPathFromInsideToFarOutsideSlipsThroughEvenAlongEdgesAndCorners) {
  const TriangleMesh mesh = testing::box_mesh({1, 1, 1});
  const BoxHierarchy tree = build_hierarchy(mesh);
  for (int x = -2; x <= 2; ++x) {
    for (int y = -2; y <= 2; ++y) {
      for (int z = -2; z <= 2; ++z) {
        if (x == 0 && y == 0 && z == 0) continue;  // through corners, edges, diagonals of the faces
        EXPECT_TRUE(first_crossing(tree, mesh, {0, 0, 0}, 10.0 * Vec3{double(x), double(y), double(z)}));
      }
    }
  }
}

TEST(Hierarchy, AfterARefitTheMovedMeshIsFound) {
  TriangleMesh mesh = torus_mesh(2, 0.7);
  BoxHierarchy tree = build_hierarchy(mesh);
  std::vector<Bounds> boxes;
  for (Vec3& v : mesh.vertices) v = {v.z + 5, v.x, v.y};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) boxes.push_back(triangle_bounds(mesh, t));
  refit(tree, boxes);
  const BoxHierarchy fresh = build_hierarchy(mesh);
  for (std::uint64_t id = 0; id < 100; ++id) {
    const Vec3 p = random_point(id, 0);
    EXPECT_EQ(closest_point(tree, mesh, p).triangle, closest_point(fresh, mesh, p).triangle);
  }
}

TEST(Hierarchy, AnEmptyOneAnswersThatThereIsNothing) {
  EXPECT_EQ(closest_point(build_hierarchy(TriangleMesh{}), {}, {}).triangle, no_index);
  EXPECT_FALSE(first_crossing(build_hierarchy(TriangleMesh{}), {}, {}, {1, 0, 0}));
}

TEST(Hierarchy, ManyEqualBoxesStillMakeAShallowTree) {
  const std::vector<Bounds> boxes(10000, Bounds{{0, 0, 0}, {1, 1, 1}});
  const BoxHierarchy tree = build_hierarchy(boxes);
  std::vector<int> depth(tree.nodes.size());
  for (std::size_t n = 0; n < tree.nodes.size(); ++n) {
    if (tree.nodes[n].count > 0) continue;
    for (const Index child : {tree.nodes[n].first, tree.nodes[n].first + 1}) depth[child] = depth[n] + 1;
  }
  EXPECT_LE(*std::max_element(depth.begin(), depth.end()), 13);  // log2(10000 / 4) rounded up, and one
}

}  // namespace
}  // namespace imbibe
