#include "imbibe/liquid/wall_push.h"

#include <gtest/gtest.h>

#include <cmath>

#include "imbibe/liquid/density.h"

namespace imbibe {
namespace {

constexpr Real dx = 1e-4;

// Samples of two walls at right angles seen from (x, y), and what a uniform pressure does there along x, over 1/H: the
// sum over pairs as an integral over the continuum between the walls.
Real acceleration_in_corner(Real x, Real y, bool corner) {
  const Kernel kernel = kernel_for(dx);
  const Real h = static_cast<Real>(kernel.support);
  const auto open = [&](Real d) { return 1 - half_space_integral(d, h).lambda; };
  Shape left = Plane{{0, 0, 0}, {1, 0, 0}}, right = Plane{{0, 0, 0}, {0, 1, 0}};
  const std::vector<Wall> walls{{&left, {}, {}, false}, {&right, {}, {}, false}};
  std::vector<Float4> position(padded_size(1), Float4{1e9f, 1e9f, 1e9f, 0});
  position[0] = {static_cast<float>(x), static_cast<float>(y), 0, 0};
  Boundary boundary;
  sample_walls(boundary, position, 1, walls, kernel);
  const std::vector<float> contact(3, corner ? 1.0f : 0.0f);
  set_pushes(boundary.samples(0), contact, kernel.support);
  Real push = 0;
  for (const WallSample& s : boundary.samples(0)) push += static_cast<Real>(s.push.x);
  const Real own = 1 / (open(x) * open(y));
  constexpr int cells = 40;
  const Real step = h / cells;
  Real sum = 0;
  for (int i = -cells; i < cells; ++i)
    for (int j = -cells; j < cells; ++j)
      for (int k = 0; k < cells; ++k) {
        const Vec3 to{(i + 0.5) * step, (j + 0.5) * step, (k + 0.5) * step};
        if (x + to.x < 0 || y + to.y < 0) continue;
        const Real weight = own + 1 / (open(x + to.x) * open(y + to.y));
        sum += 2 * step * step * step * weight * static_cast<Real>(kernel.slope(static_cast<float>(norm(to)))) * -to.x;
      }
  return (sum + 2 * own * push) * h;
}

TEST(WallPush, uniform_pressure_does_not_accelerate_liquid_in_a_corner) {
  // At a flat wall the terms that cancel are 2 to 5 (in 1/H). What is left: lambda is no exact product, and the sum's steps.
  for (const Real x : {0.3, 0.5, 1.0, 1.5})
    for (const Real y : {0.3, 0.6, 1.2, 3.0})
      EXPECT_NEAR(acceleration_in_corner(x * dx, y * dx, true), 0, 0.07) << x << " " << y;
  // The flat wall's push in a corner misses by more, and this case sees it.
  EXPECT_GT(std::abs(acceleration_in_corner(0.3 * dx, 0.3 * dx, false)), 0.12);
}

}  // namespace
}  // namespace imbibe
