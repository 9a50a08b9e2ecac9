#include "imbibe/liquid/kernel.h"

#include "imbibe/core/portable.h"

namespace imbibe {

namespace {

// The integrals of kernel.h for distance d >= 0, as polynomials in u = 1 - d/H.
struct PlaneIntegrals {
  Real lambda;  // 1
  Real slope;   // A = -dlambda/dd, 1/m
  Real moment;  // M, m
};

PlaneIntegrals plane_integrals(Real d, Real h) {
  const Real u = std::max(0.0, 1 - d / h), q = 1 - u;
  const Real u2 = u * u, u4 = u2 * u2, u5 = u4 * u, u6 = u5 * u;
  // i1, i3: integrals of t (1-t)^4 (4t+1) and t^3 (1-t)^4 (4t+1) over t in [q, 1].
  const Real i1 = u5 * (1 - 1.5 * u + 4.0 / 7 * u2);
  const Real i3 = u5 * (1 - 19.0 / 6 * u + 27.0 / 7 * u2 - 17.0 / 8 * u2 * u + 4.0 / 9 * u4);
  return {21 * u6 * (1.0 / 6 - 3.0 / 14 * u + u2 / 14), 21 / h * i1, 21 * h * (i3 - q * q * i1)};
}

}  // namespace

Real lattice_excess(Real support_in_spacings) {
  const Real edge = portable::cbrt(2.0), h = support_in_spacings;  // two particles a cell of volume 2
  const int reach = static_cast<int>(std::ceil(h / edge)) + 1;
  Real sum = 0;
  for (int z = -2 * reach; z <= 2 * reach; ++z) {
    for (int y = -2 * reach; y <= 2 * reach; ++y) {
      for (int x = -2 * reach; x <= 2 * reach; ++x) {
        if ((x - y) % 2 != 0 || (x - z) % 2 != 0) continue;
        const Real q = 0.5 * edge * std::sqrt(static_cast<Real>(x * x + y * y + z * z)) / h;
        const Real t = std::max(0.0, 1 - q);
        sum += t * t * t * t * (4 * q + 1);
      }
    }
  }
  return 21 / (2 * pi * h * h * h) * sum - 1;
}

Real lattice_stress(Real support_in_spacings) {
  const Real edge = portable::cbrt(2.0), h = support_in_spacings;
  const Kernel kernel(h);
  const int reach = 2 * (static_cast<int>(std::ceil(h / edge)) + 1);
  Real sum = 0;
  for (int z = -reach; z <= reach; ++z)
    for (int y = -reach; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x) {
        if ((x - y) % 2 != 0 || (x - z) % 2 != 0) continue;
        const Real square = 0.25 * edge * edge * static_cast<Real>(x * x + y * y + z * z);
        sum -= static_cast<Real>(kernel.slope(static_cast<float>(std::sqrt(square)))) * square / 3;
      }
  return sum;
}

SolidIntegral half_space_integral(Real distance, Real support) {
  const PlaneIntegrals p = plane_integrals(std::abs(distance), support);
  return {distance >= 0 ? p.lambda : 1 - p.lambda, -p.slope};
}

Real half_space_shear(Real distance, Real support) {
  const Real q = distance / support;
  if (q >= 1) return 0;
  // Antiderivatives of (1-t)^3 times t^3, t and 1/t.
  const auto cubic = [](Real t) { return t * t * t * t * (1.0 / 4 - 3.0 / 5 * t + t * t / 2 - t * t * t / 7); };
  const auto linear = [](Real t) { return t * t * (1.0 / 2 - t + 3.0 / 4 * t * t - t * t * t / 5); };
  const auto inverse = [](Real t) { return portable::log(t) - 3 * t + 1.5 * t * t - t * t * t / 3; };
  const Real q2 = q * q;
  const Real integral =
      cubic(1) - cubic(q) - 2 * q2 * (linear(1) - linear(q)) + q2 * q2 * (inverse(1) - inverse(q));
  return 10 / distance * 52.5 / support * std::max(0.0, integral);
}

Real pressure_gradient_ratio(Real distance, Real support) {
  constexpr Real least = -12;  // reached at d = 0.8 H
  constexpr int steps = 200;   // midpoints: 1e-4 of the integral
  const PlaneIntegrals here = plane_integrals(std::max(0.0, distance / support), 1);
  if (here.slope <= 0) return least;
  Real near = 0;
  for (int k = 0; k < steps; ++k) {
    const Real y = (k + 0.5) / steps;
    const PlaneIntegrals there = plane_integrals(y, 1);
    const Real across = plane_integrals(std::abs(std::max(0.0, distance / support) - y), 1).slope;
    near += there.slope * across / ((1 - there.lambda) * (1 - there.lambda)) / steps;
  }
  return std::max(least, 0.5 * (1 + (1 - here.lambda) * (2 * here.slope - near) / here.slope));
}

SolidIntegral solid_integral(Real distance, Real curvature, Real support) {
  const PlaneIntegrals p = plane_integrals(std::abs(distance), support);
  const SolidIntegral plane{distance >= 0 ? p.lambda : 1 - p.lambda, -p.slope};
  if (curvature <= 0) return plane;
  // Written with c = 2/R so that a plane is the limit c = 0: M/(2(R+d)) = M c/(2(2 + c d)).
  const Real reach = 2 + curvature * distance;
  if (reach <= 0.1) return plane;  // at the centre of the ball: all solid
  const Real lambda = plane.lambda - p.moment * curvature / (2 * reach);
  if (lambda <= 0) return {};  // a ball too small for the formula (2R + d < H) and nearly out of reach
  return {lambda, -p.slope * 2 / reach + p.moment * curvature * curvature / (2 * reach * reach)};
}

}  // namespace imbibe
