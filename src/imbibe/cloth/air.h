// Drag and wind on a sheet, node by node.
//
//   F = rho A / 2 [C_n |w_n| w_n + C_t |w_t| w_t],  w = wind - v = w_n (along the face's normal) + w_t (along the face)
//   impulse over dt: dt c w/(1 + dt c/m) with c = rho A C |w|/2 on each part: the node comes to the wind's speed, never past it
//
// rho density of the air kg/m3; A area of cloth that the node stands for m2; C_n, C_t coefficients; m nodal mass. Quadratic
// drag of a plate in a wide stream (C_n 1.1-1.3 square plates, Hoerner, Fluid-Dynamic Drag, 1965); no lift beyond that, no
// wake, no added mass. Tested in tests/cloth/air_test.cpp: terminal speed, momentum.
#pragma once

#include "imbibe/cloth/cloth_step.h"

namespace imbibe {

// N s on a node of mass 1/inverse_mass.
inline Vec3 air_impulse(const ClothAirParams& air, const Vec3& velocity, const Vec3& normal, Real area,
                        Real inverse_mass, Real dt) {
  const Vec3 w = air.wind - velocity;
  const Vec3 across = dot(w, normal) * normal, along = w - across;
  const auto part = [&](const Vec3& speed, Real coefficient) {
    const Real c = 0.5 * air.density * area * coefficient * norm(speed);
    return (dt * c / (1 + dt * c * inverse_mass)) * speed;
  };
  return part(across, air.normal_drag) + part(along, air.tangential_drag);
}

}  // namespace imbibe
