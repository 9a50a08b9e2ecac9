// Whether a state that was read can be one of the world that the scene builds: sizes that fit, numbers that a run can
// come to. A step may count on it: its work is bounded by what the scene holds, not by what a file says.
// Tested in tests/sim/checkpoint_test.cpp.
#pragma once

#include <string>
#include <vector>

#include "imbibe/sim/world.h"

namespace imbibe {

// Every mismatch in words; empty: none. `read` is `built` with its state (state_fields.h) replaced. Limits, generous ones:
//   every number          finite, at most 1e15
//   air, gravity          what a scene may set
//   places, velocities    100 m from the origin, 10 km/s (the faster, the shorter are the steps)
//   owed, waiting masses  1000 kg (whole particles are made of them)
//   a node's liquid       10 times what it can hold; water in its fibres: 10 times their mass
std::vector<std::string> unsound_state(const World& read, const World& built);

}  // namespace imbibe
