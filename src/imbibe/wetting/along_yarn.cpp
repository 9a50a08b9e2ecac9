#include "imbibe/wetting/along_yarn.h"

#include <algorithm>
#include <cmath>

#include "imbibe/core/portable.h"

namespace imbibe {
namespace {
const Real ln_1000 = portable::log(Real(1000));

// x^power; by squaring where the power is a small whole number, as 3 lambda + 1 is for whole lambda (this is called
// for every link between yarn and pore in every Newton iteration).
Real raised_to(Real x, Real power) {
  const int whole = power <= 64 ? static_cast<int>(power) : 0;
  if (static_cast<Real>(whole) != power) return portable::pow(x, power);
  Real result = 1;
  for (int bits = whole; bits > 0; bits >>= 1, x *= x) {
    if (bits & 1) result *= x;
  }
  return result;
}

// x^(-1/index); a root where two is the index, as it is of pores.
Real inverse_root(Real x, Real index) { return index == 2 ? 1 / std::sqrt(x) : portable::pow(x, -1 / index); }

}  // namespace

Real axial_permeability(Real fibre_radius, Real packing, Real tortuosity_squared) {
  const Real voids = 1 - packing;
  return 8 * fibre_radius * fibre_radius / 53 * voids * voids * voids / (packing * packing) / tortuosity_squared;
}

Real transverse_permeability(Real fibre_radius, Real packing, Real tortuosity_squared) {
  const Real gap = std::max<Real>(0, std::sqrt(0.9069 / packing) - 1);
  return 0.231 * fibre_radius * fibre_radius * gap * gap * std::sqrt(gap) / tortuosity_squared;
}

Real mean_suction(Real surface_tension, Real cos_angle, Real fibre_radius, Real packing) {
  return surface_tension * cos_angle * 2 * packing / (fibre_radius * (1 - packing));
}

Real entry_suction(Real mean, Real size_index) { return mean * portable::pow(0.5, 1 / size_index); }

Sloped pressure_at(const Retention& r, Real saturation) {
  if (saturation >= 1) {
    const Real slope = (r.entry + r.open) / r.overfill;
    return {-r.entry + slope * (saturation - 1), slope};
  }
  if (saturation <= driest) return {-r.entry * inverse_root(plain_saturation(r, driest), r.size_index), 0};
  const Real suction = r.entry * inverse_root(plain_saturation(r, saturation), r.size_index);
  const Real in_corners = r.corner_share / (r.corner_share + (1 - r.corner_share) * saturation);
  return {-suction, suction / (r.size_index * saturation) * in_corners};
}

Real saturation_at(const Retention& r, Real pressure) {
  if (pressure >= -r.entry) return 1 + (pressure + r.entry) * r.overfill / (r.entry + r.open);
  const Real plain = portable::pow(-pressure / r.entry, -r.size_index);
  return r.corner_share * plain / (1 - (1 - r.corner_share) * plain);
}

Real relative_permeability(Real saturation, Real size_index) {
  if (saturation >= 1) return 1;
  return saturation <= 0 ? 0 : portable::pow(saturation, 3 + 2 / size_index);
}

Sloped kirchhoff_potential(Real entry, Real size_index, Real pressure) {
  const Real power = 3 * size_index + 1;
  if (pressure >= -entry) return {entry / power + (pressure + entry), 1};
  const Real ratio = entry / -pressure;
  const Real raised = raised_to(ratio, power);
  return {entry * raised / power, raised * ratio};
}

Sloped kunzel_potential(Real saturation) {
  if (saturation >= 1) return {(1 - 1e-3) / ln_1000 + (saturation - 1), 1};
  const Real diffusivity = portable::exp((saturation - 1) * ln_1000);
  return {(diffusivity - 1e-3) / ln_1000, diffusivity};
}

Sloped printed_potential(Real saturation) {
  const Real diffusivity = portable::exp(-saturation * ln_1000);
  return {(1 - diffusivity) / ln_1000, diffusivity};
}

Real kunzel_diffusivity(Real absorption_coefficient, Real free_saturation) {
  const Real speed = absorption_coefficient / free_saturation;
  return 3.8 * speed * speed;
}

Real printed_diffusivity(Real absorption_coefficient, Real density, Real saturated_share) {
  return 3.8 * absorption_coefficient / (density * saturated_share);
}

Real sorptivity_squared(Real permeability, Real entry, Real viscosity, Real void_share, Real size_index) {
  const Real m = 2 + 1 / size_index;
  return permeability * entry / (viscosity * void_share) * (2 + (1 / (m + 1) + 1 / (m + 2)) / size_index);
}

}  // namespace imbibe
