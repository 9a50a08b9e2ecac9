// Scenes for tests: the shipped ones, and a small drop on a small cloth that runs in about a second.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "imbibe/scene/builder.h"
#include "imbibe/scene/library.h"
#include "imbibe/scene/scene.h"
#include "imbibe/sim/run.h"

namespace imbibe::test {

inline std::filesystem::path scenes_folder() { return std::filesystem::path(IMBIBE_SOURCE_DIR) / "scenes"; }

// Paths relative to scenes/, sorted.
inline std::vector<std::string> shipped_scenes() {
  std::vector<std::string> scenes;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(scenes_folder()))
    if (entry.path().extension() == ".yaml")
      scenes.push_back(std::filesystem::relative(entry.path(), scenes_folder()).string());
  std::sort(scenes.begin(), scenes.end());
  return scenes;
}

inline World build(const Scene& scene, const std::filesystem::path& file) {
  return build_world(scene, read_library(library_folders(file, {})));
}

// 3 uL of water as some 190 particles, released just above 9 x 9 mm of shirting.
inline Scene small_drop(const std::vector<std::string>& overrides = {}) {
  const std::string text = R"(version: 1
title: small drop
duration: 20 ms
liquid:
  kind: water
  particle_mass: 0.016 mg
  drops:
    - {centre: [0 mm, 0 mm, 1.2 mm], volume: 3 uL, velocity: [0, 0, -0.1 m/s]}
textiles:
  - name: swatch
    size: [9 mm, 9 mm]
    weave: plain
    warp: {fibre: cotton, linear_density: 20 tex, density: 30 /cm}
    weft: {fibre: cotton, linear_density: 20 tex, density: 28 /cm}
)";
  return read_scene_text(text, (scenes_folder() / "small_drop.yaml").string(), overrides);
}

inline World build_small_drop(const std::vector<std::string>& overrides = {}) {
  return build(small_drop(overrides), scenes_folder() / "small_drop.yaml");
}

inline void run_until(World& world, Real until) { run(world, {.until = until, .every = 0, .max_steps = 0, .step = {}}, {}); }

}  // namespace imbibe::test
