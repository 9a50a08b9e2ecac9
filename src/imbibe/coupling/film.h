// Liquid that is too thin for particles: how far the last of a drop covers wet cloth.
//
//   a = (3 V sin^3(theta)/(pi (2 - 3 cos(theta) + cos^3(theta))))^(1/3),   A_film = max(A_cover, min(A_reach, pi a^2))
//   f_k = c_k + beta (r_k - c_k),  beta = (A_film - A_cover)/(A_reach - A_cover)
//
// V m3 volume of a patch's touching particles; theta its receding angle on wet cloth (wet_wall.h); a, A_film base of the cap
// that V makes at that angle. c_k share of node k that particles cover, A_cover its sum over the patch; r_k = 1 for pores that
// are flush (p > -0.1 P_e) and joined to the covered ones by flush pores, and for segments all of whose pores are so, else
// c_k; A_reach the area of those and the covered ones.
// A drop that cloth drinks up has its line at the receding angle, so its base follows from its volume alone. Particles show
// that only while the drop is some layers high: a film of one layer closes up over every particle that dies, and covers V/dx,
// by which finer particles would drink the faster. The base cannot be where the drop never was; flush pores say where that
// is, for liquid on the face keeps those under it at its own pressure and yarns suck at all others. What the film gives
// beyond its particles is owed by all of them alike.
// Source: spherical cap; receding contact line. Assumes a patch small against the capillary length where it is a film (else
// it reaches less), no stored wetting history besides the pores' contents, no more than the cover where theta >= 90 degrees.
// Tested in tests/coupling/film_test.cpp; `imbibe verify uptake-resolution`.
#pragma once

#include "imbibe/coupling/footprint.h"
#include "imbibe/wetting/wetting_model.h"

namespace imbibe {

// m2, base of a spherical cap; infinite at angle 0.
Real cap_base_area(Real volume, Real cos_angle);

// Adds supplies to `footprint` for the nodes that the films of its patches reach, and raises shares and stocks of those that
// they cover in part.
void spread_films(const Liquid& liquid, const FaceMap& map, const WettingModel& model, const Contents& contents,
                  const ExchangeState& exchange, Footprint& footprint);

}  // namespace imbibe
