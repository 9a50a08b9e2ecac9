// Wet fibres swell, the yarn with them, and the pores between yarns lose what the yarns gain.
//
//   r = r_0 sqrt[(1 + sigma_A W/W_swell)/(1 + sigma_A W_65/W_swell)],  phi_y constant
//
// sigma_A relative growth of cross-section at full swelling; W regain, W_swell full swelling, W_65 at 65 % relative
// humidity, where the yarn has the radius it was described with. Constant packing: voids between the fibres grow in
// proportion. The cell's volume is kept: each pore shrinks by its share of its yarns' growth (not below `least_pore`
// of its first volume), and what no longer fits leaves by pressure, not by a rule.
// Source: Morton & Hearle (area swelling per fibre); constant packing is an assumption.
// Tested in tests/wetting/models_test.cpp.
#pragma once

#include "imbibe/core/types.h"

namespace imbibe {

inline constexpr Real least_pore = 0.05;

// (r/r_0)^2.
constexpr Real swollen_area(Real area_swelling, Real regain, Real regain_65, Real swelling_regain) {
  if (swelling_regain <= 0) return 1;
  return (1 + area_swelling * regain / swelling_regain) / (1 + area_swelling * regain_65 / swelling_regain);
}

// Pore volume after its yarns took `growth` of it, both m3.
constexpr Real shrunk_pore(Real volume, Real growth) {
  const Real left = volume - growth;
  return left > least_pore * volume ? left : least_pore * volume;
}

}  // namespace imbibe
