// A small plain-woven fabric for tests, built by the real builder.
#pragma once

#include <filesystem>

#include "imbibe/fabric/fabric.h"

namespace imbibe::test {

// ends x picks yarns at the given pitch, diameter 0.4 of the pitch.
inline Fabric woven(const std::string& warp_fibre, const std::string& weft_fibre, int yarns = 12, Real pitch = 1e-3) {
  FabricSpec spec;
  spec.size = {yarns * pitch, yarns * pitch};
  spec.warp.fibre = warp_fibre;
  spec.weft.fibre = weft_fibre;
  spec.warp.diameter = spec.weft.diameter = 0.4 * pitch;
  spec.warp.density = spec.weft.density = 1 / pitch;
  return build_fabric(spec, read_fibre_library({std::filesystem::path(IMBIBE_SOURCE_DIR) / "fibres"}));
}

}  // namespace imbibe::test
