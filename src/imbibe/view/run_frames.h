// The frames of a finished (or still growing) run, from the files in its folder: cloth and solids from scene.yaml,
// liquid and saturation of every output time from the .vtp files.
// Tested in tests/view/run_frames_test.cpp.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "imbibe/io/vtk.h"
#include "imbibe/sim/world.h"
#include "imbibe/view/frame.h"

namespace imbibe {

struct RunFrames {
  std::filesystem::path folder;
  Frame start;                        // everything that does not change; of the world before the run
  std::vector<Real> times;            // s, of the outputs
  static constexpr std::size_t no_cloth = std::size_t(-1);
  struct Collection {
    std::string textile{};            // "" = liquid
    std::size_t first_point = 0, points = 0;  // of the textile in start.yarns
    std::vector<PvdEntry> entries{};
    std::size_t cloth = no_cloth;     // in start.cloths
  };
  std::vector<Collection> collections;
};

// `world`: built from the folder's scene.yaml. InputError when the folder has no output at all.
RunFrames open_run_frames(const std::filesystem::path& folder, const World& world, const std::string& title);

Frame read_frame(const RunFrames& run, std::size_t number);

}  // namespace imbibe
