// Vapour between the cloth and the air at both faces.
//
//   m = A h_m (a_w rho_sat(T_s) - phi rho_sat(T_a))       kg/s
//   rho_sat(T) = e(T)/(R_v T),  e = 610.94 exp[17.625 t/(t + 243.04)] Pa, t in degC
//   wet bulb:  e(T_w) - phi e(T_a) = 6.62e-4 p_air (T_a - T_w)
//   fibre without free water: surface humidity a_w at which the flow out of the fibre equals the flow into the air,
//       m_f (W - r - g W_eq(a_w)) = dt A h_m rho_sat (a_w - phi),   a_w <= 1
//
// A both faces m2; h_m m/s; a_w water activity: 1 while there is free water, else that of the fibre's surface; phi
// relative humidity; W regain; after dt a surface held at W_s leaves the mean regain at r + g W_s (sorption.h), so inner
// diffusion and the boundary layer act in series and the step never overshoots; R_v = 461.5 J/(kg K).
// Source: Alduchov & Eskridge, J. Appl. Meteorol. 35 (1996) 601 (e); psychrometer constant of a ventilated wet bulb.
// Boundary layer (millimetres) much thicker than a yarn: wet spots feed it as one face. Isothermal or wet-bulb surface.
// Tested in tests/wetting/models_test.cpp: 6.037e-3 kg/m3; 2.25e-3 at the wet bulb of
// 15.84 degC (published 2.224e-3, 1.4 % less: vapour formula); 218 g/(m2 h).
#pragma once

#include "imbibe/core/types.h"
#include "imbibe/fabric/fibre.h"
#include "imbibe/wetting/contents.h"

namespace imbibe {

Real saturation_pressure(Real temperature);        // Pa
Real saturated_vapour_density(Real temperature);   // kg/m3
Real wet_bulb_temperature(const Air& air);         // K

// kg/(m2 s) from a face of activity a_w at surface temperature T_s.
Real evaporation_rate(const Air& air, Real activity, Real surface_temperature);

// What a fibre without free water gives to the air in a step (kg, < 0: takes up).
struct FibreVapour {
  Real dry_mass = 0;     // kg
  Real regain = 0;       // W before
  Real rest = 0;         // r: mean regain after the step with a surface at zero
  Real gain = 0;         // g: what a surface at regain 1 adds to it
  Real conductance = 0;  // dt A h_m rho_sat, kg per unit of a_w
  Real humidity = 0;     // phi in terms of rho_sat(T_s)
  bool hysteresis = false;
};
struct FibreVapourResult {
  Real given_kg = 0;
  Real surface_regain = 0;  // W_s that the surface stood at
  bool limited = false;     // a_w = 1 and the air could not take more
};
FibreVapourResult fibre_vapour(const Fibre& fibre, const FibreVapour& step);

}  // namespace imbibe
