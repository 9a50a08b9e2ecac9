#include "imbibe/scene/document.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <fstream>
#include <optional>
#include <sstream>

namespace imbibe {
namespace {

using Kind = DataNode::Kind;

struct TooLarge {};

// Builds the tree from parser events. A map's children arrive as key, value, key, value.
class TreeBuilder : public YAML::EventHandler {
 public:
  TreeBuilder(std::string file, std::vector<Problem>& problems, const DocumentLimits& limits)
      : file_(std::make_shared<const std::string>(std::move(file))), problems_(problems), limits_(limits) {}

  DataNode root;

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { leaf(mark, anchor, Kind::null, ""); }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    const bool empty = tag != "!" && (value == "~" || value == "null" || value == "Null" || value == "NULL");
    leaf(mark, anchor, empty ? Kind::null : Kind::scalar, value);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto found = anchors_.find(anchor);
    if (found == anchors_.end()) {
      problems_.push_back(problem_at(place(mark), "", "an alias (*name) refers to an anchor that is not finished yet"));
      return leaf(mark, 0, Kind::null, "");
    }
    DataNode copy = found->second;
    count(size_of(copy), mark);
    add(std::move(copy));
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(mark, anchor, Kind::list);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(mark, anchor, Kind::map);
  }
  void OnMapEnd() override { close(); }

 private:
  struct Open {
    DataNode node;
    YAML::anchor_t anchor = 0;
    std::optional<DataNode> key;  // of the value that comes next
  };

  Place place(const YAML::Mark& mark) const { return {file_, mark.line + 1, mark.column + 1}; }

  void count(std::size_t nodes, const YAML::Mark& mark) {
    nodes_ += nodes;
    if (nodes_ <= limits_.nodes) return;
    problems_.push_back(problem_at(place(mark), "", fmt::format("the file holds more than {} values", limits_.nodes)));
    throw TooLarge{};
  }

  static std::size_t size_of(const DataNode& node) {
    std::size_t total = 1;
    for (const DataNode& item : node.items) total += size_of(item);
    return total;
  }

  void leaf(const YAML::Mark& mark, YAML::anchor_t anchor, Kind kind, const std::string& text) {
    count(1, mark);
    DataNode node;
    node.kind = kind;
    node.text = text;
    node.place = place(mark);
    if (anchor != 0) anchors_[anchor] = node;
    add(std::move(node));
  }

  void open(const YAML::Mark& mark, YAML::anchor_t anchor, Kind kind) {
    count(1, mark);
    if (static_cast<int>(open_.size()) >= limits_.depth) {
      problems_.push_back(problem_at(place(mark), "", fmt::format("nested deeper than {} levels", limits_.depth)));
      throw TooLarge{};
    }
    Open o;
    o.node.kind = kind;
    o.node.place = place(mark);
    o.anchor = anchor;
    open_.push_back(std::move(o));
  }

  void close() {
    Open done = std::move(open_.back());
    open_.pop_back();
    if (done.anchor != 0) anchors_[done.anchor] = done.node;
    add(std::move(done.node));
  }

  void add(DataNode node) {
    if (open_.empty()) {
      root = std::move(node);
      return;
    }
    Open& parent = open_.back();
    if (parent.node.kind == Kind::list) {
      parent.node.items.push_back(std::move(node));
    } else if (!parent.key) {
      if (node.kind != Kind::scalar)
        problems_.push_back(problem_at(node.place, "", "a key must be a plain word, not a list, a map or nothing"));
      parent.key = std::move(node);
    } else {
      add_entry(parent, std::move(node));
    }
  }

  void add_entry(Open& parent, DataNode value) {
    DataNode key = std::move(*parent.key);
    parent.key.reset();
    if (key.kind != Kind::scalar) return;
    if (value.kind == Kind::null && value.text.empty()) value.place = key.place;  // the parser's mark is the next token's
    for (std::size_t i = 0; i < parent.node.keys.size(); ++i) {
      if (parent.node.keys[i] != key.text) continue;
      problems_.push_back(problem_at(
          key.place, path_of(key.text),
          fmt::format("duplicate key: it is already given at line {}", parent.node.key_places[i].line)));
      return;
    }
    parent.node.keys.push_back(key.text);
    parent.node.key_places.push_back(key.place);
    parent.node.items.push_back(std::move(value));
  }

