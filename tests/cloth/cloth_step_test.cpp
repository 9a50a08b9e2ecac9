#include "imbibe/cloth/cloth_step.h"

#include <gtest/gtest.h>

#include "imbibe/core/error.h"
#include "imbibe/core/parallel.h"
#include "imbibe/core/random.h"
#include "imbibe/geometry/closest.h"

namespace imbibe {
namespace {

Sheet square(Index nodes, Real side, Real areal_mass = 0.12) {
  return make_sheet(GridSheet{.along_u = {1, 0, 0}, .along_v = {0, 1, 0}, .width = side, .height = side,
                              .columns = nodes, .rows = nodes, .areal_mass = areal_mass});
}

// The same square as a free-form mesh: irregular inside, so nothing is aligned with the threads.
Sheet square_mesh(Index nodes, Real side) {
  const Sheet grid = square(nodes, side);
  TriangleMesh mesh = surface_mesh(grid);
  std::vector<std::array<Real, 2>> uv;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const Index column = static_cast<Index>(i % nodes), row = static_cast<Index>(i / nodes);
    const bool inside = column > 0 && row > 0 && column + 1 < nodes && row + 1 < nodes;
    const RandomCounter counter{.seed = 1, .id = i};
    const Real shift = inside ? 0.3 * side / (nodes - 1) : 0;
    uv.push_back({grid.u[i] + shift * (uniform(counter, 0) - 0.5), grid.v[i] + shift * (uniform(counter, 1) - 0.5)});
    mesh.vertices[i] = {uv.back()[0], uv.back()[1], 0};
  }
  return make_sheet(mesh, uv, 0.12);
}

ClothParams without_losses(ClothModel model = ClothModel::xpbd) {
  ClothParams params;
  params.model = model;
  params.hand = fabric_hand("shirting");
  params.damping = 0;
  params.air.density = 0;
  return params;
}

void stir(Sheet& sheet, Real speed) {
  for (std::size_t i = 0; i < sheet.size(); ++i) {
    const Real u = sheet.u[i], v = sheet.v[i];
    sheet.velocity[i] = speed * Vec3{std::sin(9 * v), std::cos(7 * u), std::sin(11 * u + 5 * v)};
  }
}

Real momentum_scale(const Sheet& sheet) {
  Real sum = 0;
  for (std::size_t i = 0; i < sheet.size(); ++i) sum += sheet.mass(i) * norm(sheet.velocity[i]);
  return sum;
}

// --- momentum and energy ----------------------------------------------------------------------------------------------

TEST(ClothStep, momentum_is_what_loads_weight_pins_solids_and_air_gave) {
  for (const ClothModel model : {ClothModel::xpbd, ClothModel::provot}) {
    Sheet sheet = square(16, 0.3);
    stir(sheet, 1);
    pin_nodes(sheet, nodes_of_corner(sheet, "top_left"));
    pin_nodes(sheet, nodes_of_corner(sheet, "top_right"), {{{0, {}}, {0.05, {0.02, 0, 0.03}}}});
    ClothParams params = without_losses(model);
    params.damping = 1e-3;
    params.air.density = 1.2;
    params.air.wind = {3, 1, 0};
    std::vector<Vec3> force(sheet.size());
    for (std::size_t i = 0; i < force.size(); ++i) force[i] = 1e-4 * Vec3{1.0 * (i % 3), -0.5, 0.1 * (i % 7)};
    const std::vector<ClothSolid> solids{{.shape = Sphere{{0.15, 0.1, -0.06}, 0.055}},
                                         {.shape = Plane{{0, 0, -0.1}, {0, 0, 1}}, .velocity = {0, 0, 0.4}}};
    ClothScratch scratch;
    for (int k = 0; k < 150; ++k) {
      for (std::size_t i = 0; i < sheet.size(); ++i) sheet.added_mass[i] = 1e-6 * static_cast<Real>(i % 5);
      const Vec3 before = momentum(sheet);
      const auto r = step_cloth(sheet, params, {.force = force, .solids = solids}, 2e-3, scratch);
      const Vec3 given = r.load_impulse + r.weight_impulse + r.pin_impulse + r.solid_impulse + r.air_impulse;
      // The bound, of the momentum that moves about.
      EXPECT_LT(norm(momentum(sheet) - before - given), 1e-9 * (momentum_scale(sheet) + norm(r.weight_impulse)));
      Vec3 pins, faces;
      for (const Vec3& impulse : scratch.pin_impulse) pins += impulse;
      for (const Vec3& impulse : scratch.solid_impulse) faces += impulse;
      EXPECT_EQ(pins, r.pin_impulse);
      EXPECT_EQ(faces, r.solid_impulse);
    }
  }
}

TEST(ClothStep, pins_of_cloth_at_rest_carry_its_weight) {
  Sheet sheet = square(11, 0.2);
  for (std::size_t i = 0; i < sheet.size(); ++i) sheet.position[i] = {sheet.u[i], 0, sheet.v[i]};
  pin_nodes(sheet, nodes_of_edge(sheet, "top"));
  ClothParams params = without_losses();
  params.damping = 5e-3;
  params.air.density = 50;
  ClothScratch scratch;
  for (int k = 0; k < 1000; ++k) step_cloth(sheet, params, {.measure = false}, 2e-3, scratch);
  const auto report = step_cloth(sheet, params, {}, 2e-3, scratch);
  const Real weight = total_mass(sheet) * 9.81 * 2e-3;
  EXPECT_NEAR(report.pin_impulse.z, weight, 1e-4 * weight);  // what still moves after 2 s
  EXPECT_LT(std::abs(report.pin_impulse.x), 1e-4 * weight);
}

// Stirred violently (2 m/s on cells of 25 mm) and let go, hanging by one corner.
TEST(ClothStep, energy_never_grows_without_drag_and_damping) {
  for (const ClothModel model : {ClothModel::xpbd, ClothModel::provot}) {
    for (const bool mesh : {false, true}) {
      Sheet sheet = mesh ? square_mesh(13, 0.3) : square(13, 0.3);
      stir(sheet, 2);
      pin_nodes(sheet, std::vector<Index>{156});
      ClothParams params = without_losses(model);
      params.contact.self = false;
      params.strain_error = 1e-4;
      ClothScratch scratch;
      auto last = step_cloth(sheet, params, {}, 1e-6, scratch);
      const Real first = last.kinetic_energy + last.elastic_energy + last.potential_energy;
      Real before = first, grown = 0;
      for (int k = 0; k < 400; ++k) {
        const auto r = step_cloth(sheet, params, {}, 1e-3, scratch);
        const Real energy = r.kinetic_energy + r.elastic_energy + r.potential_energy;
        if (energy > before) grown += energy - before;
        before = energy;
      }
      EXPECT_LE(grown, 1e-5 * first) << "mesh " << mesh << " provot " << (model == ClothModel::provot);
    }
  }
}

// The first tenth of a second of a metre of shirting that falls from two corners, where a few threads carry all of it. With
// tension only along threads and every pass over the whole sheet it took 475 substeps; now a third of that.
TEST(ClothStep, a_sheet_held_by_two_corners_takes_few_substeps) {
  Sheet sheet = make_sheet(GridSheet{.width = 1, .height = 1, .columns = 100, .rows = 100, .areal_mass = fabric_hand("shirting").areal_mass});
  for (const char* corner : {"bottom_left", "top_left"}) pin_nodes(sheet, nodes_of_corner(sheet, corner));
  ClothParams params;
  params.hand = fabric_hand("shirting");
  ClothScratch scratch;
  int substeps = 0;
  Real error = 0;
  for (int k = 0; k < 20; ++k) {
    const ClothStepReport r = step_cloth(sheet, params, {.measure = false}, 5e-3, scratch);
    substeps += r.substeps, error = std::max(error, r.strain_error);
  }
  EXPECT_LT(substeps, 240);
  EXPECT_LT(error, 5 * params.strain_error);  // single substeps before the step follows; with 0.2 % in the mean
}

// Where passes stop before they converge, what they leave may not jolt the cloth from substep to substep: extrapolated ones did.
TEST(ClothStep, a_sheet_that_hangs_from_four_corners_comes_to_rest) {
  Sheet sheet = make_sheet(GridSheet{.width = 0.3, .height = 0.3, .columns = 23, .rows = 23, .areal_mass = 0.15});
  const Real in = 18e-3;
  for (const auto& [corner, way] : {std::pair{"bottom_left", Vec3{in, in, 0}}, {"bottom_right", {-in, in, 0}},
                                    {"top_left", {in, -in, 0}}, {"top_right", {-in, -in, 0}}})
    pin_nodes(sheet, nodes_of_corner(sheet, corner), PinPath{{{0, {}}, {0.5, way}}});
  ClothParams params;
  params.hand = fabric_hand("shirting");
  params.damping = 0.02;
  ClothScratch scratch;
  Real fastest = 0;
  for (int k = 0; k < 700; ++k) {
    step_cloth(sheet, params, {.measure = false}, 5e-3, scratch);
    if (k >= 600) {
      for (const Vec3& v : sheet.velocity) fastest = std::max(fastest, norm(v));
    }
  }
  EXPECT_LT(fastest, 1e-3);  // m/s, from 3 s on: a twentieth of that at a solver that converges, 6e-3 where passes were extrapolated
}

// Substeps as long as the step, so that nothing but the solver keeps it stable. What moves may not gain energy; elastic
// energy of strain errors is not counted: at 1e12 N/m a strain of 1e-6 is worth more than all the rest.
TEST(ClothStep, stays_bounded_at_any_stiffness) {
  for (const Real stiffness : {1e-3, 1.0, 1e4, 1e8, 1e12}) {
    for (const ClothModel model : {ClothModel::xpbd, ClothModel::provot}) {
      for (const bool mesh : {false, true}) {
        Sheet sheet = mesh ? square_mesh(9, 0.2) : square(9, 0.2);
        stir(sheet, 1);
        pin_nodes(sheet, std::vector<Index>{72, 80});
        ClothParams params = without_losses(model);
        params.hand.stretch_weft = params.hand.stretch_warp = params.hand.shear = stiffness;
        params.hand.bending_weft = params.hand.bending_warp = params.hand.twist = 1e-6 * stiffness;
        params.provot = {.structural = stiffness, .shear = stiffness, .flexion = stiffness};
        params.longest_substep = params.shortest_substep = 2e-3;
        ClothScratch scratch;
        const Real start = kinetic_energy(sheet);
        for (int k = 0; k < 100; ++k) {
          const auto r = step_cloth(sheet, params, {}, 4e-3, scratch);
          ASSERT_LE(r.kinetic_energy + r.potential_energy, 1.05 * start) << stiffness << " mesh " << mesh << " step " << k;
        }
      }
    }
  }
}

// --- loads -----------------------------------------------------------------------------------------------------------

TEST(ClothStep, a_free_sheet_falls_at_terminal_speed) {
  // m g = rho A C v^2/2 for a flat sheet falling face down.
  Sheet sheet = square(6, 0.1);
  ClothParams params = without_losses();
  params.air.density = 1.2;
  ClothScratch scratch;
  for (int k = 0; k < 300; ++k) step_cloth(sheet, params, {.measure = false}, 5e-3, scratch);
  const Real expected = std::sqrt(2 * 0.12 * 9.81 / (1.2 * params.air.normal_drag));
  for (const Vec3& v : sheet.velocity) EXPECT_NEAR(-v.z, expected, 9.81e-3);  // g times the substep: drag follows weight
}

TEST(ClothStep, wind_carries_a_flag_away_from_its_pole) {
  Sheet sheet = square(11, 0.2);
  for (std::size_t i = 0; i < sheet.size(); ++i) sheet.position[i] = {sheet.u[i], 0.001 * std::sin(20 * sheet.u[i]), sheet.v[i]};
  pin_nodes(sheet, nodes_of_edge(sheet, "left"));
  ClothParams params = without_losses();
  params.air.density = 1.2;
  params.air.wind = {0, 8, 0};
  ClothScratch scratch;
  ClothStepReport report;
  for (int k = 0; k < 300; ++k) report = step_cloth(sheet, params, {}, 2e-3, scratch);
  EXPECT_GT(sheet.position[10].y, 0.05);
  EXPECT_GT(report.air_impulse.y, 0);
}

// --- pins ------------------------------------------------------------------------------------------------------------

TEST(ClothStep, moved_pins_follow_their_keys_and_released_ones_fall) {
  Sheet sheet = square(6, 0.1);
  const PinPath path{{{0.01, {}}, {0.03, {0, 0, 0.02}}, {0.04, {0.01, 0, 0.02}}}};
  pin_nodes(sheet, nodes_of_edge(sheet, "top"), path);
  pin_nodes(sheet, nodes_of_corner(sheet, "bottom_left"), {}, 0.05);
  ClothScratch scratch;
  const Index top = 35;
  for (int k = 1; k <= 100; ++k) {
    step_cloth(sheet, without_losses(), {.measure = false}, 1e-3, scratch);
    const Vec3 expected = Vec3{0.1, 0.1, 0} + displacement_at(path, 1e-3 * k);
    EXPECT_LT(norm(sheet.position[top] - expected), 1e-12);
    if (k <= 50) { EXPECT_LT(norm(sheet.position[0]), 1e-12); }
  }
  EXPECT_LT(sheet.position[0].z, -1e-3);
}

TEST(ClothStep, a_fixed_sheet_is_left_as_it_is) {
  Sheet sheet = square(6, 0.1);
  sheet.fixed = true;
  const Sheet before = sheet;
  ClothScratch scratch;
  const auto report = step_cloth(sheet, without_losses(), {}, 0.1, scratch);
  EXPECT_EQ(report.substeps, 0);
  EXPECT_EQ(sheet.position, before.position);
  EXPECT_EQ(sheet.time, 0.1);
}

// --- solids ----------------------------------------------------------------------------------------------------------

TEST(ClothStep, a_cloth_thrown_at_a_thin_plate_at_20_metres_per_second_stays_before_it) {
  Sheet sheet = square(16, 0.1);
  for (Vec3& v : sheet.velocity) v = {0, 0, -20};
  const std::vector<ClothSolid> solids{{.shape = Box{{0.05, 0.05, -0.01}, {1, 1, 0.002}}}};
  const ClothParams params = without_losses();
  ClothScratch scratch;
  for (int k = 0; k < 20; ++k) {
    step_cloth(sheet, params, {.solids = solids}, 1e-3, scratch);
    for (const Vec3& x : sheet.position) ASSERT_GE(x.z, -0.009 + 0.499 * params.hand.thickness);
  }
}

TEST(ClothStep, friction_holds_a_cloth_on_a_slope_up_to_its_angle) {
  for (const bool slips : {false, true}) {
    Sheet sheet = make_sheet(GridSheet{.along_u = {0.8, 0, -0.6}, .along_v = {0, 1, 0}, .width = 0.05, .height = 0.05,
                                       .columns = 6, .rows = 6, .areal_mass = 0.12});
    ClothParams params = without_losses();
    const Vec3 normal{0.6, 0, 0.8};
    for (Vec3& x : sheet.position) x += 0.5 * params.hand.thickness * normal;
    // tan(slope) = 0.75
    const std::vector<ClothSolid> solids{{.shape = Plane{{0, 0, 0}, normal}, .friction = slips ? 0.5 : 0.8}};
    ClothScratch scratch;
    for (int k = 0; k < 200; ++k) step_cloth(sheet, params, {.solids = solids, .measure = false}, 1e-3, scratch);
    const Vec3 velocity = momentum(sheet) / total_mass(sheet);
    const Real expected = slips ? 9.81 * (0.6 - 0.5 * 0.8) * 0.2 : 0;
    EXPECT_NEAR(dot(velocity, Vec3{0.8, 0, -0.6}), expected, 0.01 * 9.81 * 0.2 * 0.2);
  }
}

TEST(ClothStep, a_moving_solid_carries_the_cloth_on_it) {
  Sheet sheet = square(6, 0.05);
  const ClothParams params = without_losses();
  for (Vec3& x : sheet.position) x.z = 0.5 * params.hand.thickness;
  ClothScratch scratch;
  Real top = 0;
  for (int k = 0; k < 200; ++k) {
    const std::vector<ClothSolid> solids{{.shape = Plane{{0, 0, top}, {0, 0, 1}}, .friction = 1, .velocity = {0.05, 0, 0.1}}};
    step_cloth(sheet, params, {.solids = solids, .measure = false}, 1e-3, scratch);
    top += 1e-4;
  }
  const Vec3 velocity = momentum(sheet) / total_mass(sheet);
  EXPECT_NEAR(velocity.x, 0.05, 1e-3);
  EXPECT_NEAR(velocity.z, 0.1, 1e-3);
}

// --- models -----------------------------------------------------------------------------------------------------------

TEST(ClothStep, provot_leaves_no_spring_stretched_beyond_the_limit) {
  Sheet sheet = square(12, 0.3, 0.5);
  pin_nodes(sheet, nodes_of_edge(sheet, "top"));
  ClothParams params = without_losses(ClothModel::provot);
  params.damping = 5e-3;
  params.air.density = 20;
  params.provot = {.structural = 5, .shear = 2, .flexion = 1};  // would stretch by 15 % under its weight
  ClothScratch scratch;
  ClothStepReport report;
  for (int k = 0; k < 500; ++k) report = step_cloth(sheet, params, {.gravity = {0, -9.81, 0}}, 2e-3, scratch);
  // One pass of corrections a substep, each a little undone by the next: a twentieth of the limit.
  EXPECT_LT(report.greatest_strain, 0.105);
  params.provot.limit = 10;
  for (int k = 0; k < 500; ++k) report = step_cloth(sheet, params, {.gravity = {0, -9.81, 0}}, 2e-3, scratch);
  EXPECT_GT(report.greatest_strain, 0.14);
}

TEST(ClothStep, wet_cloth_stretches_more_where_it_is_softer) {
  const auto sag = [](Real factor) {
    Sheet sheet = square(11, 0.2);
    for (std::size_t i = 0; i < sheet.size(); ++i) sheet.position[i] = {sheet.u[i], 0, sheet.v[i]};
    pin_nodes(sheet, nodes_of_edge(sheet, "top"));
    std::fill(sheet.stiffness_factor.begin(), sheet.stiffness_factor.end(), factor);
    ClothParams params = without_losses();
    params.hand.stretch_weft = params.hand.stretch_warp = 20;
    params.damping = 0.02;
    params.air.density = 50;
    ClothScratch scratch;
    for (int k = 0; k < 600; ++k) step_cloth(sheet, params, {.measure = false}, 2e-3, scratch);
    return -sheet.position[5].z;
  };
  // A hanging strip of length L stretches by sigma g L^2/(2 K f).
  const Real dry = 0.12 * 9.81 * 0.04 / (2 * 20);
  EXPECT_NEAR(sag(1), dry, 0.01 * dry);
  EXPECT_NEAR(sag(0.5), 2 * dry, 0.01 * 2 * dry);
}

TEST(ClothStep, the_same_bits_for_any_number_of_threads) {
  const auto run = [](int threads) {
    const ThreadLimit limit(threads);
    Sheet sheet = square(60, 0.6);
    pin_nodes(sheet, nodes_of_corner(sheet, "top_left"));
    ClothParams params = without_losses();
    params.air.density = 1.2;
    const std::vector<ClothSolid> solids{{.shape = Sphere{{0.3, 0.3, -0.06}, 0.05}}};
    ClothScratch scratch;
    for (int k = 0; k < 20; ++k) step_cloth(sheet, params, {.solids = solids, .measure = false}, 2e-3, scratch);
    return sheet.position;
  };
  EXPECT_EQ(run(1), run(2));
}

TEST(ClothStep, a_position_that_is_not_finite_is_a_numerical_error) {
  Sheet sheet = square(4, 0.1);
  sheet.velocity[5] = {std::numeric_limits<Real>::quiet_NaN(), 0, 0};
  ClothParams params = without_losses();
  params.contact.self = false;
  ClothScratch scratch;
  EXPECT_THROW(step_cloth(sheet, params, {}, 1e-3, scratch), NumericalError);
}

TEST(ClothStep, a_ball_does_not_look_through_the_cloth_that_lies_on_it) {
  // Edges of a seventh of the radius, as in the scene of a towel on a ball.
  const Real radius = 0.09;
  Sheet sheet = make_sheet(GridSheet{.corner = {-0.18, -0.18, radius + 1e-3}, .width = 0.36, .height = 0.36, .columns = 31,
                                     .rows = 31, .areal_mass = 0.25});
  ClothParams params;
  params.hand = fabric_hand("jersey");
  const std::vector<ClothSolid> ball{{.shape = Sphere{.centre = {}, .radius = radius}}};
  ClothScratch scratch;
  for (int k = 0; k < 60; ++k) step_cloth(sheet, params, {.solids = ball, .measure = false}, 5e-3, scratch);
  Real nearest = 1;
  std::size_t touching = 0;
  for (const auto& t : sheet.triangles) {
    const Vec3 &a = sheet.position[t[0]], &b = sheet.position[t[1]], &c = sheet.position[t[2]];
    const Real centre = norm(closest_on_triangle({}, a, b, c).point) - radius;
    nearest = std::min(nearest, centre);
    touching += centre < 1e-3 ? 1 : 0;
  }
  EXPECT_GT(touching, 50u);
  EXPECT_GT(nearest, -1e-5);  // a hundredth of an edge's rise: corners are led out in time, not at once
}

}  // namespace
}  // namespace imbibe
