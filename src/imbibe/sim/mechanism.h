// Why the textiles of a world took liquid up, or did not: sentences for the report, made from the state and the model.
// Nothing here decides anything. Tested in tests/physics/fig07_test.cpp.
#pragma once

#include <string>
#include <vector>

#include "imbibe/sim/world.h"

namespace imbibe {

// One or two sentences per textile: how much each store holds, what drives or stops entry at the yarns' angle.
std::vector<std::string> explain_uptake(const World& world);

}  // namespace imbibe
