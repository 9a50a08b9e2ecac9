// imbibe params: every key of a scene file with its unit, range, default and meaning.
#include <fmt/format.h>

#include "apps/commands.h"
#include "imbibe/scene/parameter_table.h"
#include "imbibe/scene/scene.h"

namespace {

struct ParamsOptions {
  bool json = false, markdown = false, schema = false;
  std::string filter;
};

}  // namespace

void add_params_command(CLI::App& app, CommandContext&) {
  CLI::App* command = app.add_subcommand("params", "List every key of a scene file");
  auto options = std::make_shared<ParamsOptions>();
  command->add_option("part", options->filter, "Only keys whose path holds this text, e.g. wetting");
  auto* json = command->add_flag("--json", options->json, "As JSON");
  auto* markdown = command->add_flag("--markdown", options->markdown, "As the reference page");
  auto* schema = command->add_flag("--schema", options->schema, "As JSON Schema, for editors");
  json->excludes(markdown)->excludes(schema);
  markdown->excludes(schema);
  command->callback([options] {
    using namespace imbibe;
    std::vector<ParameterRow> rows = parameter_rows<Scene>();
    if (options->schema) return fmt::print("{}", table_schema(rows, "Imbibe scene"));
    if (options->markdown) return fmt::print("{}", table_markdown(rows));
    if (!options->filter.empty())
      std::erase_if(rows, [&](const ParameterRow& r) { return r.path.find(options->filter) == std::string::npos; });
    if (rows.empty()) throw InputError(fmt::format("no key holds '{}'", options->filter));
    fmt::print("{}", options->json ? table_json(rows) : table_text(rows));
  });
}
