// Surface tension [N/m] and contact angle [deg] go in; do they come out? Drops of water, 50 uL, without gravity unless
// said, on the real step. Every figure of docs/decisions/0002 that a test can hold is held here, in short form.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "imbibe/core/random.h"
#include "imbibe/liquid/drop_measure.h"
#include "imbibe/liquid/liquid_step.h"
#include "imbibe/liquid/source.h"

namespace imbibe {
namespace {

constexpr Real drop_volume = 50e-9;  // m3
const Real drop_radius = std::cbrt(3 * drop_volume / (4 * pi));

// A spherical cap of unit volume sphere: lengths in R0, the radius of the sphere of its volume.
struct Cap {
  Real angle = 0, radius = 0, height = 0, base = 0, centre_height = 0, mean_square = 0;  // <x2 + y2>
  explicit Cap(Real theta) : angle(theta) {
    const Real c = std::cos(theta);
    radius = std::cbrt(4 / ((2 + c) * (1 - c) * (1 - c)));
    height = radius * (1 - c);
    base = radius * std::sin(theta);
    constexpr int slices = 400;
    for (int k = 0; k < slices; ++k) {
      const Real z = (k + 0.5) * height / slices;
      const Real square = radius * radius - (radius - height + z) * (radius - height + z);
      const Real share = pi * square * height / slices / (4 * pi / 3);
      centre_height += share * z;
      mean_square += share * square / 2;
    }
  }
};

// The cap angle at which `rising` (a function that rises with the angle) has the wanted value.
template <class Rising>
Real angle_where(Rising rising, Real wanted) {
  Real low = radians(2), high = radians(178);
  for (int i = 0; i < 50; ++i) {
    const Real middle = 0.5 * (low + high);
    (rising(Cap(middle)) < wanted ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

struct Scene {
  Liquid liquid;
  LiquidParams params;
  LiquidScratch scratch;
  Shape plane = Plane{};
  std::vector<Wall> walls;
  Vec3 gravity{};
  Real time = 0;
  Real unit = 0;  // s, capillary time sqrt(rho R0^3/gamma)
  Real error_sum = 0, vertical_force = 0;
  int steps = 0;

  LiquidStepReport step() {
    LiquidStepReport r = step_liquid(liquid, params, walls, gravity, 1, scratch);
    time += r.step_s;
    error_sum += r.density_error;
    vertical_force += r.surface_force.z;
    ++steps;
    return r;
  }
  void until(Real capillary_times) {
    error_sum = vertical_force = 0, steps = 0;
    while (time < capillary_times * unit) step();
  }
};

// Points of a body-centred lattice of `resolution` spacings per R0 for which inside(x / R0) holds.
template <class Inside>
std::vector<Vec3> lattice_points(int resolution, Inside inside) {
  std::vector<Vec3> points;
  const Real edge = std::cbrt(2.0) / resolution;
  const int reach = 3 * resolution;
  for (int i = -reach; i < reach; ++i)
    for (int j = -reach; j < reach; ++j)
      for (int k = -reach; k < reach; ++k)
        for (Real half : {0.25, 0.75}) {
          const Vec3 x{(i + half) * edge, (j + half) * edge, (k + half) * edge};
          if (inside(x)) points.push_back(x);
        }
  return points;
}

Scene scene_of(const std::vector<Vec3>& points, int resolution) {
  Scene s;
  const auto count = static_cast<Real>(points.size());
  s.liquid.particle_mass = s.liquid.kind.density * drop_volume / count;
  const Real spacing = s.liquid.spacing(), scale = spacing * resolution;
  std::uint64_t id = 0;
  for (const Vec3& x : points) {
    const auto jitter = [&](std::uint64_t stream) { return 0.02 * spacing * (2 * uniform({1, id, 0}, stream) - 1); };
    add_particle(s.liquid, x * scale + Vec3{jitter(0), jitter(1), jitter(2)}, {});
    ++id;
  }
  s.unit = std::sqrt(s.liquid.kind.density * std::pow(drop_radius, 3) / s.liquid.kind.surface_tension);
  return s;
}

Scene free_drop(int resolution) {
  return scene_of(lattice_points(resolution, [](const Vec3& x) { return squared_norm(x) < 1; }), resolution);
}

// A sphere of the drop's size cut by the plane: centre_height < radius. Stands on a plane with the given angle.
Scene standing_drop(int resolution, Real radius, Real centre_height, Real angle_deg) {
  Scene s = scene_of(lattice_points(resolution,
                                    [&](const Vec3& x) {
                                      return x.z > 0 && squared_norm(x - Vec3{0, 0, centre_height}) < radius * radius;
                                    }),
                     resolution);
  WallMaterial material;
  material.contact_angle = radians(angle_deg);
  s.walls.push_back({&s.plane, material, {}, false});
  return s;
}

struct Moments {
  Vec3 centre{};                    // R0
  Real along = 0, across = 0;       // <(z - z_c)^2>, <x2 + y2>, in R0^2
};

Moments moments(const Scene& s) {
  Moments m;
  const auto& x = s.liquid.particles.position;
  const auto n = static_cast<Real>(x.size());
  for (const Float4& p : x) m.centre += Vec3{p.x, p.y, p.z} * (1 / n / drop_radius);
  for (const Float4& p : x) {
    const Vec3 d = Vec3{p.x, p.y, p.z} / drop_radius - m.centre;
    m.along += d.z * d.z / n, m.across += (d.x * d.x + d.y * d.y) / n;
  }
  return m;
}

// Mean pressure of particles well inside.
Real inner_pressure(const Scene& s) {
  Real sum = 0, count = 0;
  for (std::size_t i = 0; i < s.liquid.particles.size(); ++i) {
    if (s.scratch.fields.colour_gradient[i].w > 0.15f) continue;
    sum += s.liquid.particles.pressure[i], count += 1;
  }
  return sum / count;
}

// The contact angle from the height of the centre of mass (all particles, least noise), for the drop's own volume. The
// volume is what the shape's second moment says beside it: an angle with a wrong volume is no angle.
struct Measured {
  Real angle_deg = 0, volume = 0, base = 0;
};

Measured measure(const Scene& s, const char* name) {
  const Moments m = moments(s);
  Measured r;
  r.angle_deg = degrees(angle_where([](const Cap& c) { return c.centre_height; }, m.centre.z));
  const Cap alike(angle_where([](const Cap& c) { return c.centre_height / std::sqrt(c.mean_square); },
                              m.centre.z / std::sqrt(m.across)));
  r.volume = std::pow(m.centre.z / alike.centre_height, 3);
  r.base = alike.base * std::cbrt(r.volume);
  std::printf("  %s: angle %.1f deg, volume %.3f, base %.3f R0, density error %.4f %%, force %.3f of theory\n", name,
              r.angle_deg, r.volume, r.base, 100 * s.error_sum / s.steps,
              s.vertical_force / s.steps /
                  (-2 * pi * r.base * drop_radius * s.liquid.kind.surface_tension * std::sin(alike.angle)));
  return r;
}

TEST(Drop, at_rest_has_the_laplace_pressure_its_volume_and_stays_where_it_is) {
  Scene s = free_drop(8);
  const Vec3 start = moments(s).centre;
  s.until(1.5);
  const Moments m = moments(s);
  const Real laplace = 2 * s.liquid.kind.surface_tension / drop_radius;
  std::printf("  pressure %.3f of 2 gamma/R, density error %.4f %%\n", inner_pressure(s) / laplace,
              100 * s.error_sum / s.steps);
  EXPECT_NEAR(inner_pressure(s) / laplace, 1, 0.03);  // 5 % is the stated goal
  EXPECT_NEAR(std::pow(5.0 / 3 * (m.along + m.across), 1.5), 1, 0.01);  // radius of gyration of a sphere
  // 1 um in 19 ms; a gather form without the balance of free drops drifts by 40 um.
  EXPECT_LT(norm(m.centre - start), 5e-4);
  EXPECT_LT(s.error_sum / s.steps, 2e-3);  // from a jittered lattice; below 1e-3 at rest, see below
  s.until(2.5);
  EXPECT_LT(s.error_sum / s.steps, 1e-3);
}

TEST(Drop, oscillates_with_rayleighs_period) {
  Scene s = free_drop(8);
  for (Float4& p : s.liquid.particles.position) {
    const Real r = std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z), c = p.z / r;
    const auto stretch = static_cast<float>(1 + 0.08 * (3 * c * c - 1) / 2);
    p.x *= stretch, p.y *= stretch, p.z *= stretch;
  }
  // Zero crossings of the elongation, from the second half period on (the lattice relaxes in the first).
  std::vector<Real> crossings;
  Real before = 0, before_time = 0;
  while (s.time < 4.2 * s.unit) {
    const Moments m = moments(s);
    const Real now = std::sqrt(2 * m.along / m.across) - 1;
    if (before * now < 0) crossings.push_back(before_time + (s.time - before_time) * before / (before - now));
    before = now, before_time = s.time;
    s.step();
  }
  ASSERT_GE(crossings.size(), 3u);
  const Real period = 2 * (crossings.back() - crossings.front()) / static_cast<Real>(crossings.size() - 1);
  const Real theory = 2 * pi / std::sqrt(8.0) * s.unit;
  std::printf("  period %.4f of Rayleigh's, %zu crossings\n", period / theory, crossings.size());
  EXPECT_NEAR(period / theory, 1, 0.06);  // the stated goal
}

TEST(Drop, spreads_to_45_degrees) {
  Scene s = standing_drop(8, std::cbrt(2.0), 0, 45);
  s.until(5);
  const Measured m = measure(s, "45 from 90");
  EXPECT_NEAR(m.angle_deg, 45, 8);  // the stated goal
}

TEST(Drop, stands_at_90_degrees) {
  Scene s = standing_drop(8, std::cbrt(2.0), 0, 90);
  s.until(3.5);
  const Measured m = measure(s, "90 from 90");
  EXPECT_NEAR(m.angle_deg, 90, 8);
  EXPECT_LT(s.error_sum / s.steps, 1e-3);
}

TEST(Drop, stands_at_120_degrees_from_a_tall_start) {
  const Cap tall(radians(130));
  Scene s = standing_drop(8, tall.radius, tall.height - tall.radius, 120);
  s.until(5);
  const Measured m = measure(s, "120 from 130");
  EXPECT_NEAR(m.angle_deg, 120, 8);
}

TEST(Drop, is_held_down_by_the_tension_of_its_contact_line_and_pulls_the_wall_up) {
  for (const Real angle : {45, 90, 120}) {
    const Cap cap(radians(angle));
    Scene s = standing_drop(11, cap.radius, cap.height - cap.radius, angle);
    s.until(0.4);  // the lattice relaxes
    s.error_sum = s.vertical_force = 0, s.steps = 0;
    Real all = 0, pressure = 0, since = s.time;
    while (s.time < 1.2 * s.unit) {
      const LiquidStepReport r = s.step();
      all += r.wall_impulse[0].z, pressure += r.wall_pressure_impulse[0].z;
    }
    const DropMeasure m = measure_sessile_drop(s.liquid, Plane{}, 0);
    const Real theory = -2 * pi * m.base_radius * s.liquid.kind.surface_tension * std::sin(m.fit_angle);
    std::printf("  %3.0f deg: %.1f by the profile, %.1f by the slope; force %.3f of theory, by pressure %.3f; volume %.4f\n",
                angle, degrees(m.fit_angle), degrees(m.slope_angle), s.vertical_force / s.steps / theory,
                pressure / (s.time - since) / theory, m.volume / drop_volume);
    EXPECT_NEAR(degrees(m.fit_angle), angle, 5);
    EXPECT_NEAR(m.volume / drop_volume, 1, 0.01);                    // the stated goal
    EXPECT_NEAR(s.vertical_force / s.steps / theory, 1, 0.05);       // the stated goal
    EXPECT_NEAR(pressure / (s.time - since) / theory, 1, 0.05);      // without weight pressure holds against the line
    EXPECT_NEAR(all / (s.time - since) / theory, 0, 0.02);           // and the wall feels nothing in all
  }
}

// Born as scenes bear it: a cap on the plane.
Scene cap_of(Real volume, int resolution, Real cap_angle_deg, Real angle_deg) {
  Scene s;
  const Real radius = std::cbrt(3 * volume / (4 * pi));
  s.liquid.particle_mass = s.liquid.kind.density * std::pow(radius / resolution, 3);
  Source drop;
  drop.volume = volume, drop.cap_angle = radians(cap_angle_deg);
  emit(drop, s.liquid, 0, 1);
  WallMaterial material;
  material.contact_angle = radians(angle_deg);
  s.walls.push_back({&s.plane, material, {}, false});
  s.unit = std::sqrt(s.liquid.kind.density * std::pow(radius, 3) / s.liquid.kind.surface_tension);
  return s;
}

TEST(Drop, that_draws_together_from_flat_leaves_no_film_behind) {
  // From 15 to 45 degrees its line recedes by a third. Where the first layer had no curvature 16 % of the particles stayed
  // behind, more than a spacing outside of the drop's base, and its volume was 0.83.
  Scene s = cap_of(10e-9, 8, 15, 45);
  s.until(5);
  const DropMeasure m = measure_sessile_drop(s.liquid, Plane{}, 0);
  std::size_t outside = 0;
  for (const Float4& x : s.liquid.particles.position)
    outside += std::hypot(x.x - m.centre.x, x.y - m.centre.y) > m.base_radius + s.liquid.spacing();
  std::printf("  %.1f by the profile, %.1f by the slope; volume %.3f, outside %zu of %zu\n", degrees(m.fit_angle),
              degrees(m.slope_angle), m.volume / 10e-9, outside, s.liquid.particles.size());
  EXPECT_NEAR(degrees(m.fit_angle), 45, 5);
  EXPECT_NEAR(m.volume / 10e-9, 1, 0.03);
  EXPECT_LT(outside, s.liquid.particles.size() / 200);
}

TEST(Drop, that_recedes_is_held_by_hysteresis) {
  // Thick, so that the line creeps; from 40 degrees, receding 60, advancing 90. A drop of 50 uL from a lattice with jitter
  // stops at 59, at 65 if a moving line is not held; in regular layers it breaks up and stops late (`imbibe verify hysteresis`).
  const Cap flat(radians(40));
  Scene s = standing_drop(8, flat.radius, flat.height - flat.radius, 90);
  s.walls[0].material.receding_angle = radians(60);
  s.liquid.kind.viscosity = 0.2;
  s.until(6);
  const DropMeasure m = measure_sessile_drop(s.liquid, Plane{}, 0);
  std::printf("  %.1f by the profile, %.1f by the slope\n", degrees(m.fit_angle), degrees(m.slope_angle));
  EXPECT_NEAR(degrees(m.fit_angle), 60, 5);
}

TEST(Drop, exchanges_momentum_with_the_wall_only) {
  Scene s = standing_drop(6, std::cbrt(2.0), 0, 70);
  s.gravity = {3, 0, -9.81};
  const auto momentum = [&] {
    Vec3 sum{};
    for (const Float4& u : s.liquid.particles.velocity) sum += Vec3{u.x, u.y, u.z} * s.liquid.particle_mass;
    return sum;
  };
  Vec3 given{};
  Real turned_over = 0;
  const Vec3 before = momentum();
  for (int k = 0; k < 60; ++k) {
    const LiquidStepReport r = s.step();
    given += r.wall_impulse[0];
    turned_over += norm(r.wall_pressure_impulse[0]);
  }
  const Vec3 missing = momentum() - before + given - s.gravity * (s.liquid.mass() * s.time);
  EXPECT_LT(norm(missing), 1e-9 * turned_over);  // 60 steps, each to 1e-10 (momentum.h)
}

TEST(Drop, that_falls_at_30_cm_per_second_comes_to_rest_near_its_contact_angle) {
  // 50 uL of real water with gravity. The centre of a drop of 110 degrees integrated after Bashforth and Adams lies at
  // 0.493 R0, at 102 deg 0.460, at 118 deg 0.526.
  Scene s = standing_drop(8, 1, 1.2, 110);
  s.gravity = {0, 0, -9.81};
  for (Float4& u : s.liquid.particles.velocity) u.z = -0.3f;
  Real peak = 0;
  while (s.time < 6 * s.unit) peak = std::max(peak, s.step().peak_density_error);
  Real mean = 0, samples = 0;  // over one oscillation
  while (s.time < 8 * s.unit) s.step(), mean += moments(s).centre.z, samples += 1;
  std::printf("  centre at %.3f R0, peak density error %.3f\n", mean / samples, peak);
  EXPECT_GT(mean / samples, 0.460);
  EXPECT_LT(mean / samples, 0.526);
}

}  // namespace
}  // namespace imbibe
