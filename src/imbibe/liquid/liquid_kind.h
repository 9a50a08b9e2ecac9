// The description of a liquid's properties; the data files liquids/*.yaml give them with unit, source and confidence.
#pragma once

#include "imbibe/core/parameter.h"
#include "imbibe/liquid/particles.h"

namespace imbibe {

template <class V>
void describe(V& v, LiquidKind& k) {
  v.value("name", k.name, {.help = "name of the liquid"});
  v.value("density", k.density, {.unit = "kg/m3", .min = 100, .max = 20000, .help = "density"});
  v.value("viscosity", k.viscosity,
          {.unit = "Pa s", .shown = "mPa s", .min = 0, .max = 1000, .help = "dynamic viscosity"});
  v.value("surface_tension", k.surface_tension,
          {.unit = "N/m", .shown = "mN/m", .min = 0, .max = 1, .help = "surface tension against air"});
}

// Numbers that say how a liquid behaves at a length scale; printed by `check`.
Real capillary_length(const LiquidKind& kind, Real gravity);                 // sqrt(gamma/(rho g)), m
Real ohnesorge_number(const LiquidKind& kind, Real length);                  // eta/sqrt(rho gamma L)
Real bond_number(const LiquidKind& kind, Real length, Real gravity);         // rho g L^2/gamma

}  // namespace imbibe
