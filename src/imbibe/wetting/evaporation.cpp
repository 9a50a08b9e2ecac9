#include "imbibe/wetting/evaporation.h"

#include <algorithm>

#include "imbibe/core/portable.h"
#include "imbibe/wetting/isotherm.h"

namespace imbibe {
namespace {
constexpr Real gas_constant_vapour = 461.5;  // J/(kg K)
constexpr Real air_pressure = 101325;        // Pa
constexpr Real psychrometer_constant = 6.62e-4;  // 1/K
}  // namespace

Real saturation_pressure(Real temperature) {
  const Real t = temperature - 273.15;
  return 610.94 * portable::exp(17.625 * t / (t + 243.04));
}

Real saturated_vapour_density(Real temperature) {
  return saturation_pressure(temperature) / (gas_constant_vapour * temperature);
}

Real wet_bulb_temperature(const Air& air) {
  const Real vapour = air.humidity * saturation_pressure(air.temperature);
  Real low = air.temperature - 60, high = air.temperature;
  for (int i = 0; i < 60; ++i) {
    const Real middle = 0.5 * (low + high);
    const Real excess = saturation_pressure(middle) - vapour -
                        psychrometer_constant * air_pressure * (air.temperature - middle);
    (excess < 0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

Real evaporation_rate(const Air& air, Real activity, Real surface_temperature) {
  return air.mass_transfer * (activity * saturated_vapour_density(surface_temperature) -
                              air.humidity * saturated_vapour_density(air.temperature));
}

FibreVapourResult fibre_vapour(const Fibre& fibre, const FibreVapour& step) {
  const Real adsorbed = equilibrium_regain(fibre, step.humidity);
  const bool drying = step.regain > adsorbed;
  const bool upper = drying && step.hysteresis;
  const auto branch = [&](Real phi) { return upper ? desorption_regain(fibre, phi) : equilibrium_regain(fibre, phi); };
  // Between the branches, or in equilibrium: nothing moves.
  if (upper && step.regain <= branch(step.humidity)) return {0, step.regain, false};
  const auto from_fibre = [&](Real phi) {
    return step.dry_mass * (step.regain - step.rest - step.gain * branch(phi));
  };
  const auto excess = [&](Real phi) { return from_fibre(phi) - step.conductance * (phi - step.humidity); };
  if (step.conductance <= 0) return {0, step.regain, false};
  Real low = drying ? step.humidity : 0, high = drying ? 1 : step.humidity;
  if (drying && excess(1) > 0) return {step.conductance * (1 - step.humidity), branch(1), true};
  // A falling function: regula falsi in the Illinois form, safe and quick.
  Real at_low = excess(low), at_high = excess(high);
  if (at_low <= 0) return {from_fibre(low), branch(low), false};
  if (at_high >= 0) return {from_fibre(high), branch(high), false};
  int side = 0;
  Real phi = high;
  for (int i = 0; i < 60 && high - low > 1e-13; ++i) {
    phi = (low * at_high - high * at_low) / (at_high - at_low);
    const Real value = excess(phi);
    if (value == 0) break;
    if (value > 0) {
      low = phi, at_low = value;
      if (side == 1) at_high *= 0.5;
      side = 1;
    } else {
      high = phi, at_high = value;
      if (side == -1) at_low *= 0.5;
      side = -1;
    }
    if (std::abs(value) <= 1e-14 * (std::abs(step.conductance) + step.dry_mass)) break;
  }
  return {from_fibre(phi), branch(phi), false};
}

}  // namespace imbibe
