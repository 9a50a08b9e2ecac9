// imbibe check SCENE: reads and builds the scene, prints what follows from it, runs nothing.
#include <fmt/format.h>

#include "apps/commands.h"
#include "imbibe/scene/check.h"

namespace {

struct CheckOptions {
  std::string scene;
  std::vector<std::string> sets;
  bool resolved = false;
};

}  // namespace

void add_check_command(CLI::App& app, CommandContext& context) {
  CLI::App* command = app.add_subcommand("check", "Read and check a scene; print its derived numbers");
  auto options = std::make_shared<CheckOptions>();
  command->add_option("scene", options->scene, "Scene file (YAML or JSON)")->required();
  command->add_option("--set", options->sets, "Change a value: path=value, e.g. textiles[0].warp.density='24 /cm'")
      ->allow_extra_args(false);
  command->add_flag("--resolved", options->resolved, "Print the scene with every value instead of the numbers");
  command->callback([options, &context] {
    const imbibe::Scene scene = imbibe::read_scene(options->scene, options->sets);
    const imbibe::Library library =
        imbibe::read_library(imbibe::library_folders(options->scene, context.data_folders));
    const imbibe::World world = imbibe::build_world(scene, library);
    fmt::print("{}", options->resolved ? imbibe::write_scene(scene) : imbibe::check_report(scene, world));
  });
}
