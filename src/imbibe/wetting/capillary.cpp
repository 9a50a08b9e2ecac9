#include "imbibe/wetting/capillary.h"

#include <algorithm>

#include "imbibe/core/portable.h"

namespace imbibe {

Real pore_throat_radius(Real gap_x, Real gap_y) { return gap_x * gap_y / (gap_x + gap_y); }

Real pore_ring_share(Real radius_x, Real radius_y, Real throat, Real volume) {
  constexpr Real least = 1e-3;  // keeps p(s) growing where the throat is next to nothing
  return std::clamp<Real>(pi * std::sqrt(radius_x * radius_y) * throat * throat / volume, least, 1);
}

Real throat_suction(Real surface_tension, Real cos_angle, Real throat) {
  return 2 * surface_tension * cos_angle / throat;
}

Real jurin_height(Real surface_tension, Real cos_angle, Real radius, Real density, Real gravity) {
  return 2 * surface_tension * cos_angle / (density * gravity * radius);
}

Real lambert_w0(Real x) {
  constexpr Real e = std::numbers::e_v<Real>;
  // Series about the branch point -1/e, then Halley's iteration.
  const Real p = std::sqrt(std::max<Real>(0, 2 * (e * x + 1)));
  Real w = -1 + p - p * p / 3 + 11 * p * p * p / 72;
  if (p < 1e-5) return w;
  for (int i = 0; i < 50; ++i) {
    const Real exponential = portable::exp(w), f = w * exponential - x;
    const Real step = f / (exponential * (w + 1) - (w + 2) * f / (2 * w + 2));
    w -= step;
    if (std::abs(step) <= 1e-15 * (1 + std::abs(w))) break;
  }
  return w;
}

Real tube_rise(Real surface_tension, Real cos_angle, Real radius, Real density, Real viscosity, Real gravity,
               Real time) {
  const Real a = surface_tension * radius * cos_angle / (4 * viscosity);
  const Real b = density * gravity * radius * radius / (8 * viscosity);
  if (b == 0) return std::sqrt(2 * a * time);
  return a / b * (1 + lambert_w0(-portable::exp(-1 - b * b * time / a)));
}

Real tube_conductance(Real radius, Real viscosity, Real filled) {
  return pi * radius * radius * radius * radius / (8 * viscosity * filled);
}

Real lateral_conductance(Real transverse, Real radius, Real length, Real viscosity) {
  return transverse * 0.4 * pi * radius * length / (viscosity * radius);
}

Real yarn_pore_conductance(Real lateral, Real along, Real radius, Real gap) {
  if (lateral <= 0 || along <= 0) return 0;
  return 1 / (1 / lateral + 2 * radius / (gap * along));
}

Real slot_conductance(Real gap, Real height, Real viscosity, Real pitch) {
  return 2 * gap * height * height * height / (3 * viscosity * pitch);
}

Real printed_pore_diffusivity(Real molecular, Real radius, Real velocity) {
  return 0.5 * molecular + std::sqrt(0.25 * molecular * molecular + radius * velocity / 48);
}

}  // namespace imbibe
