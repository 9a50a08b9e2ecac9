#include "imbibe/core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace imbibe {

std::string Problem::text() const {
  std::string place;
  if (!file.empty()) place += file + ":";
  if (line > 0) place += fmt::format("{}:{}:", line, column);
  return fmt::format("{}{}error: {}{}{}", place, place.empty() ? "" : " ", key, key.empty() ? "" : ": ", message);
}

static std::string joined(const std::vector<Problem>& problems) {
  std::string all;
  for (const Problem& problem : problems) {
    if (!all.empty()) all += '\n';
    all += problem.text();
  }
  return all;
}

InputError::InputError(std::vector<Problem> problems)
    : std::runtime_error(joined(problems)), problems_(std::move(problems)) {}

InputError::InputError(std::string message)
    : InputError(std::vector<Problem>{Problem{.message = std::move(message)}}) {}

NumericalError::NumericalError(Real time, std::uint64_t at_step, std::string in_stage, std::string at)
    : std::runtime_error(
          fmt::format("numerical failure at t = {:.6g} s, step {}, stage {}: {}", time, at_step, in_stage, at)),
      time_s(time), step(at_step), stage(std::move(in_stage)), where(std::move(at)) {}

void assertion_failed(const char* expression, const char* file, int line) {
  throw std::logic_error(fmt::format("internal error: {} does not hold ({}:{})", expression, file, line));
}

static std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitution = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitution});
    }
  }
  return row.back();
}

std::string nearest_word(const std::string& word, const std::vector<std::string>& known) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, word.size() / 2) + 1;
  for (const std::string& candidate : known) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best_distance) best = candidate, best_distance = distance;
  }
  return best;
}

}  // namespace imbibe