  // The dotted path of a key of the innermost open map.
  std::string path_of(const std::string& key) const {
    std::string path;
    for (const Open& level : open_) {
      if (level.node.kind == Kind::list) path += fmt::format("[{}]", level.node.items.size());
      else if (level.key) path += (path.empty() ? "" : ".") + level.key->text;
    }
    return path + (path.empty() ? "" : ".") + key;
  }

  std::shared_ptr<const std::string> file_;
  std::vector<Problem>& problems_;
  const DocumentLimits& limits_;
  std::vector<Open> open_;
  std::map<YAML::anchor_t, DataNode> anchors_;
  std::size_t nodes_ = 0;
};

struct PathStep {
  std::string key;  // or
  std::optional<std::size_t> index;
};

// "a.b[0].c" as steps; empty when it is not such a path.
std::vector<PathStep> path_steps(const std::string& path) {
  std::vector<PathStep> steps;
  std::size_t at = 0;
  while (at < path.size()) {
    const std::size_t end = std::min(path.find_first_of(".[", at), path.size());
    if (end == at) return {};
    steps.push_back({path.substr(at, end - at), std::nullopt});
    at = end;
    while (at < path.size() && path[at] == '[') {
      std::size_t index = 0;
      const auto [stop, code] = std::from_chars(path.data() + at + 1, path.data() + path.size(), index);
      if (code != std::errc{} || stop == path.data() + path.size() || *stop != ']') return {};
      steps.push_back({"", index});
      at = static_cast<std::size_t>(stop - path.data()) + 1;
    }
    if (at == path.size()) break;
    if (path[at] != '.' || at + 1 == path.size()) return {};
    ++at;
  }
  return steps;
}

void merge(DataNode& onto, DataNode from) {
  if (onto.kind != Kind::map || from.kind != Kind::map) {
    onto = std::move(from);
    return;
  }
  onto.place = from.place;
  for (std::size_t i = 0; i < from.items.size(); ++i) {
    if (DataNode* existing = onto.find(from.keys[i])) {
      merge(*existing, std::move(from.items[i]));
      onto.key_places[static_cast<std::size_t>(existing - onto.items.data())] = from.key_places[i];
    } else {
      onto.keys.push_back(from.keys[i]);
      onto.key_places.push_back(from.key_places[i]);
      onto.items.push_back(std::move(from.items[i]));
    }
  }
}

// Removes a key and returns its value with the key's place.
std::optional<DataNode> take(DataNode& map, std::string_view key) {
  for (std::size_t i = 0; i < map.keys.size(); ++i) {
    if (map.keys[i] != key) continue;
    DataNode value = std::move(map.items[i]);
    const auto at = static_cast<std::ptrdiff_t>(i);
    map.items.erase(map.items.begin() + at);
    map.keys.erase(map.keys.begin() + at);
    map.key_places.erase(map.key_places.begin() + at);
    return value;
  }
  return std::nullopt;
}

std::optional<std::string> file_text(const std::filesystem::path& file, const Place& asked_from, const std::string& key,
                                     std::vector<Problem>& problems, const DocumentLimits& limits) {
  const auto fail = [&](const std::string& message) {
    Problem problem = problem_at(asked_from, key, message);
    if (problem.file.empty()) problem.file = file.string();
    problems.push_back(problem);
    return std::nullopt;
  };
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) return fail(fmt::format("there is no file '{}'", file.string()));
  if (std::filesystem::is_directory(status)) return fail(fmt::format("'{}' is a folder, not a file", file.string()));
  std::ifstream in(file, std::ios::binary);
  if (!in) return fail(fmt::format("'{}' cannot be opened for reading", file.string()));
  std::string text;
  char piece[1 << 16];
  while (text.size() <= limits.bytes && (in.read(piece, sizeof piece), in.gcount() > 0))
    text.append(piece, static_cast<std::size_t>(in.gcount()));
  if (text.size() > limits.bytes)
    return fail(fmt::format("'{}' is larger than {} MiB", file.string(), limits.bytes >> 20));
  return text;
}

