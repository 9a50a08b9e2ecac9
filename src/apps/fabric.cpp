// imbibe fabric FILE: the derived numbers of a fabric: of a fabric file, of a WIF draft, or of a scene's textiles.
#include <fmt/format.h>

#include "apps/commands.h"
#include "imbibe/scene/builder.h"
#include "imbibe/scene/fabric_file.h"

namespace {

struct FabricOptions {
  std::string file;
  std::string liquid = "water";
  std::vector<std::string> sets;
};

void print_fabrics(const FabricOptions& options, const CommandContext& context) {
  using namespace imbibe;
  const Library library = read_library(library_folders(options.file, context.data_folders));
  const LiquidRecord* liquid = find_liquid(library, options.liquid);
  if (liquid == nullptr) {
    std::vector<std::string> names;
    for (const LiquidRecord& record : library.liquids) names.push_back(record.kind.name);
    throw InputError(fmt::format("--liquid: there is no liquid '{}'. Known: {}", options.liquid, fmt::join(names, ", ")));
  }
  for (const NamedFabric& named : read_fabrics(options.file, options.sets)) {
    const Fabric fabric = build_named_fabric(named, library.fibres);
    fmt::print("fabric: {}\n{}", named.name,
               describe_fabric(fabric, {.name = liquid->kind.name, .density = liquid->kind.density,
                                        .surface_tension = liquid->kind.surface_tension}));
  }
}

}  // namespace

void add_fabric_command(CLI::App& app, CommandContext& context) {
  CLI::App* command = app.add_subcommand("fabric", "Print the derived numbers of a fabric");
  auto options = std::make_shared<FabricOptions>();
  command->add_option("file", options->file, "Fabric file (YAML), WIF draft, or scene")->required();
  command->add_option("--liquid", options->liquid, "Liquid of the capillary numbers")->capture_default_str();
  command->add_option("--set", options->sets, "Change a value: path=value")->allow_extra_args(false);
  command->callback([options, &context] { print_fabrics(*options, context); });
}
