#include "imbibe/io/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>

namespace imbibe {

std::string duration_text(Real seconds) {
  if (!(seconds >= 0)) return "unknown";
  if (seconds < 0.9995) return fmt::format("{:.0f} ms", seconds * 1e3);
  if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
  const auto whole = static_cast<long long>(std::min(seconds + 0.5, 9e15));
  if (whole < 120) return fmt::format("{} s", whole);
  if (whole < 7200) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  const long long minutes = (whole + 30) / 60;
  if (minutes < 48 * 60) return fmt::format("{} h {:02} min", minutes / 60, minutes % 60);
  return fmt::format("{:.1f} days", seconds / 86400);
}

std::string scaled_text(Real value, const std::string& unit, int digits) {
  if (!std::isfinite(value)) return fmt::format("{} {}", value, unit);
  struct Prefix {
    Real scale;
    const char* text;
  };
  static constexpr std::array<Prefix, 6> lengths{
      {{1e3, "k"}, {1, ""}, {1e-3, "m"}, {1e-6, "µ"}, {1e-9, "n"}, {1e-12, "p"}}};
  static constexpr std::array<Prefix, 4> times{{{1, ""}, {1e-3, "m"}, {1e-6, "µ"}, {1e-9, "n"}}};  // nobody says ks
  static constexpr std::array<Prefix, 5> masses{{{1, "k"}, {1e-3, ""}, {1e-6, "m"}, {1e-9, "µ"}, {1e-12, "n"}}};
  static constexpr std::array<Prefix, 3> areas{{{1, ""}, {1e-4, "c"}, {1e-6, "m"}}};
  const auto with = [&](const auto& prefixes, const std::string& base) {
    if (value == 0) return "0 " + base;
    if (unit == "kg" && std::abs(value) < 1e-15) return "0 " + base;  // below a picogram: rounding of sums
    // Rounded before the prefix is chosen, so that 0.9999 does not become "1e+03 m".
    const Real rounded = std::stod(fmt::format("{:.{}g}", value, digits));
    const Prefix* best = &prefixes.back();
    for (const Prefix& p : prefixes) {
      if (std::fabs(rounded) >= p.scale * (1 - 1e-12)) {
        best = &p;
        break;
      }
    }
    const Real scaled = rounded / best->scale;
    const int whole_digits = 1 + static_cast<int>(std::floor(std::log10(std::max(std::fabs(scaled), 1e-300)) + 1e-12));
    if (std::fabs(scaled) < 1e-3) return fmt::format("{:.{}e} {}{}", scaled, digits - 1, best->text, base);
    // Trailing zeros are kept: they say how exact the number is, and a line of numbers does not jump about.
    return fmt::format("{:.{}f} {}{}", scaled, std::clamp(digits - whole_digits, 0, 12), best->text, base);
  };
  if (unit == "kg") return with(masses, "g");
  if (unit == "m2") return with(areas, "m²");
  if (unit == "s") return with(times, unit);
  return with(lengths, unit);
}

std::string progress_text(const Progress& p) {
  const Real share = p.until_s > 0 ? std::clamp(p.time_s / p.until_s, 0.0, 1.0) : 0;
  std::string line = fmt::format("t {} of {}  {:3.0f} %", scaled_text(p.time_s, "s"), scaled_text(p.until_s, "s"),
                                 std::floor(share * 100));
  line += p.left_s >= 0 ? "  left " + duration_text(p.left_s) : std::string("  left …");
  line += "  step " + scaled_text(p.step_s, "s", 2);
  if (!p.step_bound.empty()) line += " (" + p.step_bound + ")";
  line += fmt::format("  free {}  absorbed {}", scaled_text(p.free_kg, "kg"), scaled_text(p.absorbed_kg, "kg"));
  if (p.evaporated_kg != 0) line += "  evaporated " + scaled_text(p.evaporated_kg, "kg");
  return line + fmt::format("  balance {:.0e}", p.ledger_error);
}

std::string progress_json(const Progress& p) {
  using Json = nlohmann::ordered_json;
  // JSON has no NaN or infinity: null says that there is no number.
  const auto number = [](Real x) { return std::isfinite(x) ? Json(x) : Json(nullptr); };
  Json out;
  out["time_s"] = number(p.time_s);
  out["until_s"] = number(p.until_s);
  out["wall_s"] = number(p.wall_s);
  out["left_s"] = p.left_s >= 0 ? number(p.left_s) : Json(nullptr);
  out["step_s"] = number(p.step_s);
  out["step_bound"] = p.step_bound;
  out["free_kg"] = number(p.free_kg);
  out["absorbed_kg"] = number(p.absorbed_kg);
  out["evaporated_kg"] = number(p.evaporated_kg);
  out["ledger_error"] = number(p.ledger_error);
  out["steps"] = p.steps;
  out["particles"] = p.particles;
  return out.dump();
}

Real TimeLeft::update(Real wall_s, Real time_s, Real until_s) {
  if (last_wall_ < 0) {
    last_wall_ = wall_s;
    last_time_ = time_s;
    return -1;
  }
  const Real wall = wall_s - last_wall_;
  // Shorter intervals carry more noise than news.
  if (wall >= 0.02) {
    const Real now = (time_s - last_time_) / wall;
    const Real window = std::max(2.0, 0.2 * wall_s);
    speed_ = speed_ < 0 ? now : speed_ + (1 - std::exp(-wall / window)) * (now - speed_);
    last_wall_ = wall_s;
    last_time_ = time_s;
  }
  if (time_s >= until_s) return 0;
  return speed_ > 0 ? (until_s - time_s) / speed_ : -1;
}

ProgressWriter::ProgressWriter(std::ostream& out, ProgressStyle style, int terminal_columns)
    : out_(out), style_(style), columns_(terminal_columns) {}

void ProgressWriter::show(Progress progress) {
  progress.left_s = left_.update(progress.wall_s, progress.time_s, progress.until_s);
  // A log file wants few lines at first sight and still fewer in a long run.
  const Real pause = style_ == ProgressStyle::terminal ? 0.1
                     : style_ == ProgressStyle::json   ? 0.5
                                                       : std::clamp(0.05 * progress.wall_s, 2.0, 60.0);
  if (progress.wall_s - last_shown_wall_ < pause) {
    held_ = std::move(progress);
    holding_ = true;
    return;
  }
  last_shown_wall_ = progress.wall_s;
  holding_ = false;
  write(progress);
}

void ProgressWriter::finish() {
  if (holding_) write(held_);
  holding_ = false;
  if (line_open_) out_ << '\n' << std::flush;
  line_open_ = false;
}

namespace {

// At most `columns` characters of UTF-8 text: a longer line would wrap, and carriage return would not erase it.
std::string fitted(const std::string& text, int columns) {
  int count = 0;
  std::size_t end = 0;
  while (end < text.size()) {
    if ((static_cast<unsigned char>(text[end]) & 0xC0) != 0x80 && ++count > columns) break;
    ++end;
  }
  return text.substr(0, end);
}

}  // namespace

void ProgressWriter::write(const Progress& progress) {
  switch (style_) {
    case ProgressStyle::terminal:
      out_ << '\r' << fitted(progress_text(progress), columns_ - 1) << "\x1b[K" << std::flush;
      line_open_ = true;
      break;
    case ProgressStyle::lines: out_ << progress_text(progress) << '\n' << std::flush; break;
    case ProgressStyle::json: out_ << progress_json(progress) << '\n' << std::flush; break;
  }
}

}  // namespace imbibe
