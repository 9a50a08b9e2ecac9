// Every parameter of a described struct as rows: the reference page, the JSON list and the JSON Schema are printed
// from these rows, so none of them can name a key that the scene reader does not read.
// Tested in tests/scene/parameter_table_test.cpp.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "imbibe/core/parameter.h"
#include "imbibe/core/types.h"
#include "imbibe/scene/describe_writer.h"

namespace imbibe {

enum class RowKind { value, choice, group, list };

struct ParameterRow {
  RowKind kind = RowKind::value;
  std::string path;          // textiles[].warp.density
  std::string type;          // number, integer, true/false, text, choice, map, list of maps, 3 numbers, ...
  std::string element;       // of a list type: number, integer, text
  int length = 1;            // 1 scalar, 0 any length, n exactly n values
  std::string unit = "1";    // SI
  std::string shown;         // unit on screen
  double min = -unlimited, max = unlimited;
  bool above_min = false, required = false, short_form = false;
  std::string fallback;      // default as it would be written; "" = none
  std::vector<std::string> choices;
  std::string help;
};

namespace table {
template <class T>
struct TypeName;
template <> struct TypeName<Real> { static constexpr const char* name = "number"; };
template <> struct TypeName<float> { static constexpr const char* name = "number"; };
template <> struct TypeName<int> { static constexpr const char* name = "integer"; };
template <> struct TypeName<std::uint64_t> { static constexpr const char* name = "integer"; };
template <> struct TypeName<bool> { static constexpr const char* name = "boolean"; };
template <> struct TypeName<std::string> { static constexpr const char* name = "text"; };

template <class T> struct Shape { using Element = T; static constexpr int length = 1; };
template <class T> struct Shape<std::optional<T>> : Shape<T> {};
template <class T> struct Shape<Vector3<T>> { using Element = T; static constexpr int length = 3; };
template <class T, std::size_t N> struct Shape<std::array<T, N>> {
  using Element = T;
  static constexpr int length = static_cast<int>(N);
};
template <class T> struct Shape<std::vector<T>> { using Element = T; static constexpr int length = 0; };
}  // namespace table

class ParameterTable {
 public:
  explicit ParameterTable(std::string prefix = "") : prefix_(std::move(prefix)) {}

  template <class T>
  void value(const char* name, T& field, const ParameterInfo& info = {}) {
    using Form = table::Shape<T>;
    ParameterRow row;
    row.path = prefix_ + name;
    row.element = table::TypeName<typename Form::Element>::name;
    row.length = Form::length;
    row.type = Form::length == 1   ? row.element
               : Form::length == 0 ? "list of " + row.element + "s"
                                    : std::to_string(Form::length) + " " + row.element + "s";
    row.unit = info.unit;
    row.shown = *info.shown ? info.shown : info.unit;
    row.min = info.min, row.max = info.max, row.above_min = info.above_min, row.required = info.required;
    if (!info.required && !writing::holds_nothing(field)) row.fallback = writing::written(writing::held(field), info);
    row.help = info.help;
    add(std::move(row), name);
  }
  template <class Enum>
  void choice(const char* name, Enum& field, const Choices<std::type_identity_t<Enum>>& choices, const char* help = "") {
    ParameterRow row;
    row.kind = RowKind::choice;
    row.path = prefix_ + name;
    row.type = "choice";
    for (const auto& c : choices) {
      row.choices.emplace_back(c.first);
      if (c.second == field) row.fallback = c.first;
    }
    row.help = help;
    add(std::move(row), name);
  }
  template <class P>
  void group(const char* name, P& params, const char* help = "") {
    header(RowKind::group, name, "map", help);
    ParameterTable inner(prefix_ + name + ".");
    describe(inner, params);
    append(inner);
  }
  template <class P>
  void group(const char* name, std::optional<P>&, const char* help = "") {
    P params{};
    group(name, params, help);
  }
  template <class P>
  void list(const char* name, std::vector<P>&, const char* help = "") {
    header(RowKind::list, name, "list of maps", help);
    P item{};
    ParameterTable inner(prefix_ + name + "[].");
    describe(inner, item);
    append(inner);
  }
  void short_form(const char* name) { short_form_ = name; }

  const std::vector<ParameterRow>& rows() const { return rows_; }

 private:
  void add(ParameterRow row, const char* name) {
    row.short_form = short_form_ == name;
    rows_.push_back(std::move(row));
  }
  void header(RowKind kind, const char* name, const char* type, const char* help) {
    ParameterRow row;
    row.kind = kind;
    row.path = prefix_ + name;
    row.type = type;
    row.help = help;
    rows_.push_back(std::move(row));
  }
  void append(const ParameterTable& inner) { rows_.insert(rows_.end(), inner.rows_.begin(), inner.rows_.end()); }

  std::string prefix_, short_form_;
  std::vector<ParameterRow> rows_;
};

template <class P>
std::vector<ParameterRow> parameter_rows() {
  P params{};
  ParameterTable rows;
  describe(rows, params);
  return rows.rows();
}

// The range as text in the unit on screen, e.g. "(0 mm, 100 mm]"; "" when there is none.
std::string range_text(const ParameterRow& row);

std::string table_text(const std::vector<ParameterRow>& rows);      // for a terminal
std::string table_json(const std::vector<ParameterRow>& rows);      // one object per row
std::string table_markdown(const std::vector<ParameterRow>& rows);  // docs/reference/parameters.md
// JSON Schema (draft 2020-12) that editors use to complete and check scene files.
std::string table_schema(const std::vector<ParameterRow>& rows, const std::string& title);

}  // namespace imbibe
