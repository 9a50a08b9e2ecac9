#include "imbibe/liquid/boundary.h"

#include <gtest/gtest.h>

#include "imbibe/core/random.h"
#include "imbibe/liquid/neighbours.h"

namespace imbibe {
namespace {

constexpr Real spacing = 1e-3;
const Kernel kernel = kernel_for(spacing);

std::vector<Float4> padded(const std::vector<Vec3>& points) {
  std::vector<Float4> p;
  for (const Vec3& x : points) p.push_back({static_cast<float>(x.x), static_cast<float>(x.y), static_cast<float>(x.z), 0});
  pad_positions(p, points.size());
  return p;
}

Boundary sampled(const std::vector<Vec3>& points, std::span<const Wall> walls) {
  Boundary b;
  sample_walls(b, padded(points), points.size(), walls, kernel);
  return b;
}

// Integral of W over the solid by midpoints of a fine grid.
Real lambda_by_grid(const Shape& shape, const Vec3& x) {
  const int n = 60;
  const Real h = static_cast<Real>(kernel.support), cell = 2 * h / n;
  Real sum = 0;
  for (int k = 0; k < n * n * n; ++k) {
    const Vec3 from{-h + cell * (k % n + 0.5), -h + cell * (k / n % n + 0.5), -h + cell * (k / n / n + 0.5)};
    if (norm(from) >= h) continue;
    const Real part = std::clamp(0.5 - nearest_surface(shape, x + from).distance / cell, 0.0, 1.0);  // of cut cells
    sum += part * static_cast<Real>(kernel.value(static_cast<float>(norm(from)))) * cell * cell * cell;
  }
  return sum;
}

struct Case {
  const char* name;
  Shape shape;
  Vec3 at;
  Real tolerance;
};

TEST(Boundary, lambda_is_the_integral_of_the_kernel_over_the_solid) {
  const Real mm = 1e-3;
  const Case cases[] = {
      {"plane", Plane{}, {0, 0, 0.7 * mm}, 2e-3},
      {"tilted plane", Plane{{0, 0, 0}, normalized(Vec3{1, 2, 3})}, {0.3 * mm, 0, 0.4 * mm}, 2e-3},
      {"ball", Sphere{{0, 0, 0}, 4 * mm}, {2 * mm, 1 * mm, 4 * mm}, 2e-3},
      {"box face", Box{{0, 0, 0}, {20 * mm, 20 * mm, 20 * mm}}, {1 * mm, 0, 10.8 * mm}, 2e-3},
      // Product of slabs: exact on the edge, within some per cent beside it.
      {"box edge", Box{{0, 0, 0}, {20 * mm, 20 * mm, 20 * mm}}, {10 * mm, 0, 10 * mm}, 4e-3},
      {"near box edge", Box{{0, 0, 0}, {20 * mm, 20 * mm, 20 * mm}}, {9.3 * mm, 0, 10.5 * mm}, 0.03},
      // Curvature to first order.
      {"cylinder", Cylinder{{0, 0, -20 * mm}, {0, 0, 1}, 5 * mm, 40 * mm}, {5.6 * mm, 0, 0}, 5e-3},
      {"cone", Cone{{0, 0, 0}, {0, 0, 1}, 10 * mm, 20 * mm}, {5.8 * mm, 0, 10 * mm}, 6e-3},
  };
  for (const Case& c : cases) {
    const Wall wall{&c.shape, {}, {}, false};
    const Boundary b = sampled({c.at}, {&wall, 1});
    EXPECT_NEAR(b.wall[0].w, lambda_by_grid(c.shape, c.at), c.tolerance) << c.name;
    EXPECT_GT(b.wall[0].w, 0.01f) << c.name;
  }
}

TEST(Boundary, the_gradient_is_the_finite_difference_of_lambda) {
  const Real mm = 1e-3, step = 2e-6;
  const Case cases[] = {
      {"plane", Plane{}, {0, 0, 0.7 * mm}, 0},
      {"inside the plane", Plane{}, {0, 0, -0.3 * mm}, 0},
      {"ball", Sphere{{0, 0, 0}, 4 * mm}, {2 * mm, 1 * mm, 4 * mm}, 0},
      {"box edge", Box{{0, 0, 0}, {20 * mm, 20 * mm, 20 * mm}}, {9.3 * mm, 2 * mm, 10.5 * mm}, 0},
      {"cylinder", Cylinder{{0, 0, -20 * mm}, {0, 0, 1}, 5 * mm, 40 * mm}, {4 * mm, 4 * mm, 0}, 0},
  };
  for (const Case& c : cases) {
    const Wall wall{&c.shape, {}, {}, false};
    const auto lambda = [&](const Vec3& x) { return static_cast<Real>(sampled({x}, {&wall, 1}).wall[0].w); };
    const Float4 g = sampled({c.at}, {&wall, 1}).wall[0];
    // Rounding of single-precision lambda over the step: 1e-7/4e-6, of gradients near 400/m.
    EXPECT_NEAR(g.x, (lambda(c.at + Vec3{step, 0, 0}) - lambda(c.at - Vec3{step, 0, 0})) / (2 * step), 0.3) << c.name;
    EXPECT_NEAR(g.y, (lambda(c.at + Vec3{0, step, 0}) - lambda(c.at - Vec3{0, step, 0})) / (2 * step), 0.3) << c.name;
    EXPECT_NEAR(g.z, (lambda(c.at + Vec3{0, 0, step}) - lambda(c.at - Vec3{0, 0, step})) / (2 * step), 0.3) << c.name;
  }
}

TEST(Boundary, a_turned_box_and_a_turned_sheet_are_the_straight_ones_turned) {
  const Vec3 u = normalized(Vec3{2, 1, -1}), v = normalized(cross(Vec3{0.3, 0, 1}, u)), n = cross(u, v);
  const auto turned = [&](const Vec3& p) { return p.x * u + p.y * v + p.z * n; };
  const Vec3 places[] = {{9.3e-3, 2e-3, 0.9e-3}, {1e-3, 0, -0.8e-3}, {10.4e-3, 10.2e-3, 0.7e-3}};
  for (const bool two_sided : {false, true})
    for (const Vec3& p : places) {
      const Shape straight = Box{{0, 0, 0}, {20e-3, 20e-3, 1e-3}};
      const Shape box = Box{{0, 0, 0}, {20e-3, 20e-3, 1e-3}, {u, v, n}};
      const Wall before{&straight, {}, {}, two_sided}, after{&box, {}, {}, two_sided};
      const Float4 a = sampled({p}, {&before, 1}).wall[0], b = sampled({turned(p)}, {&after, 1}).wall[0];
      EXPECT_GT(a.w, 0);
      EXPECT_NEAR(b.w, a.w, 1e-5 * a.w);  // single precision of positions of 10 mm in distances of 1 mm
      EXPECT_NEAR(norm(Vec3{b.x, b.y, b.z} - turned({a.x, a.y, a.z})), 0, 1e-4 * norm(Vec3{a.x, a.y, a.z}));
    }
}

TEST(Boundary, several_walls_combine_and_their_gradients_add_up) {
  const Shape floor = Plane{}, side = Plane{{0, 0, 0}, {1, 0, 0}};
  const Wall walls[] = {{&floor, {}, {}, false}, {&side, {}, {}, false}};
  const Vec3 at{0.4e-3, 0, 0.6e-3};
  const Boundary b = sampled({at}, walls);
  const Real h = static_cast<Real>(kernel.support);
  const SolidIntegral f = half_space_integral(at.z, h), s = half_space_integral(at.x, h);
  EXPECT_NEAR(b.wall[0].w, 1 - (1 - f.lambda) * (1 - s.lambda), 1e-6);
  EXPECT_NEAR(b.wall[0].z, f.slope * (1 - s.lambda), 1e-3);
  EXPECT_NEAR(b.wall[0].x, s.slope * (1 - f.lambda), 1e-3);
  ASSERT_EQ(b.samples(0).size(), 2u);
  EXPECT_EQ(b.samples(0)[0].wall, 1u);  // the nearest first
  Vec3f sum{};
  for (const WallSample& w : b.samples(0)) sum += w.gradient;
  EXPECT_EQ(sum.x, b.wall[0].x);
  EXPECT_EQ(sum.z, b.wall[0].z);
  // Near the flat walls' own pushes: wall_push_test.cpp has what a corner changes.
  EXPECT_NEAR(b.push[0].z, pressure_gradient_ratio(at.z, h) * f.slope * (1 - s.lambda), 0.05 * std::abs(f.slope));
  EXPECT_NEAR(b.push[0].x, pressure_gradient_ratio(at.x, h) * s.slope * (1 - f.lambda), 0.05 * std::abs(s.slope));
}

TEST(Boundary, a_wall_has_its_own_contact_angle_or_one_by_place) {
  const Shape plane = Plane{};
  Wall wall{&plane, {.contact_angle = radians(60)}, {}, false};
  EXPECT_NEAR(angles_at(wall, {0, 0, 1e-3}).cos_advancing, 0.5, 1e-6);
  wall.angles_at = [](const Vec3& x) { return x.x > 0 ? WallAngles{0.25f, 0.5f} : WallAngles{-0.25f, -0.25f}; };
  EXPECT_EQ(angles_at(wall, {1, 0, 1e-3}).cos_advancing, 0.25f);
  EXPECT_EQ(angles_at(wall, {-1, 0, 1e-3}).cos_advancing, -0.25f);
}

TEST(Boundary, a_sheet_is_solid_ground_for_both_sides_and_separates_them) {
  const Shape sheet = Box{{0, 0, 0}, {60e-3, 60e-3, 0.4e-3}};
  const Wall wall{&sheet, {}, {}, true};
  const Boundary b = sampled({{0, 0, 0.7e-3}, {0, 0, -0.7e-3}, {30.5e-3, 0, 0.7e-3}}, {&wall, 1});
  const SolidIntegral half = half_space_integral(0.5e-3, static_cast<Real>(kernel.support));
  EXPECT_NEAR(b.wall[0].w, half.lambda, 1e-5);
  EXPECT_NEAR(b.wall[1].w, half.lambda, 1e-5);
  EXPECT_NEAR(b.wall[0].z, half.slope, 1e-2);
  EXPECT_NEAR(b.wall[1].z, -half.slope, 1e-2);
  EXPECT_TRUE(separated(b.side[0], b.side[1]));
  EXPECT_FALSE(separated(b.side[0], b.side[2]));  // beside the sheet both sides are seen
  EXPECT_FALSE(separated(b.side[1], b.side[2]));
  EXPECT_LT(b.wall[2].w, 0.5f * b.wall[0].w);     // and less than half of the solid
}

TEST(Boundary, no_particle_ends_inside_a_solid_and_its_momentum_is_booked) {
  const Shape ball = Sphere{{0, 0, 0}, 5e-3};
  const Wall wall{&ball, {}, {}, false};
  std::vector<Vec3> points;
  for (std::uint64_t k = 0; k < 2000; ++k) {
    const RandomCounter c{1, k, 0};
    const Vec3 direction = normalized(Vec3{uniform(c, 0) - 0.5, uniform(c, 1) - 0.5, uniform(c, 2) - 0.5});
    points.push_back((5e-3 + 0.3e-3 * uniform(c, 3)) * direction);
  }
  const Boundary b = sampled(points, {&wall, 1});
  const std::vector<Float4> before = padded(points);
  std::vector<Float4> after = before, velocity(before.size());
  Vec3 start{};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const RandomCounter c{2, i, 0};
    const Vec3 u = 0.8 * Vec3{uniform(c, 0) - 0.5, uniform(c, 1) - 0.5, uniform(c, 2) - 0.5};
    velocity[i] = {static_cast<float>(u.x), static_cast<float>(u.y), static_cast<float>(u.z), 0};
    start += Vec3{velocity[i].x, velocity[i].y, velocity[i].z};
    after[i].x += 1e-3f * velocity[i].x, after[i].y += 1e-3f * velocity[i].y, after[i].z += 1e-3f * velocity[i].z;
  }
  std::vector<Vec3> impulse(1);
  EXPECT_GT(keep_outside(b, before, after, velocity, points.size(), {&wall, 1}, spacing, 2.0, impulse), 300u);
  Vec3 end{};
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_GE(nearest_surface(ball, {after[i].x, after[i].y, after[i].z}).distance, 0);
    end += Vec3{velocity[i].x, velocity[i].y, velocity[i].z};
  }
  EXPECT_LT(norm(2.0 * (start - end) - impulse[0]), 2e-4);  // rounding of 2000 single-precision velocities
}

TEST(Boundary, nothing_passes_through_a_sheet_from_either_side) {
  const Shape sheet = Box{{0, 0, 0}, {60e-3, 60e-3, 0.1e-3}};  // thinner than the way of one step
  const Wall wall{&sheet, {}, {}, true};
  const std::vector<Vec3> points = {{0, 0, 0.2e-3}, {0, 0, -0.2e-3}, {5e-3, 0, 0.06e-3}};
  const Boundary b = sampled(points, {&wall, 1});
  const std::vector<Float4> before = padded(points);
  std::vector<Float4> after = before, velocity(before.size(), Float4{0, 0, 0, 0});
  after[0].z = -0.3e-3f, after[1].z = 0.3e-3f, after[2].z = 0.01e-3f;
  std::vector<Vec3> impulse(1);
  EXPECT_EQ(keep_outside(b, before, after, velocity, 3, {&wall, 1}, spacing, 1, impulse), 3u);
  EXPECT_GE(after[0].z, 0.05e-3f);
  EXPECT_LE(after[1].z, -0.05e-3f);
  EXPECT_GE(after[2].z, 0.05e-3f);
}

}  // namespace
}  // namespace imbibe
