// Liquid passing from a layer of cloth to the one it lies on.
//
// Yarn to yarn, through the menisci between two crowns:
//   q = T (Psi_a - Psi_b),  T = K_t A/(eta d)          (crossing.h, its two half links, without its factor eta_c)
//   A = min( S max(h - g, 0), 0.5 pi r^2 ),  h = gamma (cos theta_a + cos theta_b) / -p
// h height of a gap that a meniscus at pressure p bridges, p the higher of the two (the wetter yarn's liquid makes the
// bridge), all of it for p >= 0; g least gap of the two crowns and S their contact area per height (fabric/layers.h); no
// wider than the patch of two yarns pressed together at a crossing. So a nearly dry layer passes little, layers that do
// not touch pass nothing until the liquid is loose enough to bridge them, and yarns of which one rejects the liquid
// pass nothing at all.
// Pore to pore, where the faces' openings overlap: a valve as in the plane (capillary.h), open above the higher P_open
// of the two; above the breakthrough of one that does not wet and is not yet filled. Conductance of both throats, each
// over half its layer, in series.
//
// gamma N/m; theta contact angles; p Pa; h, g m; S m; A m2.
// Source: parallel-plate menisci (Young and Laplace) between paraboloids; that transfer needs a well wetted layer is what
// transfer wicking shows (Zhuang, Harlock & Brook, Text. Res. J. 72 (2002) 727). Assumes rigid crowns that just touch;
// pressure on the layers would add area. The contact is taken at the pressure of the step's start.
// Tested in tests/wetting/layers_test.cpp.
#pragma once

#include <algorithm>

#include "imbibe/core/types.h"

namespace imbibe {

// m, the height that a meniscus at `pressure` bridges between faces of these cosines.
inline Real bridged_height(Real surface_tension, Real cosines, Real pressure) {
  const Real pull = surface_tension * cosines;
  if (pull <= 0) return 0;
  return pressure < 0 ? pull / -pressure : std::numeric_limits<Real>::infinity();
}

// m2, the wetted contact of two crowns.
inline Real bridged_area(Real height, Real gap, Real area_per_height, Real most) {
  return std::clamp<Real>(area_per_height * (height - gap), 0, most);
}

}  // namespace imbibe
