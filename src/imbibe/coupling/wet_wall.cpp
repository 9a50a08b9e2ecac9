#include "imbibe/coupling/wet_wall.h"

namespace imbibe {

Shape sheet_shape(const YarnNetwork& network, const Placement& placement) {
  const auto along = [](const Vec3& a, Real length) {
    return Vec3{std::abs(a.x) * length, std::abs(a.y) * length, std::abs(a.z) * length};
  };
  return Box{placement.origin, along(placement.u, network.size_x) + along(placement.v, network.size_y) +
                                   along(placement.n, network.thickness)};
}

Wall wet_wall(const Shape& shape, const YarnNetwork& network, const Placement& placement, const FaceMap& map,
              std::span<const float> saturation) {
  Wall wall;
  wall.shape = &shape;
  wall.two_sided = true;
  // Means over the yarns; the place-dependent angle below replaces the advancing one.
  Real advancing = 0, receding = 0;
  for (const YarnType& type : network.yarn_types) {
    advancing += type.fibre.advancing_angle;
    receding += type.fibre.receding_angle;
  }
  const auto types = static_cast<Real>(network.yarn_types.size());
  wall.material.contact_angle = advancing / types;
  wall.material.receding_angle = receding / types;
  wall.cos_contact_angle_at = [&network, &placement, &map, saturation](const Vec3& world) {
    const Vec3 p = placement.to_sheet(world);
    Real cosine = 0, weight = 0;
    map.near(p.x, p.y, [&](Index k) {
      const Vec3& c = network.node_centre(k);
      const Real w = face_kernel(std::hypot(p.x - c.x, p.y - c.y), map.reach);
      cosine += w * cos_wet_face(map.cos_advancing[k], saturation[k]);
      weight += w;
    });
    return static_cast<float>(weight > 0 ? cosine / weight : map.cos_advancing.front());
  };
  return wall;
}

}  // namespace imbibe
