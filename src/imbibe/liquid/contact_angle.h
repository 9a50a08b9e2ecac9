// The contact line: wetness of walls, the actual angle, and the line force that drives it to the wanted one.
//
//   beta = clamp((s - lo)/(hi - lo), 0, 1),  s = 2 sum_j V W(|x_F - x_j|)     wetness of the wall under i; x_F its foot
//   cos th_a = -(n~.m (1 - d kappa~/2) + d~ kappa~/2)    actual angle: extrapolated to the wall, and from the surface
//                                                         through the centres to the liquid's (d, surface_tension.h)
//   F_i = -4 gamma |G_i| tau_i V (cos theta - cos th_a) e                     [N], tangential; reaction on the wall
//   m outward wall normal, d~ height over the wall [m], n~ kappa~ d~ kernel means over reliable surface particles near i,
//   tau_i = |n^f_tan|/(1 - lambda_i) [1/m], e = n^f_tan/|n^f_tan| (into the liquid along the wall)
// 4 |G| tau V adds up to the length of the line: 1/2 across the line, 1/2 normal to the wall.
// A dry wall is not liquid (beta = 0), else drops stick below overhangs.
// A film of one layer has no measurable interface in reach: its angle counts as 0, so it withdraws where theta > 0 (else
// a receding line leaves it behind).
// Hysteresis: no line force while the actual angle is between receding and advancing, where the wall holds just what pulls;
// but a line that moves feels the angle of its motion, receding or advancing. Against motion inward the wall holds up to
// gamma (cos theta_r - cos th_a) per length more, outward up to gamma (cos th_a - cos theta): dry friction, which can only
// stop (th_a counts as within the range). Without it a line ran on into the range. On solids only (surface_tension.cpp).
// Friction of the line: particles at the line feel drag line_friction sqrt(gamma dx/rho) |G|/d [1/s].
// Source: idea of the line force, Huber et al., J. Comput. Phys. 310 (2016) 459; Young 1805.
// Validity: plane or solid of radius >= 3 H; 30 to 120 deg. Tested in tests/liquid/drop_test.cpp.
#pragma once

#include <algorithm>
#include <cmath>

#include "imbibe/core/parameter.h"
#include "imbibe/core/types.h"

namespace imbibe {

struct ContactAngleParams {
  Real wet_from = 0.4, wet_to = 0.8;  // lo, hi
  Real line_friction = 0.6;
};

template <class V>
void describe(V& v, ContactAngleParams& p) {
  v.value("wet_from", p.wet_from, {.min = 0, .max = 1, .help = "filling of the wall's foot at which it begins to be wet"});
  v.value("wet_to", p.wet_to, {.min = 0, .max = 1, .help = "filling of the wall's foot at which it is wet"});
  v.value("line_friction", p.line_friction,
          {.min = 0, .max = 10, .help = "friction of the contact line, of sqrt(surface tension x spacing / density)"});
}

// Unbalanced cosine, wanted minus actual: 0 between the receding and the advancing angle.
// cos_receding >= cos_advancing; the same: no hysteresis.
inline float unbalanced_cosine(float cos_actual, float cos_advancing, float cos_receding) {
  if (cos_actual < cos_advancing) return cos_advancing - cos_actual;  // flatter than advancing is blunter: advances
  if (cos_actual > cos_receding) return cos_receding - cos_actual;    // sharper than receding: recedes
  return 0;
}

// Wetness from the doubled filling s of the wall's foot.
inline float wall_wetness(float doubled_filling, float from, float to) {
  return std::clamp((doubled_filling - from) / (to - from), 0.0f, 1.0f);
}

}  // namespace imbibe
