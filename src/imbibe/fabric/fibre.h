// A textile fibre as a material: what it weighs, how it takes up water, how water stands on it.
// Data: fibres/*.yaml, a source and a confidence per value (Morton & Hearle, Physical Properties of Textile Fibres,
// for density, regain and swelling).
#pragma once

#include <string>

#include "imbibe/core/types.h"

namespace imbibe {

// Equilibrium regain at relative humidity phi, Guggenheim-Anderson-de Boer:
//   W = m0 C K phi / [(1 - K phi)(1 - K phi + C K phi)]          (kg water / kg dry fibre)
struct GabIsotherm {
  Real m0 = 0, c = 1, k = 0.7;  // m0 <= 0: none known; then W = linear_slope * phi
  Real linear_slope = 0;
};

struct Fibre {
  std::string name;
  Real density = 1500;            // kg/m3, dry
  Real regain_65 = 0;             // kg/kg at 65 % relative humidity, 20 degC
  Real regain_saturated = 0;      // kg/kg at 100 % vapour
  Real liquid_retention = 0;      // kg/kg, centrifuge value; a check only: counts water between fibres
  Real volume_swelling = 0;       // relative volume growth when saturated
  Real area_swelling = 0;         // relative cross-section growth when saturated
  Real radius = 7e-6;             // m, R_f of the real sorbing fibre
  Real advancing_angle = 0;       // rad, theta_a
  Real receding_angle = 0;        // rad, theta_r
  Real diffusivity = 0;           // m2/s, water in the fibre substance, D_f
  GabIsotherm isotherm;           // adsorption
  Real desorption_offset_65 = 0;  // kg/kg, how far desorption lies above adsorption at 65 %
  Real wet_softening = 0;         // 1, share of its stiffness lost at regain_saturated
  Real absorption_coefficient = 0;  // kg/(m2 s^0.5), typical in-plane A_w of a fabric of it (Kuenzel); 0 = none

  // Sorbed water at full swelling: max(regain at 100 % vapour, volume_swelling * rho_water / density).
  // Not the centrifuge retention, which counts water between fibres twice.
  Real swelling_regain(Real water_density = 998.2) const {
    const Real from_volume = volume_swelling * water_density / density;
    return from_volume > regain_saturated ? from_volume : regain_saturated;
  }
};

}  // namespace imbibe
