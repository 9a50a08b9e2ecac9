// Whether what a scene puts into the world fits there: no drop inside cloth, solid, another drop or outside the
// domain, none smaller than a particle. Tested in tests/scene/builder_test.cpp.
#pragma once

#include <string>
#include <vector>

#include "imbibe/scene/scene.h"
#include "imbibe/sim/world.h"

namespace imbibe {

Bounds bounds_of_sheet(const Textile& textile);

// Distance of a point to the slab of a textile, m; < 0 inside.
Real distance_to_sheet(const Textile& textile, const Vec3& point);

// The key of a world's source `i`, e.g. liquid.drops[1].
std::string key_of_source(const Scene& scene, std::size_t i);

// `running`, when given: the world that this one goes on from, whose soft sheets lie where they lie now.
void check_placements(const Scene& scene, const World& world, const World* running, std::vector<Problem>& problems);

}  // namespace imbibe
