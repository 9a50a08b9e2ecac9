// The files that a scene names beside those of the library: meshes and drafts.
// Tested in tests/cli/run_test.cpp and tests/live/gallery_test.cpp.
#pragma once

#include <fmt/format.h>

#include <map>
#include <string>

#include "imbibe/fabric/wif.h"
#include "imbibe/scene/scene.h"

namespace imbibe {

// The keys that name files, all of them: visit(name, key).
template <class AnyScene, class Visit>
void visit_file_names(AnyScene& scene, Visit&& visit) {
  for (std::size_t i = 0; i < scene.textiles.size(); ++i) {
    auto& textile = scene.textiles[i];
    if (is_wif_name(textile.fabric.weave)) visit(textile.fabric.weave, fmt::format("textiles[{}].weave", i));
    if (textile.sheet.soft && textile.sheet.soft->mesh)
      visit(*textile.sheet.soft->mesh, fmt::format("textiles[{}].sheet.soft.mesh", i));
  }
  for (std::size_t i = 0; i < scene.liquid.pipes.size(); ++i)
    if (scene.liquid.pipes[i].file) visit(*scene.liquid.pipes[i].file, fmt::format("liquid.pipes[{}].file", i));
  for (std::size_t i = 0; i < scene.solids.size(); ++i)
    if (scene.solids[i].shape.file) visit(*scene.solids[i].shape.file, fmt::format("solids[{}].shape.file", i));
}

// Makes the scene name them as `folder`/NAME, relative to where it will be written, and returns what they hold, by those
// names. Files of the same name from different folders are numbered. Throws where one cannot be read.
std::map<std::string, std::string> take_files_along(Scene& scene, const std::string& folder);

}  // namespace imbibe
