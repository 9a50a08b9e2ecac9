#include "imbibe/liquid/gradient_correction.h"

#include <gtest/gtest.h>

#include "imbibe/liquid/pressure.h"
#include "lattice_block.h"

namespace imbibe {
namespace {

// D(u) of the block's velocity into f.source: the step's own operator, no iteration.
void compression(Block& b) {
  PressureParams params;
  params.max_iterations = 0;
  std::vector<float> none(b.f.count, 0.0f);
  project_velocity(b.f, params, 1, 0, none);
}

Real distance_from_unit(const LiquidFields& f, std::size_t i) {
  Real square = 0;
  for (std::size_t r = 0; r < 3; ++r) {
    const Float4& row = f.correction[3 * i + r];
    const Vec3 off = Vec3{row.x, row.y, row.z} - Vec3{r == 0 ? 1.0 : 0.0, r == 1 ? 1.0 : 0.0, r == 2 ? 1.0 : 0.0};
    square += squared_norm(off);
  }
  return std::sqrt(square);
}

TEST(GradientCorrection, sees_a_shear_as_free_of_compression_however_the_particles_lie) {
  Real worst[2] = {0, 0};
  for (const bool corrected : {false, true}) {
    Block b(10, 10, 0.2, false);
    if (corrected) correct_gradients(b.f, PressureParams{}.spray_filling);
    const Real rate = 10;
    for (std::size_t i = 0; i < b.f.count; ++i) {
      const Float4& x = b.f.position[i];
      b.f.velocity[i] = {static_cast<float>(rate * (x.y + 0.5 * x.x)), static_cast<float>(-0.5 * rate * x.y), 0, 0};
    }
    compression(b);
    const float reach = b.f.neighbours.kernel.support, end = 10 * std::cbrt(2.0f) * spacing;
    b.each_away_from_sides(10, [&](std::size_t i) {
      if (b.f.position[i].z < reach || b.f.position[i].z > end - reach || b.f.colour_gradient[i].w > 0.07f) return;
      worst[corrected] = std::max(worst[corrected], std::abs(Real(b.f.source[i])) / rate);
    });
  }
  std::printf("  compression of a shear of rate 1: %.4f plain, %.2g corrected\n", worst[0], worst[1]);
  EXPECT_GT(worst[0], 0.01);
  EXPECT_LT(worst[1], 2e-5);  // single-precision sums over 65 neighbours
}

TEST(GradientCorrection, leaves_a_lattice_at_rest_as_it_is_at_a_wall_and_under_air_too) {
  // The block's rim aside, a lattice is evenly spread: what differs from one are its sums, which are no integrals.
  Block b(12, 6, 0, true);
  correct_gradients(b.f, PressureParams{}.spray_filling);
  Real inside = 0, outside = 0;
  const float reach = b.f.neighbours.kernel.support, top = 6 * std::cbrt(2.0f) * spacing;
  b.each_away_from_sides(12, [&](std::size_t i) {
    const bool whole = b.f.position[i].z > reach && b.f.position[i].z < top - reach;
    Real& most = whole ? inside : outside;
    most = std::max(most, distance_from_unit(b.f, i));
  });
  std::printf("  |L - I|: inside %.4f, at faces %.4f\n", inside, outside);
  EXPECT_LT(inside, 0.01);
  EXPECT_LT(outside, 0.1);  // depth from the gradient of single layers, less what may be disorder (0.07/H)
}

TEST(GradientCorrection, keeps_momentum_and_angular_momentum_of_a_free_body) {
  Block b(7, 7, 0.2, false);
  correct_gradients(b.f, PressureParams{}.spray_filling);
  const auto spin = [&] {
    Vec3 sum{};
    for (std::size_t i = 0; i < b.f.count; ++i) {
      const Float4 &x = b.f.position[i], &u = b.f.velocity[i];
      sum += cross(Vec3{x.x, x.y, x.z}, Vec3{u.x, u.y, u.z});
    }
    return sum;
  };
  const Vec3 momentum = b.momentum(), angular = spin();
  PressureParams params;
  params.tolerance = 1e-6;
  const PressureReport report = project_velocity(b.f, params, 1e-6, 0, b.liquid.particles.warm_pressure);
  EXPECT_TRUE(report.converged);
  EXPECT_LT(norm(b.momentum() - momentum), 1e-5);  // as with plain gradients (pressure_test)
  Real change = 0;  // what the particles' speeds changed by, times their distance from the middle
  for (std::size_t i = 0; i < b.f.count; ++i) {
    const Float4 &u = b.f.velocity[i], &v = b.liquid.particles.velocity[i];
    change += norm(Vec3{u.x - v.x, u.y - v.y, u.z - v.z}) * 4 * spacing;
  }
  // L M is symmetric for every particle whose correction is not cut at one half; few are, at corners of the block.
  EXPECT_LT(norm(spin() - angular), 1e-3 * change);
}

TEST(GradientCorrection, is_none_for_spray_and_bounded_everywhere) {
  Block b(5, 5, 0.3, false);
  correct_gradients(b.f, PressureParams{}.spray_filling);
  for (std::size_t i = 0; i < b.f.count; ++i) {
    if (b.f.filling[i] < 0.4f) {
      EXPECT_EQ(distance_from_unit(b.f, i), 0);
    }
    EXPECT_LE(distance_from_unit(b.f, i), 0.5 + 1e-5);
  }
}

}  // namespace
}  // namespace imbibe
