#include "imbibe/liquid/liquid_step.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "imbibe/core/error.h"
#include "imbibe/liquid/source.h"

namespace imbibe {
namespace {

constexpr Vec3 earth{0, 0, -9.81};

Liquid liquid_of(const std::vector<Source>& sources, Real spacing) {
  Liquid liquid;
  liquid.particle_mass = liquid.kind.density * spacing * spacing * spacing;
  for (Source source : sources) emit(source, liquid, 0, 1);
  return liquid;
}

Vec3 mean_velocity(const Liquid& liquid) {
  Vec3 sum{};
  for (const Float4& u : liquid.particles.velocity) sum += Vec3{u.x, u.y, u.z};
  return sum / static_cast<Real>(liquid.particles.size());
}

std::vector<Wall> walls_of(const std::vector<Shape>& shapes) {
  std::vector<Wall> walls;
  for (const Shape& shape : shapes) walls.push_back({&shape, {}, {}, false});
  return walls;
}

// A square column of the given width, 10 mm high, between four side walls on a floor.
struct Column {
  explicit Column(Real w)
      : shapes{Plane{}, Plane{{-w / 2, 0, 0}, {1, 0, 0}}, Plane{{w / 2, 0, 0}, {-1, 0, 0}},
               Plane{{0, -w / 2, 0}, {0, 1, 0}}, Plane{{0, w / 2, 0}, {0, -1, 0}}},
        liquid(liquid_of({{.form = SourceForm::box, .centre = {0, 0, 5e-3}, .size = {w, w, 10e-3}}}, 5e-4)) {}
  std::vector<Shape> shapes;
  Liquid liquid;
  LiquidParams params;
};

TEST(LiquidStep, a_resting_column_has_the_hydrostatic_pressure_and_the_floor_carries_its_weight) {
  Column c(10e-3);
  c.params.surface_tension = false;
  c.liquid.kind.viscosity = 0.05;  // so that it soon rests
  const std::vector<Wall> walls = walls_of(c.shapes);
  LiquidScratch scratch;
  Real time = 0, averaged = 0;
  Vec3 impulse{};
  Real slope_sum = 0;
  int samples = 0;
  while (time < 0.18) {
    const LiquidStepReport report = step_liquid(c.liquid, c.params, walls, earth, 1, scratch);
    time += report.step_s;
    if (time < 0.12) continue;
    averaged += report.step_s;
    for (const Vec3& i : report.wall_impulse) impulse += i;
    // Least-squares slope of pressure over height.
    Real z = 0, p = 0, zz = 0, zp = 0;
    const auto n = static_cast<Real>(c.liquid.particles.size());
    for (std::size_t i = 0; i < c.liquid.particles.size(); ++i) {
      const Real h = c.liquid.particles.position[i].z, q = c.liquid.particles.pressure[i];
      z += h / n, p += q / n, zz += h * h / n, zp += h * q / n;
    }
    slope_sum += (zp - z * p) / (zz - z * z);
    ++samples;
    EXPECT_LT(report.density_error, 1e-3);  // the stated default
  }
  const Real weight = c.liquid.mass() * 9.81;
  // Measured 1.9 % too steep; 2.1 % in a tube 10 spacings wide.
  EXPECT_NEAR(slope_sum / samples, -998.2 * 9.81, 0.02 * 998.2 * 9.81);
  EXPECT_NEAR(-impulse.z / averaged, weight, 0.02 * weight);
  EXPECT_NEAR(impulse.x / averaged, 0, 0.02 * weight);
}

TEST(LiquidStep, a_drop_in_free_fall_keeps_its_shape_and_falls_with_g) {
  Liquid drop = liquid_of({{.volume = 4e-9}}, 2e-4);
  LiquidScratch scratch;
  Real time = 0;
  while (time < 5e-3) time += step_liquid(drop, {}, {}, earth, 5e-3 - time, scratch).step_s;
  // Nothing else acts: the sum of all inner forces is the rounding of single precision.
  EXPECT_NEAR(mean_velocity(drop).z, -9.81 * time, 1e-4 * 9.81 * time);
  EXPECT_NEAR(mean_velocity(drop).x, 0, 1e-4 * 9.81 * time);
}

TEST(LiquidStep, momentum_is_conserved_when_drops_collide_in_the_air) {
  Liquid liquid = liquid_of({{.centre = {-1.1e-3, 0, 0}, .volume = 4e-9, .velocity = {0.5, 0, 0}},
                             {.centre = {1.1e-3, 2e-4, 0}, .volume = 4e-9, .velocity = {-0.3, 0.1, 0}}},
                            2e-4);
  const Vec3 before = mean_velocity(liquid);
  LiquidScratch scratch;
  Real time = 0, peak = 0;
  while (time < 3e-3) {
    const LiquidStepReport report = step_liquid(liquid, {}, {}, {}, 1, scratch);
    time += report.step_s;
    peak = std::max(peak, report.peak_density_error);
    ASSERT_LT(report.max_speed, 2) << "burst at " << time;
  }
  EXPECT_LT(norm(mean_velocity(liquid) - before), 1e-9);  // of speeds of 0.5 m/s, over 100 steps (momentum.h)
  RecordProperty("peak_density_error_percent", std::to_string(100 * peak));
}

TEST(LiquidStep, many_drops_merge_without_a_pressure_burst) {
  std::vector<Source> drops;
  for (int k = 0; k < 8; ++k) {
    drops.push_back({.centre = {(k % 2) * 5e-3, (k / 2 % 2) * 5e-3, 4e-3 + (k / 4) * 5e-3},
                     .volume = 50e-9,
                     .velocity = {0.15 - (k % 2) * 0.3, 0.15 - (k / 2 % 2) * 0.3, -0.3}});
  }
  Liquid liquid = liquid_of(drops, 6e-4);
  const std::vector<Shape> shapes{Plane{}};
  const std::vector<Wall> walls = walls_of(shapes);
  LiquidScratch scratch;
  Real time = 0, peak = 0, mean = 0;
  while (time < 0.02) {
    const LiquidStepReport report = step_liquid(liquid, {}, walls, earth, 1, scratch);
    time += report.step_s;
    peak = std::max(peak, report.peak_density_error);
    // A burst would throw particles faster than anything a hit at 0.6 m/s makes (jets of three times that).
    ASSERT_LT(report.max_speed, 2) << time;
    mean = std::max(mean, report.density_error);
  }
  std::printf("  merging: density error %.2f %% in the mean of the worst step, %.0f %% at one particle\n", 100 * mean,
              100 * peak);
  EXPECT_LT(mean, 0.02);
  EXPECT_LT(peak, 0.4);
}

TEST(LiquidStep, has_the_same_bits_for_any_number_of_threads_and_a_fresh_scratch) {
  std::vector<Liquid> results;
  for (const int threads : {1, 2, 3}) {
    const ThreadLimit limit(threads);
    Column c(5e-3);
    const std::vector<Wall> walls = walls_of(c.shapes);
    LiquidScratch scratch;
    for (int k = 0; k < 15; ++k) {
      if (threads == 2) scratch = {};  // a cache, not state
      step_liquid(c.liquid, c.params, walls, earth, 1, scratch);
    }
    results.push_back(c.liquid);
  }
  for (std::size_t r = 1; r < results.size(); ++r) {
    ASSERT_EQ(results[r].particles.id, results[0].particles.id);
    for (std::size_t i = 0; i < results[0].particles.size(); ++i) {
      const Float4 &a = results[0].particles.position[i], &b = results[r].particles.position[i];
      const Float4 &u = results[0].particles.velocity[i], &v = results[r].particles.velocity[i];
      ASSERT_TRUE(a.x == b.x && a.y == b.y && a.z == b.z && u.x == v.x && u.y == v.y && u.z == v.z) << i;
    }
  }
}

TEST(LiquidStep, the_step_is_the_shortest_bound_and_says_which) {
  Liquid drop = liquid_of({{.volume = 4e-9}}, 2e-4);
  LiquidParams params;
  EXPECT_STREQ(liquid_step_bound(drop, params, earth).bound, "capillary");
  EXPECT_NEAR(liquid_step_bound(drop, params, earth).step_s, 0.5 * std::sqrt(998.2 * 8e-12 / (2 * pi * 0.0728)), 1e-9);
  for (Float4& u : drop.particles.velocity) u.z = -10;
  EXPECT_STREQ(liquid_step_bound(drop, params, earth).bound, "convective");
  EXPECT_NEAR(liquid_step_bound(drop, params, earth).step_s, 0.4 * 2e-4 / 10, 1e-10);
  LiquidScratch scratch;
  const LiquidStepReport report = step_liquid(drop, params, {}, earth, 1e-6, scratch);
  EXPECT_STREQ(report.bound, "given");
  EXPECT_EQ(report.step_s, 1e-6);
  params.surface_tension = false;
  for (Float4& u : drop.particles.velocity) u.z = 0;
  EXPECT_STREQ(liquid_step_bound(drop, params, earth).bound, "gravity");
}

TEST(LiquidStep, no_particle_passes_a_sheet_or_ends_in_a_solid) {
  const std::vector<Shape> shapes{Box{{0, 0, 0}, {10e-3, 10e-3, 0.2e-3}}, Sphere{{0, 0, 2.5e-3}, 1e-3}};
  std::vector<Wall> walls = walls_of(shapes);
  walls[0].two_sided = true;
  Liquid liquid = liquid_of({{.centre = {0, 0, 5e-3}, .volume = 8e-9, .velocity = {0, 0, -2}}}, 2e-4);
  LiquidScratch scratch;
  Real time = 0;
  while (time < 3e-3) {
    time += step_liquid(liquid, {}, walls, earth, 1, scratch).step_s;
    for (const Float4& f : liquid.particles.position) {
      const Vec3 p{f.x, f.y, f.z};
      ASSERT_GE(nearest_surface(shapes[1], p).distance, 0) << time;
      if (std::abs(p.x) < 5e-3 && std::abs(p.y) < 5e-3) {
        ASSERT_GE(p.z, 0.1e-3) << time;
      }
    }
  }
}

TEST(LiquidStep, a_velocity_that_is_not_finite_is_a_numerical_error) {
  Liquid drop = liquid_of({{.volume = 1e-9}}, 2e-4);
  drop.particles.velocity[5].x = std::numeric_limits<float>::quiet_NaN();
  LiquidScratch scratch;
  EXPECT_THROW(step_liquid(drop, {}, {}, earth, 1e-5, scratch), NumericalError);
}

TEST(LiquidStep, no_liquid_is_no_work) {
  Liquid none;
  none.particle_mass = 1e-9;
  LiquidScratch scratch;
  EXPECT_EQ(step_liquid(none, {}, {}, earth, 1e-3, scratch).step_s, 1e-3);
}

}  // namespace
}  // namespace imbibe
