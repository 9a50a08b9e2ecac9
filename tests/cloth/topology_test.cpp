#include "imbibe/cloth/topology.h"

#include <gtest/gtest.h>

#include <set>

#include "imbibe/cloth/cloth_step.h"
#include "imbibe/core/random.h"

namespace imbibe {
namespace {

constexpr Real side = 0.2, area = side * side;

Sheet grid_sheet(Index nodes) {
  return make_sheet(GridSheet{.along_u = {1, 0, 0}, .along_v = {0, 1, 0}, .width = side, .height = side,
                              .columns = nodes, .rows = nodes, .areal_mass = 0.1});
}
Sheet mesh_sheet(Index nodes) {
  const Sheet grid = grid_sheet(nodes);
  TriangleMesh mesh = surface_mesh(grid);
  std::vector<std::array<Real, 2>> uv;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const auto column = static_cast<Index>(i % nodes), row = static_cast<Index>(i / nodes);
    const bool inside = column > 0 && row > 0 && column + 1 < nodes && row + 1 < nodes;
    const RandomCounter counter{.seed = 1, .id = i};
    const Real shift = inside ? 0.4 * side / (nodes - 1) : 0;
    uv.push_back({grid.u[i] + shift * (uniform(counter, 0) - 0.5), grid.v[i] + shift * (uniform(counter, 1) - 0.5)});
    mesh.vertices[i] = {uv.back()[0], uv.back()[1], 0};
  }
  return make_sheet(mesh, uv, 0.1);
}

ClothParams only(Real stretch_weft, Real stretch_warp, Real shear, Real bending, Real twist) {
  ClothParams params;
  params.hand = {.stretch_weft = stretch_weft, .stretch_warp = stretch_warp, .shear = shear, .bending_weft = bending,
                 .bending_warp = bending, .twist = twist};
  return params;
}

template <class Place>
Real energy_when(Sheet sheet, const ClothParams& params, Place&& place) {
  for (std::size_t i = 0; i < sheet.size(); ++i) sheet.position[i] = place(sheet.u[i], sheet.v[i]);
  ClothScratch scratch;
  return elastic_energy(sheet, params, scratch);
}

TEST(SheetTopology, homogeneous_strains_store_the_energy_of_the_stiffness_per_width) {
  const Real e = 0.03;
  for (const Sheet& sheet : {grid_sheet(8), mesh_sheet(8)}) {
    const Real weft = energy_when(sheet, only(500, 1e-9, 1e-9, 1e-12, 0), [&](Real u, Real v) { return Vec3{(1 + e) * u, v, 0}; });
    EXPECT_NEAR(weft, 0.5 * 500 * e * e * area, 1e-9 * weft);
    const Real warp = energy_when(sheet, only(1e-9, 700, 1e-9, 1e-12, 0), [&](Real u, Real v) { return Vec3{u, (1 - e) * v, 0}; });
    EXPECT_NEAR(warp, 0.5 * 700 * e * e * area, 1e-9 * warp);
    const Real shear = energy_when(sheet, only(1e-9, 1e-9, 40, 1e-12, 0), [&](Real u, Real v) {
      return Vec3{u + std::sin(e) * v, std::cos(e) * v, 0};
    });
    EXPECT_NEAR(shear, 0.5 * 40 * std::sin(e) * std::sin(e) * area, 1e-9 * shear);
    const Real turned = energy_when(sheet, only(500, 500, 40, 1e-6, 1e-6), [&](Real u, Real v) {
      return Vec3{0.6 * u - 0.8 * v, 0.8 * u + 0.6 * v, 3.0};
    });
    EXPECT_LT(turned, 1e-20);  // rounding
  }
}

Vec3 rolled(Real along, Real across, Real curvature) {
  return {std::sin(curvature * along) / curvature, across, (1 - std::cos(curvature * along)) / curvature};
}

TEST(SheetTopology, a_cylinder_stores_the_energy_of_the_bending_stiffness) {
  const Real curvature = 8, bending = 1e-5;
  const Index n = 41;
  const Real expected = 0.5 * bending * curvature * curvature * area;
  const ClothParams params = only(1e-9, 1e-9, 1e-9, bending, 0);
  const auto weft = [&](Real u, Real v) { return rolled(u, v, curvature); };
  const auto warp = [&](Real u, Real v) { return rolled(v, u, curvature); };
  // Nodes at the hems carry no bending: one part in n - 1 is missing. Besides, second order in the edge.
  const Real hem = 1 - 1.0 / (n - 1);
  EXPECT_NEAR(energy_when(grid_sheet(n), params, weft), expected * hem, 2e-3 * expected);
  EXPECT_NEAR(energy_when(grid_sheet(n), params, warp), expected * hem, 2e-3 * expected);
  // A mesh has no bending at the nodes of all four hems: two parts in n - 1. Besides, a lumped second derivative on an
  // mesh whose nodes are moved by up to a fifth of an edge: 15 % measured.
  EXPECT_NEAR(energy_when(mesh_sheet(n), params, weft), expected * hem * hem, 0.2 * expected);
  EXPECT_NEAR(energy_when(mesh_sheet(n), params, warp), expected * hem * hem, 0.2 * expected);
}

TEST(SheetTopology, isotropic_twist_makes_bending_along_the_bias_as_stiff) {
  const Real curvature = 5, bending = 1e-5, h = std::sqrt(0.5);
  const auto bias = [&](Real u, Real v) { return rolled(h * (u + v), h * (v - u), curvature); };
  const Real expected = 0.5 * bending * curvature * curvature * area;
  const Real with = energy_when(grid_sheet(61), only(1e-9, 1e-9, 1e-9, bending, bending), bias);
  const Real without = energy_when(grid_sheet(61), only(1e-9, 1e-9, 1e-9, bending, 0), bias);
  EXPECT_NEAR(with, expected, 0.02 * expected);          // hems
  EXPECT_NEAR(without, 0.5 * expected, 0.02 * expected);  // fabric_hand.h: (B + B)/4
}

template <class List>
void expect_colours_share_no_node(const List& list) {
  for (std::size_t c = 0; c + 1 < list.colours.size(); ++c) {
    std::set<Index> seen;
    for (std::size_t k = list.colours[c]; k < list.colours[c + 1]; ++k) {
      for (const Index i : list.pieces[k].node) EXPECT_TRUE(seen.insert(i).second);
    }
  }
  EXPECT_EQ(list.colours.back(), list.pieces.size());
}

TEST(SheetTopology, pieces_of_one_colour_share_no_node) {
  for (const Sheet& sheet : {grid_sheet(7), mesh_sheet(7)}) {
    const SheetTopology t = make_topology(sheet);
    expect_colours_share_no_node(t.triangle_stretch);
    expect_colours_share_no_node(t.cell_shear);
    expect_colours_share_no_node(t.triangle_shear);
    expect_colours_share_no_node(t.cell_bend);
    EXPECT_EQ(t.ring_bend.colours.back(), t.ring_bend.pieces.size());
    expect_colours_share_no_node(t.springs);
  }
}

TEST(SheetTopology, lines_of_springs_of_one_family_share_no_node_and_hold_every_spring_of_a_grid_once) {
  const Sheet sheet = grid_sheet(7);
  const auto& list = make_topology(sheet).spring_threads;
  std::set<std::set<Index>> springs;
  ASSERT_EQ(list.families.size(), 7u);
  EXPECT_EQ(list.families.back(), list.size());
  for (std::size_t f = 0; f + 1 < list.families.size(); ++f) {
    std::set<Index> seen;
    for (std::size_t t = list.families[f]; t < list.families[f + 1]; ++t) {
      std::set<Index> line;
      for (std::size_t k = list.first[t]; k < list.first[t + 1]; ++k) {
        const auto [a, b] = list.pieces[k].node;
        EXPECT_TRUE(springs.insert({a, b}).second);
        if (k > list.first[t]) {
          EXPECT_EQ(list.pieces[k - 1].node[1], a);
        }
        line.insert({a, b});
      }
      for (const Index i : line) EXPECT_TRUE(seen.insert(i).second);
    }
  }
  const std::size_t n = sheet.columns, m = sheet.rows;  // structural, shear and flexion springs
  EXPECT_EQ(springs.size(), n * (m - 1) + m * (n - 1) + 2 * (n - 1) * (m - 1) + n * (m - 2) + m * (n - 2));
}

TEST(SheetTopology, a_wild_mesh_with_more_pieces_at_a_node_than_a_word_has_bits_is_coloured) {
  // A fan of 100 triangles about one node.
  TriangleMesh mesh;
  std::vector<std::array<Real, 2>> uv;
  const auto add = [&](Real x, Real y) { mesh.vertices.push_back({x, y, 0}), uv.push_back({x, y}); };
  add(0, 0);
  const int count = 100;
  for (int k = 0; k < count; ++k) add(std::cos(2 * pi * k / count), std::sin(2 * pi * k / count));
  for (Index k = 0; k < count; ++k) mesh.triangles.push_back({0, 1 + k, 1 + (k + 1) % count});
  const SheetTopology t = make_topology(make_sheet(mesh, uv, 0.1));
  EXPECT_EQ(t.triangle_shear.pieces.size(), 100u);
  expect_colours_share_no_node(t.triangle_shear);
  expect_colours_share_no_node(t.springs);
}

}  // namespace
}  // namespace imbibe
