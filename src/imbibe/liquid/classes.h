// Where a particle lies: inside, at the liquid-vapour surface or at the liquid-solid one (seed A, section 6), from the
// gradient of the colour field in which wetted walls count as liquid (surface_tension.h).
//
//   liquid_vapour: |n| H > 0.3 and C + beta lambda < 0.92: neighbours are missing on one side
//   liquid_solid:  else, and nearer than dx to a wall: the first layer on a wetted wall
//   inside:        else
// The first layer under a flat surface has |n| H = 1.1, the second 0.1 (H = 2.5 dx).
// Tested in tests/liquid/classes_test.cpp.
#pragma once

#include "imbibe/liquid/particles.h"

namespace imbibe {

inline constexpr float surface_gradient_h = 0.3f;
inline constexpr float surface_filling = 0.92f;

// wall_spacings: distance to the nearest wall in spacings; large without one.
inline ParticleClass particle_class(float gradient_h, float wet_filling, float wall_spacings) {
  if (gradient_h > surface_gradient_h && wet_filling < surface_filling) return ParticleClass::liquid_vapour;
  return wall_spacings < 1 ? ParticleClass::liquid_solid : ParticleClass::inside;
}

}  // namespace imbibe
