#include "imbibe/verify/runner.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "imbibe/core/error.h"

namespace imbibe::verify {

std::vector<const Case*> chosen_cases(const RunChoice& choice) {
  std::vector<const Case*> chosen;
  std::vector<Problem> problems;
  std::vector<std::string> known;
  for (const Case& c : all_cases()) known.push_back(c.name);
  for (const std::string& name : choice.names) {
    const bool found = std::any_of(all_cases().begin(), all_cases().end(),
                                   [&](const Case& c) { return c.name == name || c.family == name; });
    if (found) continue;
    const std::string near = nearest_word(name, known);
    problems.push_back({.file = {}, .key = {}, .message = fmt::format("there is no case '{}'{}; see --list", name,
                                              near.empty() ? "" : fmt::format("; did you mean '{}'?", near))});
  }
  if (!problems.empty()) throw InputError(std::move(problems));
  for (const Case& c : all_cases()) {
    const bool wanted = choice.names.empty() ||
                        std::any_of(choice.names.begin(), choice.names.end(),
                                    [&](const std::string& n) { return c.name == n || c.family == n; });
    if (wanted) chosen.push_back(&c);
  }
  return chosen;
}

Verification run_cases(const RunChoice& choice, const std::filesystem::path& scene_folder, const Library& library,
                       const std::function<void(const Verification&)>& done) {
  Verification verification;
  verification.quick = choice.quick;
  verification.version = IMBIBE_VERSION;
  for (const Case* c : chosen_cases(choice)) {
    CaseRunner runner(scene_folder, library, choice.quick, choice.pictures);
    CaseOutcome outcome;
    outcome.of = c;
    const auto start = std::chrono::steady_clock::now();
    try {
      outcome.result = c->run(runner);
    } catch (const std::exception& error) {
      outcome.failure = error.what();
    }
    outcome.result.commands = runner.take_commands();
    outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    verification.outcomes.push_back(std::move(outcome));
    if (done) done(verification);
  }
  return verification;
}

}  // namespace imbibe::verify
