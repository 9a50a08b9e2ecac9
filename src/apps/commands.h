// The commands of `imbibe`, one per file. Each adds its subcommand and its options to the application; the callback
// sets `exit_code` (DESIGN of the exit codes: 0 done, 1 run-time failure, 2 bad usage or scene, 3 numerical failure,
// 130 interrupted with a checkpoint saved). Errors are thrown; main.cpp prints them.
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

struct CommandContext {
  int exit_code = 0;
  std::vector<std::string> data_folders;  // where fibres/, liquids/ and fabrics/ are looked for, in order
  std::string program;                    // as typed: imbibe, or its launcher
  std::string command_line;               // to repeat the command, as typed
};

void add_run_command(CLI::App& app, CommandContext& context);
void add_check_command(CLI::App& app, CommandContext& context);
void add_params_command(CLI::App& app, CommandContext& context);
void add_fabric_command(CLI::App& app, CommandContext& context);
void add_render_command(CLI::App& app, CommandContext& context);
void add_report_command(CLI::App& app, CommandContext& context);
void add_verify_command(CLI::App& app, CommandContext& context);
void add_live_command(CLI::App& app, CommandContext& context);