DataNode read_chain(const std::filesystem::path& file, const Place& asked_from, int depth,
                    std::vector<Problem>& problems, const DocumentLimits& limits);

// Replaces a map that says `extends` or `change` by the base with this map's keys on top, inner maps first.
void resolve_bases(DataNode& node, const std::filesystem::path& file, int depth, std::vector<Problem>& problems,
                   const DocumentLimits& limits) {
  const auto base = node.kind == Kind::map ? take(node, "extends") : std::nullopt;
  const auto change = node.kind == Kind::map ? take(node, "change") : std::nullopt;
  for (DataNode& item : node.items) resolve_bases(item, file, depth, problems, limits);
  if (base) {
    if (base->kind != Kind::scalar || base->text.empty()) {
      problems.push_back(problem_at(base->place, "extends", "wants the name of another file"));
    } else if (depth >= limits.bases) {
      problems.push_back(problem_at(
          base->place, "extends", fmt::format("more than {} files build on each other (or in a circle)", limits.bases)));
    } else {
      const auto path = (file.parent_path() / base->text).lexically_normal();
      DataNode whole = read_chain(path, base->place, depth + 1, problems, limits);
      if (whole.kind == Kind::map) {
        merge(whole, std::move(node));
        node = std::move(whole);
      }
    }
  }
  if (!change) return;
  if (change->kind != Kind::map) {
    problems.push_back(problem_at(change->place, "change", "wants a map of paths to values, e.g. {duration: 1 s}"));
    return;
  }
  for (std::size_t i = 0; i < change->items.size(); ++i)
    set_at_path(node, change->keys[i], change->items[i], change->key_places[i], problems);
}

// Where the first byte stands that is no part of a UTF-8 character, or the text's length. Overlong forms and
// surrogates are not looked for: nothing here depends on them.
std::size_t first_not_utf8(const std::string& text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const std::size_t length = byte < 0x80 ? 1 : byte >> 5 == 0x6 ? 2 : byte >> 4 == 0xE ? 3 : byte >> 3 == 0x1E ? 4 : 0;
    if (length == 0 || i + length > text.size()) return i;
    for (std::size_t k = 1; k < length; ++k)
      if ((static_cast<unsigned char>(text[i + k]) & 0xC0) != 0x80) return i;
    i += length;
  }
  return text.size();
}

DataNode read_chain(const std::filesystem::path& file, const Place& asked_from, int depth,
                    std::vector<Problem>& problems, const DocumentLimits& limits) {
  const auto text = file_text(file, asked_from, depth == 0 ? "" : "extends", problems, limits);
  if (!text) return {};
  DataNode own = parse_document(*text, file.string(), problems, limits);
  resolve_bases(own, file, depth, problems, limits);
  return own;
}

}  // namespace

const DataNode* DataNode::find(std::string_view key) const {
  for (std::size_t i = 0; i < keys.size(); ++i)
    if (keys[i] == key) return &items[i];
  return nullptr;
}

DataNode* DataNode::find(std::string_view key) {
  return const_cast<DataNode*>(static_cast<const DataNode&>(*this).find(key));
}

Problem problem_at(const Place& place, std::string key, std::string message) {
  return {.file = place.file ? *place.file : "", .line = place.line, .column = place.column, .key = std::move(key),
          .message = std::move(message)};
}

