#include "imbibe/scene/describe_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>

#include "imbibe/core/quantity.h"

namespace imbibe {

using Kind = DataNode::Kind;

Place place_of(const std::map<std::string, Place>& places, std::string path) {
  while (true) {
    if (const auto found = places.find(path); found != places.end()) return found->second;
    if (path.empty()) return {};
    const std::size_t cut = path.find_last_of(".[");
    path.resize(cut == std::string::npos ? 0 : cut);
  }
}

namespace reading {
namespace {

const char* kind_name(Kind kind) {
  switch (kind) {
    case Kind::null: return "nothing";
    case Kind::scalar: return "a single value";
    case Kind::list: return "a list";
    case Kind::map: return "a map";
  }
  return "";
}

bool fail(const DataNode& node, const std::string& path, const std::string& message, ReadLog& log) {
  log.problems.push_back(problem_at(node.place, path, message));
  return false;
}

bool is_scalar(const DataNode& node, const std::string& path, const std::string& wanted, ReadLog& log) {
  if (node.kind == Kind::scalar) return true;
  if (node.kind == Kind::null) return fail(node, path, fmt::format("has no value; wants {}", wanted), log);
  return fail(node, path, fmt::format("wants {}, not {}", wanted, kind_name(node.kind)), log);
}

std::string_view shown_unit(const ParameterInfo& info) { return *info.shown ? info.shown : info.unit; }

std::string shown(double si, const ParameterInfo& info) {
  if (std::isinf(si)) return "unlimited";
  const std::string_view unit = shown_unit(info);
  if (unit == "1") return fmt::format("{:.6g}", si);
  return format_quantity(si, info.unit, unit);
}

std::string wanted_quantity(const ParameterInfo& info) {
  const std::string_view unit = shown_unit(info);
  if (unit == "1") return "a number";
  return fmt::format("a number with a unit such as '{}'", unit);
}

bool in_range(const DataNode& node, const std::string& path, double value, const ParameterInfo& info, ReadLog& log) {
  const bool low = info.above_min ? value <= info.min : value < info.min;
  if (!low && value <= info.max) return true;
  if (std::isinf(info.max) && low)
    return fail(node, path,
                fmt::format("{} is out of range: it must be {} {}", node.text, info.above_min ? "above" : "at least",
                            shown(info.min, info)),
                log);
  if (std::isinf(info.min) && !low)
    return fail(node, path, fmt::format("{} is out of range: it must be at most {}", node.text, shown(info.max, info)),
                log);
  return fail(node, path,
              fmt::format("{} is outside {}{}, {}]", node.text, info.above_min ? "(" : "[", shown(info.min, info),
                          shown(info.max, info)),
              log);
}

// yaml's spellings of the values that are not numbers.
bool not_finite_word(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) text.erase(0, 1);
  return text.starts_with(".nan") || text.starts_with(".inf") || text.starts_with("nan") ||
         text.starts_with("inf");
}

// "2.2 kg/(m2 s^0.5)" where exactly that unit is wanted is "2.2": the unit library has no fractional powers.
std::string without_own_unit(const std::string& text, std::string_view unit) {
  if (unit.find('^') == std::string_view::npos || !text.ends_with(unit)) return text;
  return text.substr(0, text.size() - unit.size());
}

template <class Integer>
bool read_integer(const DataNode& node, const std::string& path, Integer& out, const ParameterInfo& info,
                  ReadLog& log) {
  if (!is_scalar(node, path, "a whole number", log)) return false;
  Integer value{};
  const std::string& text = node.text;
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto [end, code] = std::from_chars(begin, text.data() + text.size(), value);
  if (code == std::errc::result_out_of_range)
    return fail(node, path, fmt::format("{} is too large a number", text), log);
  if (code != std::errc{} || end != text.data() + text.size())
    return fail(node, path, fmt::format("'{}' is not a whole number{}", text, std::is_unsigned_v<Integer> ? " of 0 or more" : ""),
                log);
  if (!in_range(node, path, static_cast<double>(value), info, log)) return false;
  out = value;
  return true;
}

}  // namespace

bool read_scalar(const DataNode& node, const std::string& path, Real& out, const ParameterInfo& info, ReadLog& log) {
  if (!is_scalar(node, path, wanted_quantity(info), log)) return false;
  if (not_finite_word(node.text)) return fail(node, path, fmt::format("'{}' is not a finite number", node.text), log);
  Real value = 0;
  try {
    value = parse_quantity(without_own_unit(node.text, info.unit), info.unit);
  } catch (const QuantityError& e) {
    const std::string hint = shown_unit(info) == "1" ? "" : fmt::format("; wants {}", wanted_quantity(info));
    return fail(node, path, e.what() + hint, log);
  }
  if (!std::isfinite(value)) return fail(node, path, fmt::format("'{}' is not a finite number", node.text), log);
  if (!in_range(node, path, value, info, log)) return false;
  out = value;
  return true;
}

bool read_scalar(const DataNode& node, const std::string& path, float& out, const ParameterInfo& info, ReadLog& log) {
  Real value = 0;
  if (!read_scalar(node, path, value, info, log)) return false;
  out = static_cast<float>(value);
  return true;
}

bool read_scalar(const DataNode& node, const std::string& path, int& out, const ParameterInfo& info, ReadLog& log) {
  return read_integer(node, path, out, info, log);
}

bool read_scalar(const DataNode& node, const std::string& path, std::uint64_t& out, const ParameterInfo& info,
                 ReadLog& log) {
  return read_integer(node, path, out, info, log);
}

bool read_scalar(const DataNode& node, const std::string& path, bool& out, const ParameterInfo&, ReadLog& log) {
  if (!is_scalar(node, path, "true or false", log)) return false;
  std::string word = node.text;
  std::transform(word.begin(), word.end(), word.begin(), [](unsigned char c) { return std::tolower(c); });
  if (word == "true" || word == "yes" || word == "on") return out = true;
  if (word == "false" || word == "no" || word == "off") {
    out = false;
    return true;
  }
  return fail(node, path, fmt::format("'{}' is not true or false", node.text), log);
}

bool read_scalar(const DataNode& node, const std::string& path, std::string& out, const ParameterInfo& info,
                 ReadLog& log) {
  if (!is_scalar(node, path, "a text", log)) return false;
  if (node.text.empty() && !out.empty()) {
    return fail(node, path, fmt::format("is empty; wants a text ('{}' where the key is left out)", out), log);
  }
  out = node.text;
  if (std::string_view(info.unit) == "file" && !out.empty() && node.place.file) {
    const std::filesystem::path named(out);
    const std::filesystem::path from = std::filesystem::path(*node.place.file).parent_path();
    if (named.is_relative() && !from.empty()) out = (from / named).lexically_normal().string();
  }
  return true;
}

bool wants_list(const DataNode& node, const std::string& path, std::size_t count, ReadLog& log) {
  if (node.kind != Kind::list) {
    if (count > 0) return fail(node, path, fmt::format("wants a list of {} values, not {}", count, kind_name(node.kind)), log);
    return fail(node, path, fmt::format("wants a list, not {}", kind_name(node.kind)), log);
  }
  if (count == 0 || node.items.size() == count) return true;
  return fail(node, path, fmt::format("wants {} values, has {}", count, node.items.size()), log);
}

std::size_t chosen(const DataNode& node, const std::string& path, const std::vector<std::string>& words, ReadLog& log) {
  const std::string list = fmt::format("{}", fmt::join(words, ", "));
  if (!is_scalar(node, path, "one of: " + list, log)) return words.size();
  const auto found = std::find(words.begin(), words.end(), node.text);
  if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
  const std::string near = nearest_word(node.text, words);
  fail(node, path,
       fmt::format("'{}' is not one of: {}{}", node.text, list,
                   near.empty() ? "" : fmt::format("; did you mean '{}'?", near)),
       log);
  return words.size();
}

}  // namespace reading

