// The frame that shows a World as it is now.
#pragma once

#include <string>

#include "imbibe/sim/world.h"
#include "imbibe/view/frame.h"

namespace imbibe {

Frame frame_from_world(const World& world, const std::string& title);

}  // namespace imbibe
