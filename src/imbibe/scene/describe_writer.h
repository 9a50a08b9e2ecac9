// Writes any described struct (core/parameter.h) as YAML that reads back to the same bits: a value is shown in its
// screen unit where that is exact, in SI otherwise. Keys that hold nothing (unset optionals, empty lists) are left out.
// Tested in tests/scene/describe_writer_test.cpp.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "imbibe/core/parameter.h"
#include "imbibe/core/types.h"

namespace imbibe {

namespace writing {

std::string written(Real value, const ParameterInfo& info);
std::string written(float value, const ParameterInfo& info);
std::string written(int value, const ParameterInfo& info);
std::string written(std::uint64_t value, const ParameterInfo& info);
std::string written(bool value, const ParameterInfo& info);
std::string written(const std::string& value, const ParameterInfo& info);
std::string flow_list(const std::vector<std::string>& items);

template <class T>
std::string written(const Vector3<T>& v, const ParameterInfo& info) {
  return flow_list({written(v.x, info), written(v.y, info), written(v.z, info)});
}
template <class T, std::size_t N>
std::string written(const std::array<T, N>& values, const ParameterInfo& info) {
  std::vector<std::string> items;
  for (const T& value : values) items.push_back(written(value, info));
  return flow_list(items);
}
template <class T>
std::string written(const std::vector<T>& values, const ParameterInfo& info) {
  std::vector<std::string> items;
  for (const T& value : values) items.push_back(written(value, info));
  return flow_list(items);
}

template <class T>
bool holds_nothing(const T&) { return false; }
template <class T>
bool holds_nothing(const std::optional<T>& value) { return !value; }
template <class T>
bool holds_nothing(const std::vector<T>& value) { return value.empty(); }
inline bool holds_nothing(const std::string& value) { return value.empty(); }

template <class T>
const T& held(const T& value) { return value; }
template <class T>
const T& held(const std::optional<T>& value) { return *value; }

}  // namespace writing

class DescribeWriter {
 public:
  explicit DescribeWriter(int indent = 0) : indent_(indent) {}

  template <class T>
  void value(const char* name, T& field, const ParameterInfo& info = {}) {
    if (!writing::holds_nothing(field)) line(name, writing::written(writing::held(field), info));
  }
  template <class Enum>
  void choice(const char* name, Enum& field, const Choices<std::type_identity_t<Enum>>& choices, const char* = "") {
    for (const auto& c : choices)
      if (c.second == field) return line(name, c.first);
  }
  template <class P>
  void group(const char* name, P& params, const char* = "") {
    DescribeWriter inner(indent_ + 2);
    describe(inner, params);
    if (!inner.text_.empty()) line(name, ""), text_ += inner.text_;
  }
  template <class P>
  void group(const char* name, std::optional<P>& params, const char* help = "") {
    if (params) group(name, *params, help);
  }
  template <class P>
  void list(const char* name, std::vector<P>& items, const char* = "") {
    if (items.empty()) return;
    line(name, "");
    for (P& item : items) {
      DescribeWriter inner(indent_ + 4);
      describe(inner, item);
      if (inner.text_.empty()) inner.text_ = std::string(static_cast<std::size_t>(indent_) + 4, ' ') + "{}\n";
      inner.text_[static_cast<std::size_t>(indent_) + 2] = '-';
      text_ += inner.text_;
    }
  }

  const std::string& text() const { return text_; }

 private:
  void line(const char* name, const std::string& value);

  int indent_;
  std::string text_;
};

// describe() takes its struct by non-const reference for all visitors; the writer only reads, from a copy.
template <class P>
std::string write_described(P params) {
  DescribeWriter writer;
  describe(writer, params);
  return writer.text();
}

}  // namespace imbibe
