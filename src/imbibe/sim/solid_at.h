// Where nothing may be born: inside solids and fixed textiles.
#pragma once

#include "imbibe/sim/world.h"

namespace imbibe {

// Whether a particle at `place` (m) would be in a solid, or in another textile than number `textile` (no_index: in any).
bool solid_at(const World& world, std::size_t textile, const Vec3& place);

}  // namespace imbibe