DataNode parse_document(const std::string& text, const std::string& file, std::vector<Problem>& problems,
                        const DocumentLimits& limits) {
  const auto name = std::make_shared<const std::string>(file);
  if (text.find('\0') != std::string::npos) {
    problems.push_back(problem_at({name, 0, 0}, "", "is not a text file (it holds zero bytes)"));
    return {};
  }
  if (const std::size_t at = first_not_utf8(text); at < text.size()) {
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    const std::size_t newline = text.rfind('\n', at);
    const std::size_t column = at - (newline == std::string::npos ? 0 : newline + 1) + 1;
    problems.push_back(problem_at({name, static_cast<int>(line), static_cast<int>(column)}, "",
                                  fmt::format("byte 0x{:02X} is not UTF-8: save the file as UTF-8",
                                              static_cast<unsigned char>(text[at]))));
    return {};
  }
  TreeBuilder builder(file, problems, limits);
  try {
    std::istringstream in(text);
    YAML::Parser parser(in);
    if (!parser.HandleNextDocument(builder)) {
      problems.push_back(problem_at({name, 1, 1}, "", "the file is empty"));
      return {};
    }
    DataNode root = std::move(builder.root);
    if (parser.HandleNextDocument(builder))
      problems.push_back(problem_at(builder.root.place, "", "a second document ('---') in one file is not read"));
    return root;
  } catch (const TooLarge&) {
    return {};
  } catch (const YAML::Exception& e) {
    const Place place{name, e.mark.is_null() ? 0 : e.mark.line + 1, e.mark.is_null() ? 0 : e.mark.column + 1};
    problems.push_back(problem_at(place, "", "is not YAML: " + e.msg));
    return {};
  }
}

DataNode read_document(const std::filesystem::path& file, std::vector<Problem>& problems,
                       const DocumentLimits& limits) {
  return read_chain(file, {}, 0, problems, limits);
}

void set_at_path(DataNode& root, const std::string& path, const DataNode& value, const Place& place,
                 std::vector<Problem>& problems) {
  const std::vector<PathStep> steps = path_steps(path);
  if (steps.empty()) {
    problems.push_back(problem_at(place, path, "is not a path of keys, such as textiles[0].warp.density"));
    return;
  }
  DataNode* at = &root;
  for (const PathStep& step : steps) {
    if (step.index) {
      if (*step.index == 0 && at->kind == Kind::null) at->kind = Kind::list;
      if (at->kind == Kind::list && *step.index == at->items.size()) {
        at = &at->items.emplace_back();
        at->place = place;
        continue;
      }
      if (at->kind != Kind::list || *step.index >= at->items.size()) {
        problems.push_back(problem_at(place, path, fmt::format("there is no item [{}]: the list has {}", *step.index,
                                                               at->kind == Kind::list ? at->items.size() : 0)));
        return;
      }
      at = &at->items[*step.index];
      continue;
    }
    if (at->kind == Kind::list) {
      problems.push_back(problem_at(place, path, fmt::format("needs an index [i] before '.{}'", step.key)));
      return;
    }
    if (at->kind != Kind::map) {
      DataNode map;
      map.kind = Kind::map;
      map.place = at->place.file ? at->place : place;
      if (at->kind == Kind::scalar) {  // a short form such as `kind: water` becomes a map that remembers it
        map.keys.push_back(short_form_key);
        map.key_places.push_back(at->place);
        map.items.push_back(*at);
      }
      *at = std::move(map);
    }
    DataNode* child = at->find(step.key);
    if (child == nullptr) {
      at->keys.push_back(step.key);
      at->key_places.push_back(place);
      child = &at->items.emplace_back();
    }
    at = child;
  }
  *at = value;
}

void apply_override(DataNode& root, const std::string& assignment, std::vector<Problem>& problems) {
  const Place place{std::make_shared<const std::string>("--set"), 0, 0};
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) {
    problems.push_back(problem_at(place, "", fmt::format("'{}' is not of the form path=value", assignment)));
    return;
  }
  std::vector<Problem> own;
  DataNode value = parse_document(assignment.substr(equals + 1), "--set", own);
  const std::string path = assignment.substr(0, equals);
  for (Problem& problem : own) {
    problem.line = problem.column = 0;
    problem.key = path;
    problems.push_back(problem);
  }
  if (!own.empty()) return;
  const auto unplace = [&](auto&& self, DataNode& node) -> void {
    node.place = place;
    for (Place& key_place : node.key_places) key_place = place;
    for (DataNode& item : node.items) self(self, item);
  };
  unplace(unplace, value);
  set_at_path(root, path, value, place, problems);
}

}  // namespace imbibe
