#include "imbibe/cloth/sheet.h"

#include <gtest/gtest.h>

#include <functional>

#include "imbibe/cloth/fabric_hand.h"

namespace imbibe {
namespace {

GridSheet small_grid() {
  return {.corner = {1, 2, 3}, .along_u = {0, 2, 0}, .along_v = {0, 1, 1}, .width = 0.3, .height = 0.2, .columns = 4,
          .rows = 3, .areal_mass = 0.15};
}

std::string message_of(const std::function<void()>& body) {
  try {
    body();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Sheet, a_grid_lies_where_its_directions_say_and_weighs_its_area) {
  const Sheet sheet = make_sheet(small_grid());
  ASSERT_EQ(sheet.size(), 12u);
  EXPECT_EQ(sheet.triangles.size(), 12u);
  EXPECT_NEAR(total_mass(sheet), 0.15 * 0.3 * 0.2, 1e-15);
  EXPECT_LT(norm(sheet.position[0] - Vec3(1, 2, 3)), 1e-15);
  EXPECT_LT(norm(sheet.position[3] - Vec3(1, 2.3, 3)), 1e-15);
  EXPECT_LT(norm(sheet.position[8] - Vec3(1, 2, 3.2)), 1e-15);  // along_v made square to along_u
  EXPECT_NEAR(surface_area(surface_mesh(sheet)), 0.06, 1e-15);
  Real area = 0;
  for (const Real a : node_areas(sheet)) area += a;
  EXPECT_NEAR(area, 0.06, 1e-15);
}

TEST(Sheet, everything_wrong_with_a_grid_is_said_at_once) {
  GridSheet grid = small_grid();
  grid.width = -1, grid.areal_mass = 0, grid.rows = 1, grid.along_v = {0, 3, 0};
  EXPECT_EQ(find_problems(grid).size(), 4u);
  EXPECT_THROW(make_sheet(grid), InputError);
  grid = small_grid();
  grid.columns = grid.rows = 100000;
  EXPECT_EQ(find_problems(grid).size(), 1u);  // asked before memory is taken
}

TEST(Sheet, corners_and_edges_are_found_by_name) {
  const Sheet sheet = make_sheet(small_grid());
  EXPECT_EQ(nodes_of_corner(sheet, "top_right"), std::vector<Index>{11});
  EXPECT_EQ(nodes_of_corner(sheet, "bottom_right"), std::vector<Index>{3});
  EXPECT_EQ(nodes_of_edge(sheet, "left"), (std::vector<Index>{0, 4, 8}));
  EXPECT_EQ(nodes_of_edge(sheet, "top"), (std::vector<Index>{8, 9, 10, 11}));
  EXPECT_EQ(node_nearest(sheet, 0.21, 0.11), 6u);
  EXPECT_NE(message_of([&] { nodes_of_corner(sheet, "top_rihgt"); }).find("did you mean top_right"), std::string::npos);
  EXPECT_NE(message_of([&] { nodes_of_edge(sheet, "upper"); }).find("there is no edge 'upper'"), std::string::npos);
}

TEST(Sheet, bad_pins_are_refused) {
  Sheet sheet = make_sheet(small_grid());
  EXPECT_NE(message_of([&] { pin_nodes(sheet, std::vector<Index>{3, 99}); }).find("node 99 does not exist"),
            std::string::npos);
  EXPECT_TRUE(sheet.pins.empty());
  pin_nodes(sheet, nodes_of_edge(sheet, "top"));
  pin_nodes(sheet, nodes_of_edge(sheet, "left"));  // shares a corner: one pin
  EXPECT_EQ(sheet.pins.size(), 6u);
  const PinPath path{{{0, {}}, {1, {0, 0, 1}}}};
  EXPECT_NE(message_of([&] { pin_nodes(sheet, std::vector<Index>{8}, path); }).find("pinned twice"), std::string::npos);
  const PinPath turned{{{1, {}}, {1, {0, 0, 1}}}};
  EXPECT_NE(message_of([&] { pin_nodes(sheet, std::vector<Index>{5}, turned); }).find("must rise"), std::string::npos);
}

TEST(Sheet, a_pin_path_is_linear_between_its_keys_and_held_outside) {
  const PinPath path{{{1, {0, 0, 0}}, {3, {0, 0, 4}}}};
  EXPECT_EQ(displacement_at(path, 0), Vec3(0, 0, 0));
  EXPECT_EQ(displacement_at(path, 1.5), Vec3(0, 0, 1));
  EXPECT_EQ(displacement_at(path, 9), Vec3(0, 0, 4));
  EXPECT_EQ(displacement_at({}, 9), Vec3(0, 0, 0));
}

// --- free-form --------------------------------------------------------------------------------------------------------

struct FreeForm {
  TriangleMesh mesh;
  std::vector<std::array<Real, 2>> uv;
};
FreeForm two_triangles() {
  FreeForm f;
  f.mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.5}};
  f.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  f.uv = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  return f;
}

TEST(Sheet, a_mesh_weighs_its_material_area) {
  const FreeForm f = two_triangles();
  const Sheet sheet = make_sheet(f.mesh, f.uv, 0.2);
  EXPECT_NEAR(total_mass(sheet), 0.2, 1e-15);
  EXPECT_FALSE(sheet.is_grid());
  EXPECT_NE(message_of([&] { nodes_of_edge(sheet, "top"); }).find("pin it at material coordinates"), std::string::npos);
}

TEST(Sheet, a_map_that_is_clockwise_throughout_is_mirrored) {
  FreeForm f = two_triangles();
  for (auto& c : f.uv) c[0] = -c[0];
  EXPECT_NEAR(total_mass(make_sheet(f.mesh, f.uv, 0.2)), 0.2, 1e-15);
}

TEST(Sheet, bad_meshes_are_refused_with_their_reason) {
  const auto reason = [](const FreeForm& f, Real mass = 0.2) {
    return message_of([&] { make_sheet(f.mesh, f.uv, mass, "shirt.obj"); });
  };
  FreeForm f = two_triangles();
  f.uv.clear();
  EXPECT_NE(reason(f).find("shirt.obj"), std::string::npos);
  EXPECT_NE(reason(f).find("no material coordinates (UV)"), std::string::npos);
  f = two_triangles();
  f.uv.pop_back();
  EXPECT_NE(reason(f).find("3 material coordinates (UV) for 4 vertices"), std::string::npos);
  f = two_triangles();
  f.uv[3] = {0.5, 0.5};
  EXPECT_NE(reason(f).find("without area in the material coordinates"), std::string::npos);
  f = two_triangles();
  f.uv[3] = {1, 0};
  EXPECT_NE(reason(f).find("clockwise"), std::string::npos);
  f = two_triangles();
  f.mesh.vertices[3] = {0.5, 0.5, 0};
  EXPECT_FALSE(reason(f).empty());  // without area in space
  f = two_triangles();
  f.mesh.vertices.push_back({0, 0, 1}), f.uv.push_back({0.5, 2});
  EXPECT_NE(reason(f).find("belong to no triangle"), std::string::npos);
  f.mesh.triangles.push_back({0, 2, 4});
  EXPECT_FALSE(reason(f).empty());  // three triangles on one edge
  EXPECT_NE(reason(two_triangles(), 0).find("areal mass"), std::string::npos);
}

TEST(FabricHand, five_fabrics_are_known_and_a_misspelt_one_is_named) {
  EXPECT_EQ(fabric_hands().size(), 5u);
  for (const NamedHand& h : fabric_hands()) {
    EXPECT_EQ(fabric_hand(h.name).areal_mass, h.hand.areal_mass);
    EXPECT_GT(h.hand.shear, 0);
    EXPECT_LT(h.hand.shear, h.hand.stretch_weft);  // woven and knitted cloth shears far more easily than it stretches
  }
  EXPECT_NE(message_of([] { fabric_hand("denmi"); }).find("did you mean denim"), std::string::npos);
}

}  // namespace
}  // namespace imbibe
