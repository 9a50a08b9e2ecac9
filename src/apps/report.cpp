// imbibe report: makes report.html of a run folder again.
#include <cstdio>

#include "apps/commands.h"
#include "imbibe/io/report.h"

void add_report_command(CLI::App& app, CommandContext&) {
  CLI::App* command = app.add_subcommand("report", "make report.html of a run folder again");
  auto folder = std::make_shared<std::string>();
  command->add_option("run", *folder, "run folder")->required()->check(CLI::ExistingDirectory);
  command->callback([folder] { std::printf("%s\n", imbibe::write_report(*folder).c_str()); });
}
