#include "imbibe/wetting/isotherm.h"

#include <algorithm>

namespace imbibe {
namespace {

// The humidity at which a rising curve reaches `regain`, by bisection: 52 halvings are all a double can tell apart.
template <class Curve>
Real inverse_on_unit_interval(Curve&& curve, Real regain) {
  if (regain >= curve(1.0)) return 1;
  Real low = 0, high = 1;
  for (int i = 0; i < 52; ++i) {
    const Real middle = 0.5 * (low + high);
    (curve(middle) < regain ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

Real gab_regain(const GabIsotherm& isotherm, Real humidity) {
  const Real x = isotherm.k * humidity;
  return isotherm.m0 * isotherm.c * x / ((1 - x) * (1 - x + isotherm.c * x));
}

Real one_parameter_regain(Real regain_65, Real humidity) {
  return 0.55 * regain_65 * humidity * (1 / (0.25 + humidity) + 1 / (1.25 - humidity));
}

Real equilibrium_regain(const Fibre& fibre, Real humidity) {
  const Real phi = std::clamp<Real>(humidity, 0, 1);
  if (fibre.isotherm.m0 > 0) return gab_regain(fibre.isotherm, phi);
  if (fibre.isotherm.linear_slope > 0) return fibre.isotherm.linear_slope * phi;
  return one_parameter_regain(fibre.regain_65, phi);
}

Real desorption_regain(const Fibre& fibre, Real humidity) {
  const Real phi = std::clamp<Real>(humidity, 0, 1);
  return equilibrium_regain(fibre, phi) + fibre.desorption_offset_65 * phi * (1 - phi) / (0.65 * 0.35);
}

Real equilibrium_humidity(const Fibre& fibre, Real regain) {
  if (regain <= 0) return 0;
  if (regain >= equilibrium_regain(fibre, 1)) return 1;
  if (fibre.isotherm.m0 > 0) {
    // (C-1) W x^2 + (m0 C - (C-2) W) x - W = 0 with x = K phi; the positive root in the form that does not cancel.
    const auto& g = fibre.isotherm;
    const Real a = (g.c - 1) * regain, b = g.m0 * g.c - (g.c - 2) * regain;
    const Real root = std::sqrt(b * b + 4 * a * regain);
    const Real x = b > 0 ? 2 * regain / (b + root) : (root - b) / (2 * a);
    return std::min<Real>(1, x / g.k);
  }
  if (fibre.isotherm.linear_slope > 0) return std::min<Real>(1, regain / fibre.isotherm.linear_slope);
  return inverse_on_unit_interval([&](Real phi) { return one_parameter_regain(fibre.regain_65, phi); }, regain);
}

Real desorption_humidity(const Fibre& fibre, Real regain) {
  if (regain <= 0) return 0;
  if (fibre.desorption_offset_65 == 0) return equilibrium_humidity(fibre, regain);
  return inverse_on_unit_interval([&](Real phi) { return desorption_regain(fibre, phi); }, regain);
}

}  // namespace imbibe