DescribeReader::DescribeReader(const DataNode& node, std::string path, ReadLog& log)
    : node_(node), path_(std::move(path)), log_(log), is_map_(node.kind == Kind::map) {
  log_.places.emplace(path_, node.place);
}

const DataNode* DescribeReader::given(const char* name, bool required) {
  known_.emplace_back(name);
  for (std::size_t i = 0; i < node_.keys.size(); ++i) {
    if (node_.keys[i] != name) continue;
    log_.places.emplace(key_path(name), node_.items[i].place);
    return &node_.items[i];
  }
  if (required && is_map_)
    log_.problems.push_back(problem_at(node_.place, key_path(name), "is missing: this key must be given"));
  return nullptr;
}

void DescribeReader::short_form(const char* name) {
  if (node_.kind == Kind::scalar) {
    DataNode map;
    map.kind = Kind::map;
    map.place = node_.place;
    map.keys.emplace_back(name);
    map.key_places.push_back(node_.place);
    map.items.push_back(node_);
    node_ = std::move(map);
    is_map_ = true;
  } else if (is_map_ && node_.find(short_form_key) != nullptr && node_.find(name) == nullptr) {
    for (std::string& key : node_.keys)
      if (key == short_form_key) key = name;
  } else if (is_map_ && node_.find(short_form_key) != nullptr) {
    known_.emplace_back(short_form_key);  // the long form was set on top of the short one: it wins
  }
}

void DescribeReader::unavailable(const char* name, const char* message) {
  if (!unknown_word_.empty() && unknown_word_ == name) log_.problems[unknown_word_problem_].message = message;
  unavailable_.emplace_back(name);
  for (std::size_t i = 0; i < node_.keys.size(); ++i)
    if (node_.keys[i] == name) log_.problems.push_back(problem_at(node_.key_places[i], key_path(name), message));
}

void DescribeReader::finish() {
  if (!is_map_) {
    const std::string keys = fmt::format("{}", fmt::join(known_, ", "));
    const std::string found = node_.kind == Kind::null ? "has no value; wants" : "wants";
    log_.problems.push_back(problem_at(node_.place, path_, fmt::format("{} a map of keys ({})", found, keys)));
    return;
  }
  for (std::size_t i = 0; i < node_.keys.size(); ++i) {
    const std::string& key = node_.keys[i];
    if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
    if (std::find(unavailable_.begin(), unavailable_.end(), key) != unavailable_.end()) continue;
    const std::string near = nearest_word(key, known_);
    const std::string hint = near.empty() ? fmt::format("known keys: {}", fmt::join(known_, ", "))
                                          : fmt::format("did you mean '{}'?", near);
    log_.problems.push_back(problem_at(node_.key_places[i], key_path(key), "unknown key; " + hint));
  }
}

}  // namespace imbibe
