// A scene file as plain data: a tree of maps, lists and scalars, each with its place in a file. YAML (and so JSON) by
// yaml-cpp's event interface, because the tree that yaml-cpp builds hides duplicate keys and has no size limits.
//
// In any map:
//   extends: other.yaml       start from that file's map: maps merge key by key, lists and scalars replace
//   change: {a.b[0].c: ...}   then set single keys by their path inside this map, as --set does
//
// Every node keeps the file, line and column it was written at, so an error points at the file that caused it.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "imbibe/core/error.h"

namespace imbibe {

// Where something was written; line and column are 1-based, 0 = unknown (a value from the command line).
struct Place {
  std::shared_ptr<const std::string> file;
  int line = 0;
  int column = 0;
};

struct DataNode {
  enum class Kind { null, scalar, list, map };
  Kind kind = Kind::null;
  std::string text;                // of a scalar
  Place place;
  std::vector<DataNode> items;     // of a list; the values of a map
  std::vector<std::string> keys;   // of a map, as many as items, no duplicates
  std::vector<Place> key_places;

  const DataNode* find(std::string_view key) const;
  DataNode* find(std::string_view key);
};

// Limits against files that would exhaust the machine ("billion laughs", deep nesting).
struct DocumentLimits {
  std::size_t bytes = 16u << 20;
  std::size_t nodes = 200000;
  int depth = 32;
  int bases = 8;
};

// Problems are appended to `problems`; what could be read is returned.
DataNode parse_document(const std::string& text, const std::string& file, std::vector<Problem>& problems,
                        const DocumentLimits& limits = {});

// Reads a file with every `extends` and `change` resolved. Names of files are relative to the file that gives them.
DataNode read_document(const std::filesystem::path& file, std::vector<Problem>& problems,
                       const DocumentLimits& limits = {});

// Applies `a.b[0].c=value` (value in YAML) as from the command line: later overrides earlier.
void apply_override(DataNode& root, const std::string& assignment, std::vector<Problem>& problems);

// Sets the node at a dotted path, making maps on the way; the index one past the end of a list appends.
void set_at_path(DataNode& root, const std::string& path, const DataNode& value, const Place& place,
                 std::vector<Problem>& problems);

Problem problem_at(const Place& place, std::string key, std::string message);

// The key under which a map holds the scalar that stood in its place before one of its keys was set from outside.
inline constexpr const char* short_form_key = "";

}  // namespace imbibe
