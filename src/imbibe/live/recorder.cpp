#include "imbibe/live/recorder.h"

#include <fmt/format.h>

#include "imbibe/core/parallel.h"
#include "imbibe/scene/scene_files.h"

namespace imbibe::live {

namespace fs = std::filesystem;

fs::path free_folder(const fs::path& wanted) {
  for (int i = 1;; ++i) {
    fs::path folder = wanted;
    if (i > 1) folder += fmt::format("_{}", i);
    if (!fs::exists(folder)) return folder;
  }
}

RunSetup run_setup(const Scene& scene, const World& world, const std::string& command) {
  RunSetup setup;
  setup.command = command;
  setup.title = scene.title;
  Scene kept = scene;
  setup.files = take_files_along(kept, run_files_folder);
  setup.scene_yaml = write_scene(kept);
  setup.seed = world.seed;
  setup.threads = available_threads();
  setup.until_s = scene.duration;
  setup.every_s = output_interval(scene);
  const LiquidKind& kind = world.liquid.kind;
  for (const Textile& textile : world.textiles)
    setup.fabrics.emplace_back(textile.name,
                               describe_fabric(*textile.fabric, {kind.name, kind.density, kind.surface_tension}));
  setup.measures = scene.measures;
  setup.particle_files = scene.output.particles;
  setup.textile_files = scene.output.textiles;
  return setup;
}

Recorder::Recorder(const RecorderOptions& options, const Scene& scene, const World& world) {
  const fs::path folder = options.exactly ? options.folder : free_folder(options.folder);
  run_ = std::make_unique<RunFolder>(folder, run_setup(scene, world, options.command),
                                     options.overwrite ? ExistingFolder::overwrite : ExistingFolder::refuse, world);
  record(options.files);
  log_ = AppendFile(folder / changes_file);
}

void Recorder::change(const World& world, const std::vector<std::string>& assignments) {
  log_.append(change_line({world.step, world.time, assignments, false}));
  ++changes_;
}

void Recorder::finish(const World& world, RunStatus status, const std::string& reason) {
  if (finished_) return;
  finished_ = true;
  log_.append(change_line({world.step, world.time, {}, true}));
  run_->finish(world, status, reason);
}

}  // namespace imbibe::live
