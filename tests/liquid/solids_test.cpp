// Drops on solids other than a plane, on the real step: a ball, a two-sided sheet, a cone, a closed mesh.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "imbibe/core/random.h"
#include "imbibe/geometry/mesh_distance.h"
#include "imbibe/liquid/liquid_step.h"

namespace imbibe {
namespace {

constexpr Vec3 earth{0, 0, -9.81};

struct Scene {
  Liquid liquid;
  std::vector<Shape> shapes;
  std::vector<Wall> walls;
  LiquidScratch scratch;
  Vec3 gravity{};
  Real time = 0;

  explicit Scene(Real spacing) { liquid.particle_mass = liquid.kind.density * std::pow(spacing, 3); }

  // Points of a slightly disordered body-centred lattice of the liquid's spacing within `reach` for which inside(x).
  template <class Inside>
  void fill(Real reach, Inside inside, const Vec3& velocity = {}) {
    const Real edge = std::cbrt(2.0) * liquid.spacing();
    const int cells = static_cast<int>(std::ceil(reach / edge));
    for (int k = -cells; k < cells; ++k)
      for (int j = -cells; j < cells; ++j)
        for (int i = -cells; i < cells; ++i)
          for (Real half : {0.25, 0.75}) {
            const std::uint64_t id = liquid.next_id;
            const auto shake = [&](std::uint64_t s) { return 0.04 * liquid.spacing() * (uniform({5, id, 0}, s) - 0.5); };
            const Vec3 x = Vec3{i + half, j + half, k + half} * edge + Vec3{shake(0), shake(1), shake(2)};
            if (inside(x)) add_particle(liquid, x, velocity);
          }
  }
  void stand_on(std::vector<Shape> solids, Real angle_deg, bool two_sided = false) {
    shapes = std::move(solids);
    for (const Shape& s : shapes) walls.push_back({&s, {.contact_angle = radians(angle_deg)}, {}, two_sided});
  }
  LiquidStepReport step() {
    LiquidStepReport r = step_liquid(liquid, {}, walls, gravity, 1, scratch);
    time += r.step_s;
    return r;
  }
  Vec3 at(std::size_t i) const {
    const Float4& p = liquid.particles.position[i];
    return {p.x, p.y, p.z};
  }
  template <class Which>
  Vec3 centre(Which which) const {
    Vec3 sum{};
    Real count = 0;
    for (std::size_t i = 0; i < liquid.particles.size(); ++i) {
      if (which(at(i))) sum += at(i), count += 1;
    }
    return sum / count;
  }
  Vec3 centre() const {
    return centre([](const Vec3&) { return true; });
  }
  // The deepest any particle lies inside a solid; negative: all are outside.
  Real deepest() const {
    Real most = -1;
    for (std::size_t i = 0; i < liquid.particles.size(); ++i) {
      for (const Shape& s : shapes) most = std::max(most, -nearest_surface(s, at(i)).distance);
    }
    return most;
  }
};

constexpr Real drop_volume = 50e-9, spacing = 2.85e-4;  // 8 spacings per radius of the drop
const Real drop_radius = std::cbrt(3 * drop_volume / (4 * pi));
const Real unit = std::sqrt(998.2 * std::pow(drop_radius, 3) / 0.0728);  // s, capillary time of the drop

// A drop of the given angle on a ball of radius a: a ball of radius R whose centre lies D from the solid's,
// D^2 = a^2 + R^2 - 2 a R cos(theta), less the solid. By slices along the axis.
struct DropOnBall {
  Real radius = 0, centre_distance = 0;  // R, D
  Real volume = 0, centre_of_mass = 0;   // from the solid's centre

