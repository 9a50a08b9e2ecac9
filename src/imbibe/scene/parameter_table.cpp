#include "imbibe/scene/parameter_table.h"

#include <fmt/format.h>

#include <cctype>
#include <nlohmann/json.hpp>

#include "imbibe/core/quantity.h"

namespace imbibe {
namespace {

using Json = nlohmann::ordered_json;

std::string bound(double si, const ParameterRow& row) {
  if (row.shown == "1" || row.shown == "file") return fmt::format("{:.6g}", si);
  try {
    return format_quantity(si, row.unit, row.shown);
  } catch (const QuantityError&) {  // a unit that the unit library cannot spell, such as kg/(m2 s^0.5)
    return fmt::format("{:.6g} {}", si, row.unit);
  }
}

std::string type_text(const ParameterRow& row) {
  if (row.kind == RowKind::choice) return fmt::format("{}", fmt::join(row.choices, " / "));
  if (row.element == "number" && row.shown != "1") return fmt::format("{} ({})", row.type, row.shown);
  if (row.shown == "file") return "file name";
  return row.type;
}

std::string leaf_name(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  return dot == std::string::npos ? path : path.substr(dot + 1);
}

std::string parent_path(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  return dot == std::string::npos ? "" : path.substr(0, dot);
}

std::string escaped_cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.replace(at, 1, "\\|");
  return text;
}

std::string sentence(std::string text) {
  if (text.empty()) return text;
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text.back() == '.' ? text : text + ".";
}

// The single values directly in the map at `path`, as one table.
std::string markdown_section(const std::vector<ParameterRow>& rows, const std::string& path) {
  std::string text;
  for (const ParameterRow& row : rows) {
    if (row.kind == RowKind::group || row.kind == RowKind::list || parent_path(row.path) != path) continue;
    if (text.empty()) text = "\n| key | type (unit) | range | default | meaning |\n|---|---|---|---|---|\n";
    const std::string fallback = row.required ? "required" : row.fallback.empty() ? "–" : "`" + row.fallback + "`";
    const std::string range = range_text(row);
    text += fmt::format("| `{}` | {} | {} | {} | {}{} |\n", leaf_name(row.path), escaped_cell(type_text(row)),
                        range.empty() ? "–" : range, escaped_cell(fallback), escaped_cell(row.help),
                        row.short_form ? " (may stand in place of the whole map)" : "");
  }
  return text;
}

Json scalar_schema(const ParameterRow& row) {
  if (row.element == "boolean") return {{"type", "boolean"}};
  if (row.element == "text") return {{"type", Json::array({"string", "number", "boolean"})}};
  Json number = {{"type", row.element}};
  if (row.min > -unlimited) number[row.above_min ? "exclusiveMinimum" : "minimum"] = row.min;
  if (row.max < unlimited) number["maximum"] = row.max;
  if (row.element == "integer") return number;
  const Json text = {{"type", "string"}, {"description", "a number with a unit, e.g. in " + row.shown}};
  if (row.unit == "K" || row.unit == "rad") return text;  // a bare number would be ambiguous
  return {{"anyOf", Json::array({number, text})}};
}

Json value_schema(const ParameterRow& row) {
  if (row.kind == RowKind::choice) return {{"enum", row.choices}};
  if (row.length == 1) return scalar_schema(row);
  Json list = {{"type", "array"}, {"items", scalar_schema(row)}};
  if (row.length > 1) list["minItems"] = row.length, list["maxItems"] = row.length;
  if (row.length == 0) return {{"anyOf", Json::array({list, scalar_schema(row)})}};
  return list;
}

// The schema of the map at `path` from the rows below it, which follow it in order from `at`.
Json map_schema(const std::vector<ParameterRow>& rows, const std::string& path, std::size_t& at) {
  Json map = {{"type", "object"}, {"additionalProperties", false}, {"properties", Json::object()}};
  Json properties = Json::object(), required = Json::array();
  Json short_form;
  while (at < rows.size() && parent_path(rows[at].path) == path) {
    const ParameterRow& row = rows[at++];
    Json schema;
    if (row.kind == RowKind::group) schema = map_schema(rows, row.path, at);
    else if (row.kind == RowKind::list) schema = {{"type", "array"}, {"items", map_schema(rows, row.path + "[]", at)}};
    else schema = value_schema(row);
    if (!row.help.empty()) schema["description"] = row.help;
    if (!row.fallback.empty()) schema["default"] = row.fallback;
    if (row.short_form) short_form = schema;
    if (row.required) required.push_back(leaf_name(row.path));
    properties[leaf_name(row.path)] = std::move(schema);
  }
  properties["extends"] = {{"type", "string"}, {"description", "file whose keys this map starts from"}};
  properties["change"] = {{"type", "object"}, {"description", "single keys to change, by their path"}};
  map["properties"] = std::move(properties);
  // A file that is extended may give what is required.
  if (!required.empty()) map["anyOf"] = Json::array({{{"required", required}}, {{"required", Json::array({"extends"})}}});
  if (short_form.is_null()) return map;
  return {{"anyOf", Json::array({short_form, map})}};
}

}  // namespace

