// imbibe verify: the cases of closed forms and published figures, with a report.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>

#include "apps/commands.h"
#include "imbibe/core/error.h"
#include "imbibe/core/parallel.h"
#include "imbibe/verify/runner.h"

namespace {

using namespace imbibe;
namespace fs = std::filesystem;

struct VerifyArguments {
  verify::RunChoice choice;
  std::string output = "verify";
  int threads = 0;
  bool list = false, no_pictures = false;
};

fs::path scene_folder(const CommandContext& context) {
  for (const std::string& folder : context.data_folders) {
    const fs::path scenes = fs::path(folder) / "scenes" / "verify";
    if (fs::is_directory(scenes)) return scenes;
  }
  throw InputError("the folder scenes/verify is not among the data folders (IMBIBE_DATA_DIR)");
}

void list_cases() {
  std::string family;
  for (const verify::Case& c : verify::all_cases()) {
    if (c.family != family) std::printf("%s\n", (family = c.family).c_str());
    std::printf("  %-24s %s\n", c.name.c_str(), c.title.c_str());
  }
}

void show(const verify::CaseOutcome& o) {
  std::printf("%-6s %-24s %6.1f s\n", o.passed() ? "passed" : "FAILED", o.of->name.c_str(), o.seconds);
  if (!o.failure.empty()) std::printf("       did not run to its end: %s\n", o.failure.c_str());
  for (const verify::Check& c : o.result.checks) {
    std::printf("  %s %-58s %s against %s %s, error %s, tolerance %s\n", c.passed ? " " : "!", c.quantity.c_str(),
                verify::figure_text(c.measured).c_str(), verify::figure_text(c.reference).c_str(), c.unit.c_str(),
                verify::error_text(c).c_str(), verify::tolerance_text(c).c_str());
  }
  for (const verify::Convergence& t : o.result.convergence)
    std::printf("    order %.2f of %s\n", t.order, t.error_of.c_str());
  std::fflush(stdout);
}

int go(VerifyArguments a, const CommandContext& context) {
  if (a.list) return list_cases(), 0;
  std::unique_ptr<ThreadLimit> limit;
  if (a.threads > 0) limit = std::make_unique<ThreadLimit>(a.threads);
  a.choice.pictures = !a.no_pictures;
  const fs::path scenes = scene_folder(context);
  // Written after each case: a run that is stopped leaves what it had.
  const auto keep = [&](const verify::Verification& so_far) {
    show(so_far.outcomes.back());
    verify::Verification report = so_far;
    report.command = context.command_line;
    verify::write_report(report, a.output);
  };
  const verify::Verification v =
      verify::run_cases(a.choice, scenes, read_library(library_folders(scenes / "x.yaml", context.data_folders)), keep);
  int failed = 0;
  for (const verify::CaseOutcome& o : v.outcomes) failed += !o.passed();
  std::printf("%zu of %zu cases passed; report: %s\n", v.outcomes.size() - static_cast<std::size_t>(failed), v.outcomes.size(),
              (fs::path(a.output) / "verify.html").c_str());
  return failed ? 1 : 0;
}

}  // namespace

void add_verify_command(CLI::App& app, CommandContext& context) {
  auto a = std::make_shared<VerifyArguments>();
  CLI::App* command = app.add_subcommand("verify", "closed forms and published figures against the solver, with a report");
  command->add_option("names", a->choice.names, "cases (see --list); default: all");
  command->add_flag("--quick", a->choice.quick, "short form: coarser, fewer resolutions");
  command->add_option("-o,--output", a->output, "folder of verify.html and verify.json; default: verify");
  command->add_flag("--list", a->list, "names and titles of the cases");
  command->add_flag("--no-pictures", a->no_pictures, "figures and curves only");
  command->add_option("--threads", a->threads, "0 = all cores; results do not depend on it")->check(CLI::Range(0, 1024));
  command->callback([a, &context] { context.exit_code = go(*a, context); });
}
