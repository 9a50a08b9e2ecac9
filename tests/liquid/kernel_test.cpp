#include "imbibe/liquid/kernel.h"

#include <gtest/gtest.h>

namespace imbibe {
namespace {

constexpr Real support = 1.7;

// Midpoint rule over spherical shells: W times the part of each shell that `inside` gives.
template <class Part>
Real shell_quadrature(Part&& part) {
  const Kernel kernel(support);
  const int n = 20000;
  Real sum = 0;
  for (int k = 0; k < n; ++k) {
    const Real r = support * (k + 0.5) / n;
    sum += static_cast<Real>(kernel.value(static_cast<float>(r))) * 4 * pi * r * r * part(r) * support / n;
  }
  return sum;
}

TEST(Kernel, integrates_to_one) {
  // Single precision of the kernel's value: 1e-6.
  EXPECT_NEAR(shell_quadrature([](Real) { return 1.0; }), 1, 2e-6);
}

TEST(Kernel, is_positive_inside_the_support_and_zero_outside) {
  const Kernel kernel(support);
  EXPECT_GT(kernel.value(0.99f * kernel.support), 0);
  EXPECT_EQ(kernel.value(1.0001f * kernel.support), 0);
  EXPECT_EQ(kernel.slope(1.0001f * kernel.support), 0);
}

TEST(Kernel, slope_is_the_derivative_over_the_distance) {
  const Kernel kernel(support);
  for (float r = 0.05f; r < 1.65f; r += 0.1f) {
    const float h = 0.01f;
    const float difference = (kernel.value(r + h) - kernel.value(r - h)) / (2 * h);
    // h^2 W'''/6 of the central difference plus rounding of W over h.
    EXPECT_NEAR(kernel.slope(r) * r, difference, 2e-3 * kernel.value(0)) << "r = " << r;
  }
}

TEST(Kernel, half_space_integral_agrees_with_quadrature) {
  for (const Real d : {-1.5, -0.8, -0.1, 0.0, 0.2, 0.9, 1.6, 1.8}) {
    const Real wanted = shell_quadrature([&](Real s) { return std::clamp(0.5 * (s - d) / s, 0.0, 1.0); });
    EXPECT_NEAR(half_space_integral(d, support).lambda, wanted, 3e-6) << "d = " << d;
  }
}

TEST(Kernel, ball_integral_agrees_with_quadrature_outside_and_inside) {
  for (const Real radius : {1.5, 4.0}) {
    for (const Real d : {-0.7, -0.2, 0.0, 0.1, 0.5, 1.2}) {
      const Real distance = radius + d;  // between the centres
      const Real wanted = shell_quadrature([&](Real s) {
        if (s <= -d) return 1.0;
        return std::clamp((radius * radius - (distance - s) * (distance - s)) / (4 * distance * s), 0.0, 1.0);
      });
      EXPECT_NEAR(solid_integral(d, 2 / radius, support).lambda, wanted, 3e-6) << "R = " << radius << ", d = " << d;
    }
  }
}

TEST(Kernel, solid_integral_slope_is_its_derivative) {
  for (const Real curvature : {0.0, 0.4, 1.1}) {
    for (const Real d : {-0.9, -0.3, 0.2, 0.8, 1.3}) {
      const Real h = 1e-5;
      const Real difference =
          (solid_integral(d + h, curvature, support).lambda - solid_integral(d - h, curvature, support).lambda) / (2 * h);
      // Central difference in double precision: h^2 and 1e-16/h.
      EXPECT_NEAR(solid_integral(d, curvature, support).slope, difference, 1e-8) << curvature << ", " << d;
    }
  }
}

TEST(Kernel, lattice_excess_makes_the_sum_over_regular_lattices_one) {
  // What the incompressible solver takes for the rest density must be what a relaxed arrangement has. The arrangements
  // differ among themselves: face-centred by 0.15 %, simple cubic (the least likely one) by 0.6 % at H = 2.5 dx.
  for (const Real ratio : {2.5, 3.0}) {
    Real cubic = 0, face_centred = 0;
    const Kernel kernel(ratio);
    const auto w = [&](Real x, Real y, Real z) {
      return static_cast<Real>(kernel.value(static_cast<float>(std::sqrt(x * x + y * y + z * z))));
    };
    const Real half = 0.5 * std::cbrt(4.0);
    for (int z = -6; z <= 6; ++z) {
      for (int y = -6; y <= 6; ++y) {
        for (int x = -6; x <= 6; ++x) {
          cubic += w(x, y, z);
          if ((x + y + z) % 2 == 0) face_centred += w(half * x, half * y, half * z);
        }
      }
    }
    EXPECT_NEAR(face_centred - lattice_excess(ratio), 1, 1.5e-3) << ratio;
    EXPECT_NEAR(cubic - lattice_excess(ratio), 1, 6e-3) << ratio;
  }
}

}  // namespace
}  // namespace imbibe
