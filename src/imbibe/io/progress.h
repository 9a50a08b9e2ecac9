// The progress line of a run, as text: for a terminal, for a log, for machines. Pure functions of what is known; the
// caller owns the stream. Tested in tests/io/progress_test.cpp.
#pragma once

#include <iosfwd>
#include <string>

#include "imbibe/core/types.h"

namespace imbibe {

struct Progress {
  Real time_s = 0, until_s = 0;
  Real wall_s = 0;
  Real left_s = -1;          // wall time left; < 0: not known yet
  Real step_s = 0;
  std::string step_bound;    // what held the step
  Real free_kg = 0, absorbed_kg = 0, evaporated_kg = 0;
  Real ledger_error = 0;
  std::uint64_t steps = 0;
  std::size_t particles = 0;
};

// `t 0.512 s of 2 s  26 %  left 14 s  step 0.21 ms (capillary)  free 1.52 g  absorbed 124 mg  balance 3e-15`
std::string progress_text(const Progress& progress);
// One JSON object with the names of `Progress`, without line end. `left_s` is null when not known.
std::string progress_json(const Progress& progress);

// "850 ms", "14 s", "3 min 20 s", "2 h 05 min".
std::string duration_text(Real seconds);
// "12.3 mg", "1.52 g"; `unit` is SI: s, kg, m, m2; shown with the prefix that reads best.
std::string scaled_text(Real value, const std::string& unit, int digits = 3);

// Wall time left, from the speed of the recent past: steps differ by orders of magnitude over a run, so an average
// over the whole run would mislead. Exponential window of a fifth of the time already spent, at least 2 s.
class TimeLeft {
 public:
  // Feed in order. Returns the wall seconds left until `until_s`, < 0 while unknown.
  Real update(Real wall_s, Real time_s, Real until_s);

 private:
  Real last_wall_ = -1, last_time_ = 0;
  Real speed_ = -1;  // simulated seconds per wall second
};

enum class ProgressStyle { terminal, lines, json };  // `--progress auto` picks terminal or lines

// Writes at most ten times a second to a terminal, every few seconds otherwise; always the last one.
class ProgressWriter {
 public:
  ProgressWriter(std::ostream& out, ProgressStyle style, int terminal_columns = 120);
  void show(Progress progress);  // fills in left_s
  void finish();                 // writes the last line if it was held back, ends the line

 private:
  void write(const Progress& progress);

  std::ostream& out_;
  ProgressStyle style_;
  int columns_;
  TimeLeft left_;
  Progress held_;
  bool holding_ = false, line_open_ = false;
  Real last_shown_wall_ = -1e30;
};

}  // namespace imbibe
