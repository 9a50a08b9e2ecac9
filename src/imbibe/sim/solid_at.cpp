#include "imbibe/sim/solid_at.h"

namespace imbibe {

bool solid_at(const World& world, std::size_t textile, const Vec3& place) {
  const Real room = 0.25 * world.liquid.spacing();
  for (const SolidBody& solid : world.solids)
    if (nearest_surface(solid.shape, place).distance < room) return true;
  for (std::size_t t = 0; t < world.textiles.size(); ++t) {
    if (t == textile || world.textiles[t].cloth) continue;
    const YarnNetwork& network = world.textiles[t].fabric->network;
    const Vec3 p = world.textiles[t].placement.to_sheet(place);
    if (std::abs(p.z) < 0.5 * network.thickness + room && std::abs(p.x) < 0.5 * network.size_x &&
        std::abs(p.y) < 0.5 * network.size_y)
      return true;
  }
  return false;
}

}  // namespace imbibe
