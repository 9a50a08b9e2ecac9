#include "imbibe/scene/describe_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "imbibe/core/quantity.h"

namespace imbibe {
namespace writing {
namespace {

// The shortest number in `unit` that reads back to exactly `value`, or "" when there is none.
std::string exact_in_unit(Real value, const ParameterInfo& info, const std::string& unit) {
  try {
    const Real in_unit = convert_from_si(value, info.unit, unit);
    for (int digits = 1; digits <= 12; ++digits) {
      const Real rounded = std::stod(fmt::format("{:.{}g}", in_unit, digits));
      std::string text = fmt::format("{} {}", rounded, unit);
      if (parse_quantity(text, info.unit) == value) return text;
    }
  } catch (const QuantityError&) {
  }
  return "";
}

bool plain_word(const std::string& text) {
  if (text.empty() || !std::isalpha(static_cast<unsigned char>(text[0])) || text.back() == ' ') return false;
  for (const char c : text)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_' && c != ' ' && c != '/' && c != '.' && c != '-')
      return false;
  std::string word = text;
  std::transform(word.begin(), word.end(), word.begin(), [](unsigned char c) { return std::tolower(c); });
  for (const char* reserved : {"true", "false", "yes", "no", "on", "off", "null", "nan", "inf", "y", "n"})
    if (word == reserved) return false;
  return true;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\', out += c;
    else if (c == '\n') out += "\\n";
    else if (c == '\t') out += "\\t";
    else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) out += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    else out += c;
  }
  return out + "\"";
}

}  // namespace

std::string written(Real value, const ParameterInfo& info) {
  const std::string unit = *info.shown ? info.shown : info.unit;
  if (unit != "1") {
    std::string text = exact_in_unit(value, info, unit);
    if (text.empty() && unit != info.unit) text = exact_in_unit(value, info, info.unit);
    if (!text.empty()) return text;
  }
  const std::string number = fmt::format("{}", value);  // shortest that reads back to the same bits
  const std::string_view si = info.unit;
  return si == "K" || si == "rad" ? fmt::format("{} {}", number, si) : number;
}
std::string written(float value, const ParameterInfo& info) { return written(static_cast<Real>(value), info); }
std::string written(int value, const ParameterInfo&) { return std::to_string(value); }
std::string written(std::uint64_t value, const ParameterInfo&) { return std::to_string(value); }
std::string written(bool value, const ParameterInfo&) { return value ? "true" : "false"; }
std::string written(const std::string& value, const ParameterInfo&) {
  return plain_word(value) ? value : quoted(value);
}
std::string flow_list(const std::vector<std::string>& items) { return fmt::format("[{}]", fmt::join(items, ", ")); }

}  // namespace writing

void DescribeWriter::line(const char* name, const std::string& value) {
  text_ += fmt::format("{}{}:{}{}\n", std::string(static_cast<std::size_t>(indent_), ' '), name,
                       value.empty() ? "" : " ", value);
}

}  // namespace imbibe
