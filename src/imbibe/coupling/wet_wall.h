// A sheet as the free liquid feels it: a slab of the fabric's thickness whose contact angle follows the contents.
//
// Yarns and pores are smaller than a particle, so the liquid sees an effective angle per place (Cassie-Baxter on the
// sheet's face, Trans. Faraday Soc. 40, 1944): dry cloth shows the yarns' own advancing angle; over wet cloth the
// liquid-filled share 1 - f of the face meets liquid, so
//   cos(theta*) = f cos(theta) + (1 - f),   f = 0.5 the solid share of a woven face,
// in between in proportion to the saturation. A face of yarns above 90 degrees stays dry and keeps its angle.
// The same law with the receding angle holds a drop's base: it does not recede before that angle is reached, which is
// smaller on wet cloth.
// Tested in tests/coupling/wet_wall_test.cpp.
#pragma once

#include <functional>
#include <span>

#include "imbibe/coupling/embedding.h"
#include "imbibe/coupling/face_map.h"
#include "imbibe/fabric/network.h"
#include "imbibe/liquid/wall.h"

namespace imbibe {

inline constexpr Real solid_share_of_face = 0.5;  // of a woven face, Cassie-Baxter f

// cos(theta*) of a face with yarns of cos_theta at saturation s.
constexpr Real cos_wet_face(Real cos_theta, Real saturation) {
  const Real s = saturation < 0 ? 0 : saturation > 1 ? 1 : saturation;
  const Real filled = solid_share_of_face * cos_theta + (1 - solid_share_of_face);
  return cos_theta + s * (filled - cos_theta);
}

// The slab of the sheet in the world, at any orientation.
Shape sheet_shape(const YarnNetwork& network, const Placement& placement);

// The angles of a cloth's faces by place in the world, for one step; everything must outlive it.
std::function<WallAngles(const Vec3&)> wet_angles(const ClothPlace& place, const FaceMap& map,
                                                  std::span<const float> saturation);

// A wall for one step; `shape`, `saturation` (per node) and the rest must outlive it.
Wall wet_wall(const Shape& shape, const Placement& placement, const FaceMap& map,
              std::span<const float> saturation);

}  // namespace imbibe
