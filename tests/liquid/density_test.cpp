#include "imbibe/liquid/density.h"

#include <gtest/gtest.h>

#include <cmath>

#include "imbibe/liquid/contact_angle.h"
#include "imbibe/liquid/damping.h"
#include "lattice_block.h"

namespace imbibe {
namespace {

TEST(Density, a_lattice_has_the_rest_density_but_for_the_disorder_that_it_lacks) {
  const Block b(10, 8, 0, false);
  const float middle = 0.5f * 8 * std::cbrt(2.0f) * spacing;
  int counted = 0;
  b.each_away_from_sides(10, [&](std::size_t i) {
    if (std::abs(b.f.position[i].z - middle) > 0.8f * spacing) return;
    EXPECT_NEAR(b.f.colour[i], 1 - disorder_excess, 1e-3);  // liquid that has flowed has one, a lattice is closer packed
    EXPECT_NEAR(b.f.density_error[i], -disorder_excess, 1e-3);
    ++counted;
  });
  EXPECT_GT(counted, 50);
}

TEST(Density, a_flat_free_surface_has_almost_the_same_completed_density_as_the_inside) {
  const Block b(10, 8, 0, false);
  b.each_away_from_sides(10, [&](std::size_t i) {
    // Half a spacing under the surface 33 % of the kernel is missing; completed, 3 % remain (a lattice is no continuum).
    EXPECT_NEAR(b.f.density_error[i], 0, 0.035);
    if (b.f.colour_gradient[i].w > 1) {
      EXPECT_LT(b.f.colour[i], 0.85);
    }
  });
}

TEST(Density, air_completion_inverts_the_half_space) {
  for (Real depth : {0.02, 0.1, 0.2, 0.4, 0.6, 0.9}) {
    const SolidIntegral air = half_space_integral(depth, 1);
    EXPECT_NEAR(air_completion(static_cast<float>(-air.slope)), air.lambda, 1e-3);  // linear table of 512, steep at d = 0
  }
  EXPECT_FLOAT_EQ(air_completion(0), 0);
  EXPECT_NEAR(air_completion(2), 0.5, 1e-2);  // steeper than any flat surface
}

TEST(Density, spray_may_be_thin_but_not_compressed) {
  EXPECT_FLOAT_EQ(density_error(0.3f, 0, 0.5f), 0);
  EXPECT_NEAR(density_error(1.2f, 0, 0), 0.2, 1e-6);
  EXPECT_GE(density_error(0.8f, 0, 0), -0.05f);
}

TEST(Density, a_wall_counts_under_liquid_that_stands_on_it_and_not_across_a_gap) {
  for (const Real gap : {0.0, 1.5}) {
    const Block b(10, 5, 0.05, true, gap * spacing);
    int counted = 0;
    b.each_away_from_sides(10, [&](std::size_t i) {
      const auto walls = b.f.boundary.samples(i);
      if (walls.empty() || walls[0].lambda < 1e-3f) return;  // at the rim of the support the factor multiplies nothing
      const Float4& wall = b.f.boundary.wall[i];
      EXPECT_NEAR(wall.w, gap == 0 ? walls[0].lambda : 0, 1e-6) << gap << " " << b.f.position[i].z / spacing;
      EXPECT_EQ(norm(walls[0].push) > 0, gap == 0);
      ++counted;
    });
    EXPECT_GT(counted, 15) << gap;
  }
}

TEST(Density, in_a_corner_a_wall_across_a_gap_does_not_count_and_the_other_does) {
  // A block on the floor, a wall two spacings beside it: seen through the gap by the outermost particles.
  Block b(10, 5, 0.05, true);
  const Shape beside = Plane{{-1.6 * spacing, 0, 0}, {1, 0, 0}};
  b.walls.push_back({&beside, {}, {}, false});
  sample_walls(b.f.boundary, b.f.position, b.f.count, b.walls, b.f.neighbours.kernel);
  compute_density(b.f);
  int both = 0;
  for (std::size_t i = 0; i < b.f.count; ++i) {
    const auto walls = std::as_const(b.f.boundary).samples(i);
    const Float4& x = b.f.position[i];
    if (walls.size() < 2 || x.y < 3 * spacing || x.y > 9 * spacing || x.z > spacing) continue;
    ++both;
    const Float4& push = b.f.boundary.push[i];
    EXPECT_LT(std::abs(push.x), 0.02f * std::abs(push.z)) << x.x / spacing;  // contact fades between 0.5/H and 0.9/H
    EXPECT_LT(push.z, 0) << x.x / spacing;
    EXPECT_NEAR(b.f.boundary.wall[i].w, walls[0].wall == 0 ? walls[0].lambda : walls[1].lambda, 1e-3);
  }
  EXPECT_GE(both, 4);
}

TEST(Damping, conserves_momentum_takes_energy_and_leaves_a_rigid_motion) {
  Block b(8, 6, 0.1, false);
  const Vec3 before = b.momentum();
  const Real energy = b.energy();
  damp_small_scales(b.f, 0.5f);
  EXPECT_LT(norm(b.momentum() - before), 1e-6);
  EXPECT_LT(b.energy(), 0.8 * energy);  // white noise is mostly of small scale
  for (std::size_t i = 0; i < b.f.count; ++i) b.f.velocity[i] = {1, 2, 3, 0};
  damp_small_scales(b.f, 0.5f);
  for (std::size_t i = 0; i < b.f.count; ++i) EXPECT_NEAR(b.f.velocity[i].y, 2, 1e-5);
}

TEST(ContactAngle, a_line_between_receding_and_advancing_feels_no_force) {
  const auto cosine = [](Real deg) { return static_cast<float>(std::cos(radians(deg))); };
  const float advancing = cosine(100), receding = cosine(70);
  EXPECT_FLOAT_EQ(unbalanced_cosine(cosine(85), advancing, receding), 0);
  EXPECT_GT(unbalanced_cosine(cosine(110), advancing, receding), 0);  // too blunt: spreads
  EXPECT_LT(unbalanced_cosine(cosine(50), advancing, receding), 0);   // too sharp: withdraws
  EXPECT_FLOAT_EQ(unbalanced_cosine(cosine(60), cosine(90), cosine(90)), -cosine(60));
}

}  // namespace
}  // namespace imbibe
