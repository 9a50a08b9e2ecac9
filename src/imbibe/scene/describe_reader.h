// Fills any described struct (core/parameter.h) from a DataNode, and collects every problem on the way: unknown keys
// (with the nearest known one), wrong types, wrong units, missing units, values out of range, missing keys. Nothing
// is clamped and nothing falls back to a default in silence: a key that is given is either read or reported.
//
//   ReadLog log;
//   SceneFile f;  read_described(node, "", f, log);   if (!log.problems.empty()) throw InputError(log.problems);
//
// Beside the four members that every description may use, this visitor takes
//   v.short_form("kind")             first in a description: a scalar in place of the map is the value of this key
//   v.unavailable("soft", "...")     after the choices: a key, or the word of a choice, that is known but cannot be used;
//                                    it is reported with this reason
// (call them under `if constexpr (requires { v.short_form(""); })` where other visitors lack them).
//
// A std::string described with the unit "file" is the path of a file, relative to the file that names it.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "imbibe/core/parameter.h"
#include "imbibe/core/types.h"
#include "imbibe/scene/document.h"

namespace imbibe {

// What reading found: problems, and where every key that was given stands (by dotted path, list indices included).
struct ReadLog {
  std::vector<Problem> problems;
  std::map<std::string, Place> places;
};

// The place of `path`, or of the nearest enclosing key that was written in a file.
Place place_of(const std::map<std::string, Place>& places, std::string path);

namespace reading {

bool read_scalar(const DataNode& node, const std::string& path, Real& out, const ParameterInfo& info, ReadLog& log);
bool read_scalar(const DataNode& node, const std::string& path, float& out, const ParameterInfo& info, ReadLog& log);
bool read_scalar(const DataNode& node, const std::string& path, int& out, const ParameterInfo& info, ReadLog& log);
bool read_scalar(const DataNode& node, const std::string& path, std::uint64_t& out, const ParameterInfo& info,
                 ReadLog& log);
bool read_scalar(const DataNode& node, const std::string& path, bool& out, const ParameterInfo& info, ReadLog& log);
bool read_scalar(const DataNode& node, const std::string& path, std::string& out, const ParameterInfo& info,
                 ReadLog& log);
bool wants_list(const DataNode& node, const std::string& path, std::size_t count, ReadLog& log);  // 0: any number
std::size_t chosen(const DataNode& node, const std::string& path, const std::vector<std::string>& words, ReadLog& log);
inline std::string indexed(const std::string& path, std::size_t i) { return path + "[" + std::to_string(i) + "]"; }

template <class T>
void read_any(const DataNode& node, const std::string& path, T& out, const ParameterInfo& info, ReadLog& log) {
  read_scalar(node, path, out, info, log);
}
template <class T, std::size_t N>
void read_any(const DataNode& node, const std::string& path, std::array<T, N>& out, const ParameterInfo& info,
              ReadLog& log) {
  if (!wants_list(node, path, N, log)) return;
  for (std::size_t i = 0; i < N; ++i) read_scalar(node.items[i], indexed(path, i), out[i], info, log);
}
template <class T>
void read_any(const DataNode& node, const std::string& path, Vector3<T>& out, const ParameterInfo& info, ReadLog& log) {
  std::array<T, 3> values{};
  read_any(node, path, values, info, log);
  out = {values[0], values[1], values[2]};
}
// A list of words or numbers; a single scalar is a list of one.
template <class T>
void read_any(const DataNode& node, const std::string& path, std::vector<T>& out, const ParameterInfo& info,
              ReadLog& log) {
  std::vector<T> values;
  if (node.kind == DataNode::Kind::scalar) {
    values.resize(1);
    T value{};
    read_any(node, path, value, info, log);
    values[0] = std::move(value);
  } else {
    if (!wants_list(node, path, 0, log)) return;
    for (std::size_t i = 0; i < node.items.size(); ++i) {
      T value{};
      read_any(node.items[i], indexed(path, i), value, info, log);
      values.push_back(std::move(value));
    }
  }
  out = std::move(values);
}
template <class T>
void read_any(const DataNode& node, const std::string& path, std::optional<T>& out, const ParameterInfo& info,
              ReadLog& log) {
  T value{};
  const std::size_t before = log.problems.size();
  read_any(node, path, value, info, log);
  if (log.problems.size() == before) out = std::move(value);
}

}  // namespace reading

class DescribeReader {
 public:
  DescribeReader(const DataNode& node, std::string path, ReadLog& log);

  template <class T>
  void value(const char* name, T& field, const ParameterInfo& info = {}) {
    if (const DataNode* node = given(name, info.required)) reading::read_any(*node, key_path(name), field, info, log_);
  }

  template <class Enum>
  void choice(const char* name, Enum& field, const Choices<std::type_identity_t<Enum>>& choices, const char* = "") {
    const DataNode* node = given(name, false);
    if (node == nullptr) return;
    std::vector<std::string> words;
    for (const auto& c : choices) words.emplace_back(c.first);
    const std::size_t i = reading::chosen(*node, key_path(name), words, log_);
    if (i < choices.size()) field = choices[i].second;
    else unknown_word_ = node->text, unknown_word_problem_ = log_.problems.size() - 1;
  }

  template <class P>
  void group(const char* name, P& params, const char* = "");
  template <class P>
  void group(const char* name, std::optional<P>& params, const char* help = "") {
    if (node_.find(name) == nullptr) return;
    if (!params) params.emplace();
    group(name, *params, help);
  }

  template <class P>
  void list(const char* name, std::vector<P>& items, const char* = "");

  void short_form(const char* name);
  void unavailable(const char* name, const char* message);

  // Reports the keys that no description asked for.
  void finish();

 private:
  const DataNode* given(const char* name, bool required);
  std::string key_path(const std::string& name) const { return path_.empty() ? name : path_ + "." + name; }

  DataNode node_;
  std::string path_;
  ReadLog& log_;
  bool is_map_ = false;
  std::vector<std::string> known_, unavailable_;
  std::string unknown_word_;  // a choice that was not one of its words
  std::size_t unknown_word_problem_ = 0;
};

template <class P>
void read_described(const DataNode& node, const std::string& path, P& params, ReadLog& log) {
  DescribeReader reader(node, path, log);
  describe(reader, params);
  reader.finish();
}

template <class P>
void DescribeReader::group(const char* name, P& params, const char*) {
  if (const DataNode* node = given(name, false)) read_described(*node, key_path(name), params, log_);
}

template <class P>
void DescribeReader::list(const char* name, std::vector<P>& items, const char*) {
  const DataNode* node = given(name, false);
  if (node == nullptr || !reading::wants_list(*node, key_path(name), 0, log_)) return;
  items.clear();
  for (std::size_t i = 0; i < node->items.size(); ++i) {
    const std::string path = reading::indexed(key_path(name), i);
    log_.places.emplace(path, node->items[i].place);
    P item{};
    read_described(node->items[i], path, item, log_);
    items.push_back(std::move(item));
  }
}

}  // namespace imbibe