  DropOnBall(Real a, Real theta, Real r) : radius(r) {
    centre_distance = std::sqrt(a * a + r * r - 2 * a * r * std::cos(theta));
    constexpr int slices = 2000;
    for (int k = 0; k < slices; ++k) {
      const Real z = centre_distance - r + (k + 0.5) * 2 * r / slices;
      const Real own = r * r - (z - centre_distance) * (z - centre_distance);
      const Real solid = std::max(0.0, a * a - z * z);
      const Real share = pi * std::max(0.0, own - solid) * 2 * r / slices;
      volume += share, centre_of_mass += share * z;
    }
    centre_of_mass /= volume;
  }
};

DropOnBall drop_on_ball(Real a, Real theta, Real volume) {
  Real low = 0.2 * drop_radius, high = 5 * drop_radius;
  for (int i = 0; i < 50; ++i) {
    const Real middle = 0.5 * (low + high);
    (DropOnBall(a, theta, middle).volume < volume ? low : high) = middle;
  }
  return DropOnBall(a, theta, low);
}

TEST(Solids, a_drop_on_a_ball_rests_with_its_contact_angle) {
  constexpr Real a = 4e-3;
  for (const Real angle : {60.0, 90.0}) {
    Scene s(spacing);
    s.stand_on({Sphere{{0, 0, 0}, a}}, angle);
    const DropOnBall start = drop_on_ball(a, radians(100), drop_volume);
    s.fill(10e-3, [&](const Vec3& x) {
      return norm(x) > a && norm(x - Vec3{0, 0, start.centre_distance}) < start.radius;
    });
    const Real volume = s.liquid.mass() / s.liquid.kind.density;
    while (s.time < 4 * unit) s.step();
    Real mean = 0;  // over half an oscillation
    int samples = 0;
    while (s.time < 5 * unit) s.step(), mean += norm(s.centre()), ++samples;
    mean /= samples;
    Real low = 20, high = 160;
    for (int i = 0; i < 20; ++i) {
      const Real middle = 0.5 * (low + high);
      (drop_on_ball(a, radians(middle), volume).centre_of_mass < mean ? low : high) = middle;
    }
    std::printf("  %.0f degrees on a ball: %.1f\n", angle, low);
    EXPECT_NEAR(low, angle, 8);  // the goal on a plane
    EXPECT_LT(s.deepest(), 0);
  }
}

TEST(Solids, drops_on_both_sides_of_a_sheet_rest_with_their_angle_and_do_not_feel_each_other) {
  constexpr Real half = 0.1e-3;  // of the sheet's thickness: far less than the support
  const auto make = [&](bool both) {
    Scene s(spacing);
    s.stand_on({Box{{0, 0, 0}, {30e-3, 30e-3, 2 * half}}}, 90, true);
    const Real radius = std::cbrt(2.0) * drop_radius;
    s.fill(6e-3, [&](const Vec3& x) { return x.z > half && norm(x - Vec3{0, 0, half}) < radius; });
    if (both) s.fill(6e-3, [&](const Vec3& x) { return x.z < -half && norm(x + Vec3{0, 0, half}) < radius; });
    return s;
  };
  const auto above = [](const Vec3& x) { return x.z > 0; };
  Scene both = make(true), alone = make(false);
  while (both.time < 0.4 * unit) both.step();
  while (alone.time < 0.4 * unit) alone.step();
  // Only the solver's tolerance and the order of sums are common to both drops.
  std::printf("  the lower drop moves the upper one by %.5f spacings\n", norm(both.centre(above) - alone.centre()) / spacing);
  EXPECT_LT(norm(both.centre(above) - alone.centre()), 0.02 * spacing);
  while (both.time < 3.5 * unit) both.step();
  // Half balls: centre of mass 3/8 of the radius above the sheet, 10 % more or less for 8 degrees.
  const Real wanted = 3.0 / 8 * std::cbrt(2.0) * drop_radius;
  const Real up = both.centre(above).z - half;
  const Real down = -both.centre([](const Vec3& x) { return x.z < 0; }).z - half;
  std::printf("  centres at %.3f and %.3f of a half ball's\n", up / wanted, down / wanted);
  EXPECT_NEAR(up / wanted, 1, 0.1);
  EXPECT_NEAR(down / wanted, 1, 0.1);
}

TEST(Solids, a_cone_sheds_a_drop_that_hits_its_side) {
  Scene s(1.3 * spacing);
  s.stand_on({Cone{{0, 0, 0}, {0, 0, 1}, 6e-3, 8e-3}}, 120);
  s.gravity = earth;
  const Vec3 start{1.5e-3, 0, 9.5e-3};
  s.fill(16e-3, [&](const Vec3& x) { return norm(x - start) < drop_radius; }, {0, 0, -0.3});
  ASSERT_LT(s.deepest(), 0);
  std::size_t put_back = 0;
  while (s.time < 0.08) {
    put_back += s.step().put_back;
    ASSERT_LT(s.deepest(), 0) << s.time;
  }
  std::size_t left = 0;
  for (std::size_t i = 0; i < s.liquid.particles.size(); ++i) {
    left += nearest_surface(s.shapes[0], s.at(i)).distance < 2 * s.liquid.spacing();
  }
  std::printf("  centre %.1f mm below the base, %zu of %zu particles still on the cone, %zu put back\n",
              -1e3 * s.centre().z, left, s.liquid.particles.size(), put_back);
  EXPECT_LT(s.centre().z, 0);  // fell past it
  EXPECT_GT(s.centre().x, 3e-3);
}

// A cube of the given edge around the origin, two triangles a face.
Shape cube(Real edge) {
  TriangleMesh mesh;
  for (int k = 0; k < 8; ++k) {
    mesh.vertices.push_back(Vec3{k & 1 ? 0.5 : -0.5, k & 2 ? 0.5 : -0.5, k & 4 ? 0.5 : -0.5} * edge);
  }
  const Index faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& f : faces) {
    mesh.triangles.push_back({f[0], f[1], f[2]});
    mesh.triangles.push_back({f[0], f[2], f[3]});
  }
  return std::make_shared<const MeshDistance>(mesh);
}

TEST(Solids, a_closed_mesh_holds_liquid_out_like_the_box_of_the_same_shape) {
  Vec3 centres[2];
  int k = 0;
  for (const Shape& solid : {Shape(Box{{0, 0, 0}, {8e-3, 8e-3, 8e-3}}), cube(8e-3)}) {
    Scene s(1.3 * spacing);
    s.stand_on({solid}, 90);
    s.gravity = earth;
    const Vec3 start{0, 0, 4.1e-3 + drop_radius};
    s.fill(10e-3, [&](const Vec3& x) { return norm(x - start) < drop_radius; }, {0, 0, -0.3});
    while (s.time < 0.04) {
      s.step();
      ASSERT_LT(s.deepest(), 0) << s.time;
    }
    centres[k++] = s.centre();
  }
  std::printf("  centre over the box %.3f mm, over the mesh %.3f mm\n", 1e3 * centres[0].z - 4, 1e3 * centres[1].z - 4);
  // On a face both are the same half-space; rounding grows in the swinging drop, hence half a spacing.
  EXPECT_LT(norm(centres[0] - centres[1]), 0.5 * spacing);
}

}  // namespace
}  // namespace imbibe
