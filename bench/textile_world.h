// Worlds of one cloth of a wanted size, built the way a scene file builds them.
#pragma once

#include <cstdint>
#include <string>

#include "imbibe/sim/world.h"

namespace imbibe::bench {

// A square of shirting with about `nodes` segments and pores and no liquid; `extra` is appended to the scene's text.
World cloth_world(std::int64_t nodes, const std::string& liquid = "");

// Liquid in round stains over half the area: every state of filling between dry and full occurs.
void wet(Textile& textile);

}  // namespace imbibe::bench
