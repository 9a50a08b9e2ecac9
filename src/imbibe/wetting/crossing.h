// Liquid passing from a warp yarn to the weft yarn it touches, through the contact patch.
//
//   T = eta_c K_t A_c/(eta d),  A_c = 0.5 pi r^2,  d = 4r/3
//   same material:       q = T (Psi_a - Psi_b)
//   different materials: q = T_a (Psi_a(p_a) - Psi_a(p*)) = T_b (Psi_b(p*) - Psi_b(p_b)),  T_x the half links, 2 T each
//
// Pressure is continuous across the patch, saturation is not; p* is the pressure in the patch. eta_c = 3 makes the
// crossing about as easy as one pitch along the yarn (what seed A's eta = 1 means); 0 cuts it. A yarn that does not wet
// has no half link, so nothing crosses to it.
// Source: seed A section 5.3 (eta D); geometry of the patch is an estimate (0.5 of the yarn's section).
// Tested in tests/wetting/models_test.cpp.
#pragma once

#include <algorithm>

#include "imbibe/core/types.h"
#include "imbibe/wetting/along_yarn.h"

namespace imbibe {

constexpr Real contact_patch(Real radius) { return 0.5 * pi * radius * radius; }
constexpr Real contact_distance(Real radius) { return 4 * radius / 3; }

struct CrossingFlow {
  Real flow = 0;                     // a to b
  Real slope_a = 0, slope_b = 0;     // d flow/d p_a >= 0, d flow/d p_b <= 0
  Real interface_pressure = 0;       // p*
};

// psi_a, psi_b: p -> Sloped, non-decreasing. Newton kept inside the bracket [p_a, p_b].
template <class PotentialA, class PotentialB>
CrossingFlow crossing_flow(PotentialA&& psi_a, PotentialB&& psi_b, Real half_a, Real half_b, Real p_a, Real p_b) {
  CrossingFlow result;
  if (half_a <= 0 || half_b <= 0) return result;
  const Sloped at_a = psi_a(p_a), at_b = psi_b(p_b);
  const Real wanted = half_a * at_a.value + half_b * at_b.value;
  Real low = std::min(p_a, p_b), high = std::max(p_a, p_b), p = high;
  Sloped in_a = psi_a(p), in_b = psi_b(p);
  const Real tolerance = 1e-14 * (half_a * in_a.value + half_b * in_b.value);
  for (int i = 0; i < 80; ++i) {
    const Real excess = half_a * in_a.value + half_b * in_b.value - wanted;
    if (std::abs(excess) <= tolerance) break;
    (excess > 0 ? high : low) = p;
    const Real slope = half_a * in_a.slope + half_b * in_b.slope;
    Real next = slope > 0 ? p - excess / slope : low;
    // Suctions span decades: where Newton leaves the bracket, halve it in the logarithm.
    if (!(next > low && next < high)) {
      next = low < 0 && high < 0 ? -std::sqrt(low * high) : 0.5 * (low + high);
    }
    if (next == p || high - low <= 1e-15 * (std::abs(low) + std::abs(high))) break;
    p = next;
    in_a = psi_a(p), in_b = psi_b(p);
  }
  const Real total = half_a * in_a.slope + half_b * in_b.slope;
  result.flow = half_a * (at_a.value - in_a.value);
  result.interface_pressure = p;
  if (total > 0) {
    result.slope_a = half_a * at_a.slope * half_b * in_b.slope / total;
    result.slope_b = -half_b * at_b.slope * half_a * in_a.slope / total;
  }
  return result;
}

}  // namespace imbibe
