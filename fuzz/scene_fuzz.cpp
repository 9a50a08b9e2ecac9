// Scenes, with lines "#set path=value" as overrides. A scene that is read is written and reads back to the same text;
// then it is built, if it is small.
#include <sstream>
#include <vector>

#include "fuzz.h"
#include "imbibe/scene/builder.h"
#include "imbibe/scene/library.h"
#include "imbibe/scene/scene.h"

using namespace imbibe;

namespace {

const Library& library() {
  static const Library all = read_library({IMBIBE_SOURCE_DIR});
  return all;
}

// Files beside the scene are the business of other targets, and must not depend on what lies on the disk.
bool names_a_file(const Scene& scene) {
  for (const SolidSpec& solid : scene.solids)
    if (solid.shape.file) return true;
  for (const TextileSpec& textile : scene.textiles)
    if (textile.fabric.weave.find('.') != std::string::npos) return true;
  return false;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text = fuzz::text_of(data, size);
  std::vector<std::string> overrides;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("#set ")) overrides.push_back(line.substr(5));
  fuzz::reads([&] {
    Scene scene = read_scene_text(text, "fuzz.yaml", overrides);
    if (names_a_file(scene)) return;
    const std::string written = write_scene(scene);
    IMBIBE_ASSERT(write_scene(read_scene_text(written, "again.yaml")) == written);
    scene.limits.max_particles = std::min<Real>(scene.limits.max_particles, 3000);
    scene.limits.max_memory = 64e6;
    const World world = build_world(scene, library());
    for (const Textile& textile : world.textiles) IMBIBE_ASSERT(textile.fabric->network.nodes() > 0);
    IMBIBE_ASSERT(mass_balance(world).error() <= 1e-10);
  });
  return 0;
}
