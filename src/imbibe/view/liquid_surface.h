// A smooth closed surface around liquid particles.
//
//   x'_i = (1 - a) x_i + a sum_j w_ij x_j / sum_j w_ij           smoothed centres (Yu & Turk 2013, eq. 6 as an idea)
//   V_i  = 1 / sum_j W(x'_i - x'_j)                               volume of a particle by its neighbours
//   phi(x) = sum_i V_i W(x - x'_i),   surface: phi = iso
// W(r) = W(0) (1 - r^2/s^2)^3 with support s. V_i instead of the mean volume lets a lone particle keep its own ball. The surface is
// meshed by naive surface nets (Gibson 1998) on a grid that exists only near particles, then relaxed by Taubin's
// volume-keeping smoothing (1995). iso is set so that a filled sphere encloses the particles' volume (see the test).
// Valid for particle clouds of roughly even spacing; a film thinner than one particle shows one particle thick.
// Tested in tests/view/liquid_surface_test.cpp: volume of a ball, closedness, lone particles, two drops.
#pragma once

#include <span>

#include "imbibe/view/frame.h"

namespace imbibe {

struct LiquidSurfaceParams {
  Real support = 2.3;           // s / spacing
  Real centre_smoothing = 0.6;  // a
  Real cell = 0.5;              // grid cell / spacing
  Real iso = 0.5;
  int relaxations = 20;         // pairs of Taubin steps
  int normal_rounds = 16;       // averagings of the normals
};

DrawnMesh liquid_surface(std::span<const Vec3f> particles, Real spacing, const LiquidSurfaceParams& params = {});

// Signed volume enclosed by a closed mesh, m3.
Real enclosed_volume(const DrawnMesh& mesh);

}  // namespace imbibe
