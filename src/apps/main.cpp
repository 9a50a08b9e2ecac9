// imbibe: the command line. Reads the arguments, calls one command, turns errors into messages and exit codes.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>

#include "apps/best_build.h"
#include "apps/commands.h"
#include "imbibe/core/error.h"

namespace {

// Data folders: IMBIBE_DATA_DIR when set, else share/imbibe beside an installed bin/, else the current folder.
std::vector<std::string> data_folders() {
  std::vector<std::string> folders;
  if (const char* given = std::getenv("IMBIBE_DATA_DIR")) folders.emplace_back(given);
  std::error_code ignored;
  const auto self = std::filesystem::canonical("/proc/self/exe", ignored);
  if (!ignored) folders.push_back((self.parent_path().parent_path() / "share" / "imbibe").string());
  folders.emplace_back(".");
  return folders;
}

std::string program_name() {
  const char* launcher = std::getenv("IMBIBE_LAUNCHER");
  return launcher ? launcher : "imbibe";
}

std::string command_line(int count, char** words) {
  std::string line = program_name();
  for (int i = 1; i < count; ++i) line += std::string(" ") + words[i];
  return line;
}

}  // namespace

int main(int count, char** words) {
  go_on_as_best_build(words);
  CLI::App app{"Imbibe: liquid wetting textiles", "imbibe"};
  app.require_subcommand(1);
  app.set_version_flag("--version", IMBIBE_VERSION);
  CommandContext context;
  context.data_folders = data_folders();
  context.program = program_name();
  context.command_line = command_line(count, words);
  add_run_command(app, context);
  add_check_command(app, context);
  add_params_command(app, context);
  add_fabric_command(app, context);
  add_render_command(app, context);
  add_report_command(app, context);
  add_verify_command(app, context);
  add_live_command(app, context);
  try {
    app.parse(count, words);
    return context.exit_code;
  } catch (const CLI::ParseError& error) {
    const int code = app.exit(error);
    return code == 0 ? 0 : 2;
  } catch (const imbibe::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  } catch (const imbibe::NumericalError& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 3;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "error: out of memory\n");
    return 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
}
