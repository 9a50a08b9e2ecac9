#include "imbibe/fabric/wif_sections.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace imbibe::wif {
namespace {

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front()))) text.remove_prefix(1);
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.remove_suffix(1);
  return text;
}

std::string shortened(std::string_view text) {
  return text.size() <= 40 ? std::string(text) : std::string(text.substr(0, 37)) + "...";
}

}  // namespace

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

std::string_view without_comment(std::string_view value) {
  const std::size_t at = value.find(';');
  return trimmed(at == std::string_view::npos ? value : value.substr(0, at));
}

Reader::Reader(std::string_view text, std::string file) : file_(std::move(file)) { split(text); }

const Section* Reader::find(const std::string& name) const {
  const auto it = sections_.find(name);
  return it == sections_.end() ? nullptr : &it->second;
}

void Reader::problem(int line, const Section* section, const std::string& key, std::string message) {
  if (++count_ > 100) return;  // a wrong file can be wrong on every line
  std::string place = section == nullptr ? std::string() : "[" + section->name + "]";
  if (!key.empty()) place += (place.empty() ? "" : " ") + key;
  problems_.push_back(Problem{file_, line, line > 0 ? 1 : 0, place, std::move(message)});
}

void Reader::finish() {
  if (count_ > 100)
    problems_.push_back(Problem{file_, 0, 0, "", fmt::format("{} more problems are not shown", count_ - 100)});
  if (!problems_.empty()) throw InputError(std::move(problems_));
}

const Entry* Reader::entry(const Section* section, const char* key) const {
  if (section == nullptr) return nullptr;
  for (const Entry& e : section->entries)
    if (e.key == key) return &e;
  return nullptr;
}

std::optional<bool> Reader::boolean(const Section* section, const Entry& e) {
  const std::string word = lower(without_comment(e.value));
  if (word == "true" || word == "on" || word == "yes" || word == "1") return true;
  if (word == "false" || word == "off" || word == "no" || word == "0") return false;
  problem(e.line, section, e.key, fmt::format("'{}' is not a boolean: true, on, yes, 1, false, off, no or 0", e.value));
  return std::nullopt;
}

std::optional<int> Reader::whole(const Section* section, const Entry& e, std::string_view text, int least, int most) {
  text = trimmed(text);
  int value = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || (code != std::errc{} && code != std::errc::result_out_of_range) ||
      end != text.data() + text.size()) {
    problem(e.line, section, e.key, fmt::format("'{}' is not a whole number", text));
    return std::nullopt;
  }
  if (code == std::errc::result_out_of_range || value < least || value > most) {
    problem(e.line, section, e.key, fmt::format("{} is outside [{}, {}]", text, least, most));
    return std::nullopt;
  }
  return value;
}

std::optional<Real> Reader::number(const Section* section, const Entry& e) {
  const std::string_view text = without_comment(e.value);
  Real value = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || code != std::errc{} || end != text.data() + text.size() || !std::isfinite(value) || value < 0) {
    problem(e.line, section, e.key, fmt::format("'{}' is not a number of 0 or more", e.value));
    return std::nullopt;
  }
  return value;
}

int Reader::whole_or(const Section* section, const char* key, int otherwise, int least, int most) {
  const Entry* e = entry(section, key);
  if (e == nullptr) return otherwise;
  return whole(section, *e, without_comment(e->value), least, most).value_or(otherwise);
}

