// The data files a scene draws on: fibres (fabric/fibre_file.h) and liquids.
//
//   name: water                                   # liquids/water.yaml
//   title: Water, distilled
//   temperature: 20 degC
//   values:
//     density: {value: 998.2 kg/m3, source: "...", confidence: high}
//     viscosity: {value: 1.002 mPa s, source: "...", confidence: high}
//     surface_tension: {value: 72.8 mN/m, source: "...", confidence: high}
//
// A data folder holds fibres/ and liquids/. Later folders win over earlier ones, so a user's own data beside the scene
// replaces what is installed. Tested in tests/scene/library_test.cpp.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "imbibe/core/error.h"
#include "imbibe/fabric/fibre_file.h"
#include "imbibe/liquid/particles.h"

namespace imbibe {

struct LiquidRecord {
  LiquidKind kind;
  std::string title;
  Real temperature = 293.15;           // K, at which the values hold
  std::vector<FibreValue> values;      // what was written, with source and confidence
  std::filesystem::path file;
};

struct Library {
  FibreLibrary fibres;
  std::vector<LiquidRecord> liquids;   // sorted by name
  std::vector<std::filesystem::path> folders;
};

// Throws InputError with all problems of the file.
LiquidRecord read_liquid_file(const std::filesystem::path& file);

// The folders to search for a scene, lowest rank first: those of the program (installed or source tree), the one that
// the environment variable IMBIBE_DATA_DIR names, then every folder above the scene file that holds fibres/ or
// liquids/, the nearest last.
std::vector<std::filesystem::path> library_folders(const std::filesystem::path& scene_file,
                                                const std::vector<std::string>& program_folders);

// Reads all fibres and liquids of the folders. Throws InputError with the problems of all files, or when there is no
// data at all.
Library read_library(const std::vector<std::filesystem::path>& folders);

const LiquidRecord* find_liquid(const Library& library, const std::string& name);

}  // namespace imbibe
