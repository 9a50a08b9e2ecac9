#include "imbibe/geometry/triangle_mesh.h"

#include <gtest/gtest.h>

#include "support/meshes.h"

namespace imbibe {
namespace {

using testing::box_mesh;
using testing::torus_mesh;

TEST(TriangleMesh, ABoxHasItsAreaAndVolumeWhereverItLies) {
  TriangleMesh box = box_mesh({0.5, 1, 1.5});
  for (Vec3& v : box.vertices) v += {1e3, -2e3, 3e3};  // cancellation would cost 10 digits of the volume here
  EXPECT_NEAR(surface_area(box), 2 * (1 * 2 + 2 * 3 + 3 * 1), 1e-10);
  EXPECT_NEAR(enclosed_volume(box), 6, 1e-10);
  EXPECT_FALSE(find_defects(box).any());
}

TEST(TriangleMesh, VertexNormalsDoNotDependOnHowFacesAreCut) {
  const TriangleMesh box = box_mesh({1, 1, 1});
  for (std::size_t v = 0; v < box.vertices.size(); ++v) {
    EXPECT_NEAR(norm(vertex_normals(box)[v] - normalized(box.vertices[v])), 0, 1e-14);
  }
}

TEST(TriangleMesh, ATorusIsClosedThoughItHasAHoleThroughIt) {
  EXPECT_FALSE(find_defects(torus_mesh(2, 0.5)).any());
}

TEST(TriangleMeshDefects, MissingTrianglesAreHolesCountedByLoop) {
  TriangleMesh torus = torus_mesh(2, 0.5);
  torus.triangles.erase(torus.triangles.begin() + 200, torus.triangles.begin() + 202);  // one quad
  torus.triangles.erase(torus.triangles.begin());
  const MeshDefects defects = find_defects(torus);
  EXPECT_EQ(defects.open_edges, 7u);
  EXPECT_EQ(defects.holes, 2u);
  EXPECT_THROW(require_closed(torus, "torus.obj"), InputError);
}

TEST(TriangleMeshDefects, AnIndexBeyondTheVerticesIsNamedWithItsTriangle) {
  TriangleMesh box = box_mesh({1, 1, 1});
  box.triangles[4][2] = 99;
  try {
    require_closed(box, "box.obj");
    FAIL();
  } catch (const InputError& error) {
    ASSERT_EQ(error.problems().size(), 1u);
    EXPECT_EQ(error.problems()[0].file, "box.obj");
    EXPECT_NE(error.problems()[0].message.find("triangle 5 names vertex 100"), std::string::npos);
  }
}

TEST(TriangleMeshDefects, EachKindIsFoundAndAllAreToldAtOnce) {
  TriangleMesh turned = box_mesh({1, 1, 1});
  std::swap(turned.triangles[3][0], turned.triangles[3][1]);
  EXPECT_EQ(find_defects(turned).turned_edges, 3u);

  TriangleMesh doubled = box_mesh({1, 1, 1});
  doubled.triangles.push_back(doubled.triangles[0]);
  EXPECT_EQ(find_defects(doubled).overfull_edges, 3u);

  TriangleMesh inside_out = box_mesh({1, 1, 1});
  flip(inside_out);
  EXPECT_TRUE(find_defects(inside_out).inside_out);

  TriangleMesh thin = box_mesh({1, 1, 1});
  thin.vertices.push_back({0, -1, -1});  // in the middle of the edge 0-1
  thin.triangles.push_back({0, 1, 8});
  EXPECT_EQ(find_defects(thin).without_area, 1u);
  EXPECT_EQ(describe_defects(find_defects(thin), thin, "f").size(), 3u);  // no area, open edges, an overfull edge

  TriangleMesh not_finite = box_mesh({1, 1, 1});
  not_finite.vertices[2].y = NAN;
  EXPECT_EQ(find_defects(not_finite).not_finite, 1u);

  EXPECT_TRUE(find_defects({}).empty);
}

}  // namespace
}  // namespace imbibe
