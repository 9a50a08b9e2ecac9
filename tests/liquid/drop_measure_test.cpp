// A drop cut out of a lattice to a known shape must be measured as that shape.
#include "imbibe/liquid/drop_measure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "imbibe/core/random.h"

namespace imbibe {
namespace {

// A jittered body-centred lattice inside the shape, on the plane z = 0. resolution: spacings per radius of the sphere of the
// same volume.
Liquid drop_of_shape(const SessileShape& shape, int resolution) {
  Liquid liquid;
  const Real dx = std::cbrt(3 * shape.volume / (4 * pi)) / resolution, edge = std::cbrt(2.0) * dx;
  liquid.particle_mass = liquid.kind.density * dx * dx * dx;
  const auto radius_at = [&](Real z) {
    const Real depth = shape.height - z;
    for (std::size_t k = 1; k < shape.profile.size(); ++k) {
      const ProfilePoint &a = shape.profile[k - 1], &b = shape.profile[k];
      if (depth <= b.depth) return a.radius + (b.radius - a.radius) * (depth - a.depth) / (b.depth - a.depth);
    }
    return Real{0};
  };
  const int reach = 3 * resolution;
  std::uint64_t id = 0;
  for (int k = 0; k < 2 * reach; ++k)
    for (int i = -reach; i < reach; ++i)
      for (int j = -reach; j < reach; ++j) {
        const Real half = k % 2 == 0 ? 0.25 : 0.75;
        const auto jitter = [&](std::uint64_t s) { return 0.1 * dx * (2 * uniform({3, id, 0}, s) - 1); };
        const Vec3 x{(i + half) * edge + 0.3 * dx, (j + half) * edge, (0.5 * k + 0.25) * edge};
        ++id;
        if (x.z < shape.height && std::hypot(x.x, x.y) < radius_at(x.z))
          add_particle(liquid, x + Vec3{jitter(0), jitter(1), jitter(2)}, {});
      }
  return liquid;
}

TEST(DropMeasure, gives_the_angle_base_and_height_of_a_shape_that_is_known) {
  constexpr Real volume = 10e-9;
  for (const Real gravity : {0.0, 9.81})
    for (const Real angle : {30, 60, 90, 120, 150}) {
      const SessileShape shape = sessile_shape(volume, radians(angle), 998.2 * gravity / 0.0728);
      const DropMeasure m = measure_sessile_drop(drop_of_shape(shape, 8), Plane{}, gravity);
      std::printf("  g %.2f, %3.0f deg: fit %6.2f slope %6.2f centre %6.2f; base %.3f height %.3f volume %.3f, rms %.3f dx\n",
                  gravity, angle, degrees(m.fit_angle), degrees(m.slope_angle), degrees(m.centre_angle),
                  m.base_radius / shape.base_radius, m.height / shape.height, m.volume / volume,
                  m.fit_deviation / std::cbrt(4 * pi * volume / 3) * 8);
      EXPECT_NEAR(degrees(m.fit_angle), angle, 2);  // a cut lattice is ragged by dx/4: 1 degree and less
      EXPECT_NEAR(degrees(m.slope_angle), angle, 3);
      EXPECT_NEAR(degrees(m.centre_angle), angle, 2);
      EXPECT_NEAR(m.base_radius / shape.base_radius, 1, 0.03);
      EXPECT_NEAR(m.height / shape.height, 1, 0.02);
      EXPECT_NEAR(m.volume / volume, 1, 0.03);
    }
}

// A jittered body-centred lattice of the liquid, `spacing` apart, where inside(x).
template <class Inside>
Liquid lattice_where(Real spacing, Real reach, Inside&& inside) {
  Liquid liquid;
  liquid.particle_mass = liquid.kind.density * spacing * spacing * spacing;
  const Real edge = std::cbrt(2.0) * spacing;
  const int cells = static_cast<int>(std::ceil(reach / edge));
  std::uint64_t id = 0;
  for (int k = -cells; k < cells; ++k)
    for (int j = -cells; j < cells; ++j)
      for (int i = -cells; i < cells; ++i)
        for (const Real half : {0.25, 0.75}) {
          const Vec3 x = Vec3{i + half, j + half, k + half} * edge;
          const auto jitter = [&](std::uint64_t s) { return 0.1 * spacing * (2 * uniform({3, id, 0}, s) - 1); };
          ++id;
          if (inside(x)) add_particle(liquid, x + Vec3{jitter(0), jitter(1), jitter(2)}, {});
        }
  return liquid;
}

TEST(DropMeasure, gives_the_angle_on_a_ball_and_on_a_cone) {
  const Real b = 4e-3, slope = radians(20), spacing = 0.16e-3;
  const Shape ball = Sphere{{0, 0, -b}, b}, cone = Cone{{0, 0, -6e-3 * std::tan(slope)}, {0, 0, 1}, 6e-3, 6e-3 * std::tan(slope)};
  for (const Real angle : {60.0, 90.0, 120.0}) {
    // The free surface is a sphere about (0, 0, z) that meets the solid at the distance a from the axis.
    const Real a = angle < 100 ? 1.8e-3 : 1.1e-3;
    for (const Shape& solid : {ball, cone}) {
      const bool round = std::holds_alternative<Sphere>(solid);
      const Real fall = round ? std::asin(a / b) : slope, level = round ? std::sqrt(b * b - a * a) - b : -a * std::tan(slope);
      const Real phi = radians(angle) + fall, radius = a / std::sin(phi), z = level - radius * std::cos(phi);
      const Liquid liquid = lattice_where(spacing, 5e-3, [&](const Vec3& x) {
        return x.z > -2e-3 && norm(x - Vec3{0, 0, z}) < radius && nearest_surface(solid, x).distance > 0;
      });
      const DropMeasure m = measure_drop_on(liquid, solid, Plane{}, 0);
      std::printf("  %3.0f deg on a %s: %6.2f; base %.3f height %.3f volume %.3f\n", angle, round ? "ball" : "cone", degrees(m.fit_angle),
                  m.base_radius / a, m.height / (z + radius), m.volume / (liquid.mass() / liquid.kind.density));
      EXPECT_NEAR(degrees(m.fit_angle), angle, 2);
      EXPECT_NEAR(degrees(m.base_slope), angle + degrees(fall), 2);
      EXPECT_NEAR(m.base_radius / a, 1, 0.03);
      EXPECT_NEAR(m.height / (z + radius), 1, 0.03);
      EXPECT_NEAR(m.volume / (liquid.mass() / liquid.kind.density), 1, 0.03);
    }
  }
}

TEST(DropMeasure, does_not_mind_spray_around_the_drop_or_where_the_plane_lies) {
  const SessileShape shape = sessile_shape(10e-9, radians(70), 0);
  Liquid liquid = drop_of_shape(shape, 8);
  const Real before = measure_sessile_drop(liquid, Plane{}, 0).fit_angle;
  // The same drop under a ceiling at x = 1 cm, with spray.
  for (Float4& p : liquid.particles.position) p = {0.01f - p.z, p.y, p.x, 0};
  add_particle(liquid, {0.004, 0, 0}, {});
  const DropMeasure m = measure_sessile_drop(liquid, Plane{{0.01, 0, 0}, {-1, 0, 0}}, 0);
  EXPECT_NEAR(degrees(m.fit_angle), degrees(before), 0.5);
  EXPECT_NEAR(m.centre.x, 0.01 - shape.centre_height, 0.02 * shape.height);
}

TEST(DropMeasure, refuses_liquid_that_is_no_drop) {
  Liquid liquid;
  liquid.particle_mass = 1e-9;
  add_particle(liquid, {0, 0, 1}, {});
  EXPECT_ANY_THROW(measure_sessile_drop(liquid, Plane{}, 0));
}

}  // namespace
}  // namespace imbibe