std::vector<Row> Reader::rows(const Section* section, int last, const char* what, int least, int most,
                              std::size_t fewest, std::size_t largest) {
  std::vector<Row> out;
  if (section == nullptr) return out;
  std::map<int, int> seen;
  for (const Entry& e : section->entries) {
    const std::optional<int> n = row_number(section, e, last, what, seen);
    if (!n) continue;
    Row row{*n, {}, e.line};
    std::string_view rest = without_comment(e.value);
    bool good = true;
    if (rest.empty() && fewest <= 1) {
      out.push_back(std::move(row));
      continue;
    }
    while (true) {
      const std::size_t comma = rest.find(',');
      const std::optional<int> value = whole(section, e, rest.substr(0, comma), least, most);
      good = good && value.has_value();
      if (value) row.values.push_back(*value);
      if (comma == std::string_view::npos || row.values.size() > largest) break;
      rest.remove_prefix(comma + 1);
    }
    if (good && (row.values.size() < fewest || row.values.size() > largest)) {
      problem(e.line, section, e.key, fewest == largest ? fmt::format("needs {} numbers, has {}", fewest, row.values.size())
                                                        : fmt::format("has too many numbers ({})", row.values.size()));
      good = false;
    }
    if (good) out.push_back(std::move(row));
  }
  return out;
}

std::optional<int> Reader::row_number(const Section* section, const Entry& e, int last, const char* what,
                              std::map<int, int>& seen) {
  int n = 0;
  const auto [end, code] = std::from_chars(e.key.data(), e.key.data() + e.key.size(), n);
  if (code != std::errc{} || end != e.key.data() + e.key.size()) {
    problem(e.line, section, e.key, fmt::format("is not the number of a {}", what));
    return std::nullopt;
  }
  if (n < 1 || n > last) {
    problem(e.line, section, e.key, last < 1 ? fmt::format("there is no {}", what)
                                             : fmt::format("there is no {} {}: they run from 1 to {}", what, n, last));
    return std::nullopt;
  }
  const auto [it, fresh] = seen.emplace(n, e.line);
  if (!fresh) {
    problem(e.line, section, e.key, fmt::format("{} {} was given before, on line {}", what, n, it->second));
    return std::nullopt;
  }
  return n;
}

void Reader::split(std::string_view text) {
  if (text.size() >= 3 && text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
  Section* open = nullptr;
  int line = 0;
  while (!text.empty()) {
    const std::size_t at = text.find_first_of("\r\n");
    std::string_view raw = trimmed(text.substr(0, at));
    if (at == std::string_view::npos) text = {};
    else text.remove_prefix(at + (text.substr(at, 2) == "\r\n" ? 2 : 1));
    ++line;
    if (raw.empty() || raw.front() == ';') continue;
    if (raw.front() == '[') open = open_section(raw, line);
    else if (open != nullptr) read_entry(raw, line, *open);
    else if (!skipping_) problem(line, nullptr, "", fmt::format("'{}' stands before the first [section]", shortened(raw)));
  }
}

Section* Reader::open_section(std::string_view raw, int line) {
  skipping_ = false;
  const std::size_t close = raw.find(']');
  const std::string_view name = close == std::string_view::npos ? raw.substr(1) : trimmed(raw.substr(1, close - 1));
  if (close == std::string_view::npos || name.empty()) {
    problem(line, nullptr, "", fmt::format("'{}' is not a [section]", shortened(raw)));
    skipping_ = true;
    return nullptr;
  }
  const auto [it, fresh] = sections_.emplace(lower(name), Section{std::string(name), line, {}});
  if (!fresh) {
    problem(line, &it->second, "", fmt::format("the section was given before, on line {}", it->second.line));
    skipping_ = true;
    return nullptr;
  }
  // Free text and other programs' own sections need not be key=value.
  it->second.entries.reserve(8);
  return &it->second;
}

void Reader::read_entry(std::string_view raw, int line, Section& section) {
  const std::string name = lower(section.name);
  const bool free_text = name == "notes" || name == "text" || name.substr(0, 7) == "private";
  const std::size_t equals = raw.find('=');
  if (equals == std::string_view::npos || equals == 0) {
    if (!free_text) problem(line, &section, "", fmt::format("'{}' is not key=value", shortened(raw)));
    return;
  }
  section.entries.push_back(
      {lower(trimmed(raw.substr(0, equals))), std::string(trimmed(raw.substr(equals + 1))), line});
}

}  // namespace imbibe::wif
