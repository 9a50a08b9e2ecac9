// Fabrics by themselves: a fabric file (the keys of a scene's textile that describe the cloth), a WIF draft, or the
// textiles of a scene. A scene uses a fabric file through `textiles: [{extends: fabric.yaml, ...}]`.
// Tested in tests/scene/fabric_file_test.cpp.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "imbibe/fabric/fabric.h"
#include "imbibe/scene/document.h"

namespace imbibe {

struct NamedFabric {
  std::string name;
  FabricSpec spec;
  std::string key;                      // prefix of its keys in the file, e.g. textiles[0]
  std::map<std::string, Place> places;  // of the file
};

// Throws InputError with every problem of the file.
std::vector<NamedFabric> read_fabrics(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});

// build_fabric, with problems at their places in the file.
Fabric build_named_fabric(const NamedFabric& named, const FibreLibrary& fibres);

}  // namespace imbibe
