// What the liquid feels of solids and of textile faces: a signed distance, a contact angle, friction.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "imbibe/core/types.h"
#include "imbibe/geometry/shapes.h"

namespace imbibe {

struct SheetWall;

struct WallMaterial {
  Real contact_angle = pi / 2;  // rad, equilibrium or advancing
  Real receding_angle = -1;     // rad; < 0: no hysteresis, same as contact_angle
  Real friction = 1;            // 0 = free slip, 1 = the liquid's own viscosity acts at the wall (no slip)
  Vec3 velocity{};              // m/s, of the surface along itself (a belt); its normal part has no effect
};

// Cosines of the angles at one place; cos_receding >= cos_advancing, equal without hysteresis.
struct WallAngles {
  float cos_advancing = 0, cos_receding = 0;
};

// One wall for the duration of a step: not part of any state. `angles_at`, when set, replaces the material's angles
// at a world point (a textile's face: angle by saturation).
struct Wall {
  const Shape* shape = nullptr;
  WallMaterial material;
  std::function<WallAngles(const Vec3&)> angles_at;
  // The wall is passable from both sides (a textile sheet): particles on different sides do not see each other.
  bool two_sided = false;
  // A soft sheet (sheet_wall.h), in place of `shape`: it moves, and takes what the liquid gives it. Two-sided.
  SheetWall* sheet = nullptr;
};

// The angles of a wall at a world point on it. Asked for where a contact line is (surface_tension.h), not of every particle near the
// wall: on wet cloth an answer costs a sum over the yarns around.
WallAngles angles_at(const Wall& wall, const Vec3& place);

}  // namespace imbibe