std::string range_text(const ParameterRow& row) {
  const bool low = row.min > -unlimited, high = row.max < unlimited;
  if (!low && !high) return "";
  if (!high) return fmt::format("{} {}", row.above_min ? ">" : "≥", bound(row.min, row));
  if (!low) return fmt::format("≤ {}", bound(row.max, row));
  return fmt::format("{}{}, {}]", row.above_min ? "(" : "[", bound(row.min, row), bound(row.max, row));
}

std::string table_text(const std::vector<ParameterRow>& rows) {
  std::string text;
  for (const ParameterRow& row : rows) {
    if (row.kind == RowKind::group || row.kind == RowKind::list) {
      text += fmt::format("\n{}{}  {}\n", row.path, row.kind == RowKind::list ? "[]" : "", row.help);
      continue;
    }
    const std::string state = row.required ? "required" : row.fallback.empty() ? "" : "default " + row.fallback;
    const std::string range = range_text(row);
    text += fmt::format("  {:<44} {}{}{}{}{}\n      {}\n", row.path, type_text(row), range.empty() ? "" : "  ", range,
                        state.empty() ? "" : "  ", state, row.help);
  }
  return text;
}

std::string table_json(const std::vector<ParameterRow>& rows) {
  Json list = Json::array();
  for (const ParameterRow& row : rows) {
    Json item = {{"path", row.path}, {"type", row.type}};
    if (row.kind == RowKind::value) {
      item["unit"] = row.unit;
      item["shown_unit"] = row.shown;
      if (row.min > -unlimited) item["min"] = row.min, item["min_excluded"] = row.above_min;
      if (row.max < unlimited) item["max"] = row.max;
      item["required"] = row.required;
    }
    if (!row.choices.empty()) item["choices"] = row.choices;
    if (!row.fallback.empty()) item["default"] = row.fallback;
    item["help"] = row.help;
    list.push_back(std::move(item));
  }
  return list.dump(2) + "\n";
}

std::string table_markdown(const std::vector<ParameterRow>& rows) {
  std::string text =
      "# Scene parameters\n\n"
      "Every key of a scene file. Generated by `imbibe params --markdown`; do not edit by hand.\n\n"
      "A value with a unit is a text (`20 tex`, `24 /cm`, `50 uL`, `60 deg`); a bare number is SI. Temperatures and "
      "angles always need a unit. `[]` stands for an item of a list; in `--set` and in messages it carries its index, "
      "as in `textiles[0].warp.density`.\n\n"
      "Any map may start from another file: `extends: other.yaml` reads that file's keys first (maps merge key by key, "
      "lists and single values are replaced), and `change: {path: value}` then sets single keys inside lists, such as "
      "`textiles[0].warp.fibre`. Names of files are relative to the file that gives them.\n";
  text += markdown_section(rows, "");
  for (const ParameterRow& row : rows) {
    if (row.kind != RowKind::group && row.kind != RowKind::list) continue;
    const std::string path = row.path + (row.kind == RowKind::list ? "[]" : "");
    text += fmt::format("\n## `{}`\n\n{}\n", path, sentence(row.help)) + markdown_section(rows, path);
  }
  return text;
}

std::string table_schema(const std::vector<ParameterRow>& rows, const std::string& title) {
  std::size_t at = 0;
  Json schema = {{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", title}};
  schema.update(map_schema(rows, "", at));
  return schema.dump(2) + "\n";
}

}  // namespace imbibe
