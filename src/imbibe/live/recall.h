// What the nodes of a recorded frame held, from its files, put back into the world that the scene builds, so that a
// replay is asked as a running simulation is. In single precision, as the files are.
// Tested with the page, in viewer/test/live.test.mjs.
#pragma once

#include <vector>

#include "imbibe/sim/world.h"
#include "imbibe/view/run_frames.h"

namespace imbibe::live {

// `pores`: per textile. `places`: set to where the nodes of each textile were, m. What was not written at `time` stays.
void recall(World& world, const RunFrames& frames, const std::vector<RunFrames::Collection>& pores, Real time,
            std::vector<std::vector<Vec3>>& places);

}  // namespace imbibe::live
