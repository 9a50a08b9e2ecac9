// The three kinds of error (docs/architecture.md, "Errors"):
//   InputError      the user's input or machine; carries every problem of a file, thrown once
//   NumericalError  the simulation blew up; says when and where
//   IMBIBE_ASSERT   our own bug; alive in release
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "imbibe/core/types.h"

namespace imbibe {

// One thing that is wrong with the input. line and column are 1-based; 0 = not known.
struct Problem {
  std::string file{};
  int line = 0;
  int column = 0;
  std::string key{};      // dotted path in the file, e.g. textiles[0].warp.diameter; may be empty
  std::string message{};  // what is wrong and what would be right

  // `file:line:column: error: key: message`
  std::string text() const;
};

class InputError : public std::runtime_error {
 public:
  explicit InputError(std::vector<Problem> problems);
  explicit InputError(std::string message);  // one problem without a place in a file
  const std::vector<Problem>& problems() const { return problems_; }

 private:
  std::vector<Problem> problems_;
};

class NumericalError : public std::runtime_error {
 public:
  NumericalError(Real time_s, std::uint64_t step, std::string stage, std::string where);
  Real time_s;
  std::uint64_t step;
  std::string stage;
  std::string where;
};

[[noreturn]] void assertion_failed(const char* expression, const char* file, int line);

// The known word nearest to `word` by edit distance, or "" when none is near enough to be meant.
std::string nearest_word(const std::string& word, const std::vector<std::string>& known);

}  // namespace imbibe

#define IMBIBE_ASSERT(condition) \
  ((condition) ? static_cast<void>(0) : ::imbibe::assertion_failed(#condition, __FILE__, __LINE__))
