#include "imbibe/coupling/wet_wall.h"

#include <cmath>

namespace imbibe {

Shape sheet_shape(const YarnNetwork& network, const Placement& placement) {
  return Box{placement.origin, {network.size_x, network.size_y, network.thickness}, {placement.u, placement.v, placement.n}};
}

std::function<WallAngles(const Vec3&)> wet_angles(const ClothPlace& place, const FaceMap& map,
                                                  std::span<const float> saturation) {
  return [place, &map, saturation](const Vec3& world) {
    const Vec3 p = place.to_sheet(world);
    Real advancing = 0, receding = 0, weight = 0;
    if (std::isfinite(p.z)) {
      map.near(p.x, p.y, p.z >= 0, [&](const FaceMap::Node& n) {
        const Real x = p.x - n.x, y = p.y - n.y, d2 = x * x + y * y;
        if (d2 >= map.reach * map.reach) return;  // two of three: the bins reach farther than the kernel
        const Index k = n.index;
        const Real w = face_kernel(std::sqrt(d2), map.reach);
        advancing += w * cos_wet_face(map.cos_advancing[k], saturation[k]);
        receding += w * cos_wet_face(map.cos_receding[k], saturation[k]);
        weight += w;
      });
    }
    if (weight <= 0) return WallAngles{map.cos_advancing.front(), map.cos_receding.front()};
    return WallAngles{static_cast<float>(advancing / weight), static_cast<float>(receding / weight)};
  };
}

Wall wet_wall(const Shape& shape, const Placement& placement, const FaceMap& map,
              std::span<const float> saturation) {
  Wall wall;
  wall.shape = &shape;
  wall.two_sided = true;
  wall.angles_at = wet_angles(placement, map, saturation);
  return wall;
}

}  // namespace imbibe
