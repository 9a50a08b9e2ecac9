// Worlds of one cloth of a wanted size, built the way a scene file builds them.
#pragma once

#include <cstdint>
#include <string>

#include "imbibe/sim/world.h"

namespace imbibe::bench {

// Of a scene file's text.
World world_of(const std::string& text);

// A square of shirting with about `nodes` segments and pores and no liquid; `extra` is appended to the scene's text.
World cloth_world(std::int64_t nodes, const std::string& liquid = "");

// Round stains, 20 mm apart, over half of the area, as they stand a while after the drop: saturation of the yarns falls
// outwards as Barenblatt's profile, (1 - r^2/R^2)^(1/(2 + 1/lambda)), pores hold what the yarns' suction leaves them.
void wet(Textile& textile);

}  // namespace imbibe::bench
