#include "imbibe/geometry/mesh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cctype>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "imbibe/core/output_file.h"

namespace imbibe {

static_assert(std::endian::native == std::endian::little, "binary mesh files are read as they lie in memory");

namespace {

constexpr std::size_t most_bytes = std::size_t{1} << 30;  // of a file: some 20 million triangles
constexpr std::size_t most_corners = 1024;  // of one polygon; more is a damaged file

[[noreturn]] void fail(const std::string& name, int line, std::string message) {
  throw InputError({Problem{.file = name, .line = line, .column = line > 0 ? 1 : 0, .key = {},
                            .message = std::move(message)}});
}

// Walks over a text file line by line and word by word.
class Lines {
 public:
  Lines(std::string_view content, const std::string& name) : rest_(content), name_(name) {}

  bool next_line() {
    if (rest_.empty()) return false;
    const std::size_t end = rest_.find('\n');
    line_ = rest_.substr(0, end);
    rest_ = end == std::string_view::npos ? std::string_view{} : rest_.substr(end + 1);
    ++number_;
    return true;
  }
  std::string_view word() {
    const std::size_t begin = line_.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return line_ = {};
    line_ = line_.substr(begin);
    const std::size_t end = std::min(line_.find_first_of(" \t\r"), line_.size());
    const std::string_view found = line_.substr(0, end);
    line_ = line_.substr(end);
    return found;
  }
  template <class Number>
  Number number(const char* what) {
    const std::string_view text = word();
    Number value{};
    const char* begin = text.data() + (!text.empty() && text[0] == '+');
    const auto [end, code] = std::from_chars(begin, text.data() + text.size(), value);
    if (text.empty()) stop(fmt::format("{} is missing", what));
    if (code != std::errc{} || end != text.data() + text.size()) stop(fmt::format("'{}' is not {}", text, what));
    return value;
  }
  Vec3 point() {
    const Real x = number<Real>("a coordinate"), y = number<Real>("a coordinate"), z = number<Real>("a coordinate");
    if (!is_finite(Vec3{x, y, z})) stop("a coordinate is not a finite number");
    return {x, y, z};
  }
  [[noreturn]] void stop(std::string message) const { fail(name_, number_, std::move(message)); }
  std::string_view rest() const { return rest_; }
  int line_number() const { return number_; }

 private:
  std::string_view rest_, line_;
  const std::string& name_;
  int number_ = 0;
};

void add_fan(TriangleMesh& mesh, const std::vector<Index>& polygon) {
  for (std::size_t k = 2; k < polygon.size(); ++k) mesh.triangles.push_back({polygon[0], polygon[k - 1], polygon[k]});
}

// --- STL: corners without indices, welded where their coordinates are equal -----------------------------------------

void weld(TriangleMesh& mesh) {
  std::vector<Index> order(mesh.vertices.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<Index>(i);
  const auto less = [&](Index a, Index b) {
    const Vec3 &p = mesh.vertices[a], &q = mesh.vertices[b];
    if (p.x != q.x) return p.x < q.x;
    if (p.y != q.y) return p.y < q.y;
    return p.z != q.z ? p.z < q.z : a < b;
  };
  std::sort(order.begin(), order.end(), less);
  std::vector<Index> first(order.size());  // the lowest corner at the same place
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && mesh.vertices[order[i]] == mesh.vertices[order[i - 1]];
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  std::vector<Index> number(order.size());
  std::vector<Vec3> welded;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (first[i] == i) number[i] = static_cast<Index>(welded.size()), welded.push_back(mesh.vertices[i]);
  }
  for (auto& t : mesh.triangles) {
    for (Index& corner : t) corner = number[first[corner]];
  }
  mesh.vertices = std::move(welded);
}

constexpr std::size_t stl_header = 84, stl_record = 50;

TriangleMesh parse_stl_binary(std::string_view content, const std::string& name, std::uint32_t count) {
  TriangleMesh mesh;
  mesh.vertices.reserve(3 * std::size_t{count});
  mesh.triangles.reserve(count);
  for (std::size_t t = 0; t < count; ++t) {
    float corners[9];
    std::memcpy(corners, content.data() + stl_header + t * stl_record + 12, sizeof corners);
    const Index first = static_cast<Index>(mesh.vertices.size());
    for (int k = 0; k < 3; ++k) {
      const Vec3 v{corners[3 * k], corners[3 * k + 1], corners[3 * k + 2]};
      if (!is_finite(v)) fail(name, 0, fmt::format("triangle {} has a coordinate that is not finite", t + 1));
      mesh.vertices.push_back(v);
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

TriangleMesh parse_stl_ascii(std::string_view content, const std::string& name) {
  TriangleMesh mesh;
  Lines lines(content, name);
  std::vector<Index> polygon;
  bool ended = false;
  while (lines.next_line()) {
    const std::string_view key = lines.word();
    if (key == "vertex") {
      polygon.push_back(static_cast<Index>(mesh.vertices.size()));
      mesh.vertices.push_back(lines.point());
    } else if (key == "endloop") {
      if (polygon.size() != 3) lines.stop(fmt::format("a facet has {} corners instead of 3", polygon.size()));
      add_fan(mesh, polygon);
      polygon.clear();
    } else if (key == "endsolid") {
      ended = true;
    } else if (key == "solid") {
      ended = false;
    } else if (!key.empty() && key != "facet" && key != "outer" && key != "endfacet") {
      lines.stop(fmt::format("'{}' is not a keyword of an STL file", key));
    }
  }
  if (!ended || !polygon.empty()) lines.stop("the file ends before 'endsolid'");
  return mesh;
}

// --- PLY --------------------------------------------------------------------------------------------------------------

enum class PlyType { i8, u8, i16, u16, i32, u32, f32, f64 };

std::size_t size_of(PlyType type) {
  switch (type) {
    case PlyType::i8: case PlyType::u8: return 1;
    case PlyType::i16: case PlyType::u16: return 2;
    case PlyType::i32: case PlyType::u32: case PlyType::f32: return 4;
    case PlyType::f64: break;
  }
  return 8;
}

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::f32;
  bool list = false;
  PlyType count_type = PlyType::u8;
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  bool binary = false;
  std::vector<PlyElement> elements;
};

PlyType ply_type(Lines& lines) {
  static constexpr std::pair<std::string_view, PlyType> names[] = {
      {"char", PlyType::i8},    {"int8", PlyType::i8},     {"uchar", PlyType::u8},  {"uint8", PlyType::u8},
      {"short", PlyType::i16},  {"int16", PlyType::i16},   {"ushort", PlyType::u16}, {"uint16", PlyType::u16},
      {"int", PlyType::i32},    {"int32", PlyType::i32},   {"uint", PlyType::u32},  {"uint32", PlyType::u32},
      {"float", PlyType::f32},  {"float32", PlyType::f32}, {"double", PlyType::f64}, {"float64", PlyType::f64}};
  const std::string_view word = lines.word();
  for (const auto& [name, type] : names) {
    if (name == word) return type;
  }
  lines.stop(fmt::format("'{}' is not a type of a PLY file", word));
}

PlyHeader parse_ply_header(Lines& lines) {
  PlyHeader header;
  bool formatted = false;
  lines.next_line();  // "ply"
  while (lines.next_line()) {
    const std::string_view key = lines.word();
    if (key == "end_header") {
      if (!formatted) lines.stop("the header has no 'format' line");
      return header;
    }
    if (key == "format") {
      const std::string_view format = lines.word();
      if (format != "ascii" && format != "binary_little_endian") {
        lines.stop(fmt::format("format '{}' is not supported: ascii or binary_little_endian", format));
      }
      header.binary = format != "ascii";
      formatted = true;
    } else if (key == "element") {
      PlyElement element;
      element.name = lines.word();
      element.count = lines.number<std::uint64_t>("a count");
      header.elements.push_back(std::move(element));
    } else if (key == "property") {
      if (header.elements.empty()) lines.stop("a property comes before any element");
      PlyProperty property;
      Lines ahead = lines;
      if (ahead.word() == "list") {
        lines.word();
        property.list = true;
        property.count_type = ply_type(lines);
        if (property.count_type >= PlyType::f32) lines.stop("the length of a list must be an integer");
      }
      property.type = ply_type(lines);
      property.name = lines.word();
      header.elements.back().properties.push_back(std::move(property));
    } else if (!key.empty() && key != "comment" && key != "obj_info") {
      lines.stop(fmt::format("'{}' is not a keyword of a PLY header", key));
    }
  }
  lines.stop("the file ends inside its header");
}

// Reads one value after another, whatever the encoding.
class PlyValues {
 public:
  PlyValues(Lines& lines, bool binary, const std::string& name) : lines_(lines), binary_(binary), name_(name) {
    if (binary) bytes_ = lines.rest();
  }
  void begin_item() {
    if (binary_) return;
    do {
      if (!lines_.next_line()) lines_.stop("the file ends before all elements are read");
      const Lines ahead = lines_;
      if (!Lines(ahead).word().empty()) return;
    } while (true);
  }
  Real value(PlyType type) {
    if (!binary_) return lines_.number<Real>("a number");
    const std::size_t size = size_of(type);
    if (bytes_.size() < size) fail(name_, 0, "the file ends before all elements are read");
    const char* at = bytes_.data();
    bytes_ = bytes_.substr(size);
    switch (type) {
      case PlyType::i8: return load<std::int8_t>(at);
      case PlyType::u8: return load<std::uint8_t>(at);
      case PlyType::i16: return load<std::int16_t>(at);
      case PlyType::u16: return load<std::uint16_t>(at);
      case PlyType::i32: return load<std::int32_t>(at);
      case PlyType::u32: return load<std::uint32_t>(at);
      case PlyType::f32: return static_cast<Real>(load<float>(at));
      case PlyType::f64: break;
    }
    return load<double>(at);
  }
  // The least that one item can take: what a count may be checked against.
  std::size_t least_size(const PlyElement& element) const {
    std::size_t size = 0;
    for (const PlyProperty& p : element.properties) size += binary_ ? size_of(p.list ? p.count_type : p.type) : 2;
    return std::max<std::size_t>(size, 1);
  }
  std::size_t bytes_left() const { return binary_ ? bytes_.size() : lines_.rest().size() + 1; }
  [[noreturn]] void stop(std::string message) const {
    fail(name_, binary_ ? 0 : lines_.line_number(), std::move(message));
  }

 private:
  template <class T>
  static T load(const char* at) {
    T value;
    std::memcpy(&value, at, sizeof value);
    return value;
  }
  Lines& lines_;
  std::string_view bytes_;
  bool binary_;
  const std::string& name_;
};

void read_ply_vertices(PlyValues& values, const PlyElement& element, TriangleMesh& mesh) {
  int seen = 0;
  for (const PlyProperty& p : element.properties) seen += p.name == "x" || p.name == "y" || p.name == "z";
  if (seen != 3) values.stop("vertices must have the properties x, y and z");
  mesh.vertices.reserve(element.count);
  for (std::uint64_t i = 0; i < element.count; ++i) {
    Vec3 v;
    values.begin_item();
    for (const PlyProperty& p : element.properties) {
      if (p.list) values.stop("a vertex must not have a list");
      const Real value = values.value(p.type);
      if (p.name == "x") v.x = value;
      if (p.name == "y") v.y = value;
      if (p.name == "z") v.z = value;
    }
    if (!is_finite(v)) values.stop(fmt::format("vertex {} has a coordinate that is not a finite number", i + 1));
    mesh.vertices.push_back(v);
  }
}

void read_ply_faces(PlyValues& values, const PlyElement& element, std::uint64_t vertices, TriangleMesh& mesh) {
  mesh.triangles.reserve(element.count);
  std::vector<Index> polygon;
  for (std::uint64_t i = 0; i < element.count; ++i) {
    values.begin_item();
    for (const PlyProperty& p : element.properties) {
      const bool corners = p.list && (p.name == "vertex_indices" || p.name == "vertex_index");
      const Real length = p.list ? values.value(p.count_type) : 1;
      if (!(length >= 0 && length <= static_cast<Real>(most_corners) && length == std::floor(length)) ||
          (corners && length < 3)) {
        values.stop(fmt::format("face {} has {} corners", i + 1, length));
      }
      polygon.clear();
      for (int k = 0; k < static_cast<int>(length); ++k) {
        const Real corner = values.value(p.type);
        if (!corners) continue;
        if (!(corner >= 0 && corner < static_cast<Real>(vertices) && corner == std::floor(corner))) {
          values.stop(fmt::format("face {} names vertex {}, but there are {}", i + 1, corner, vertices));
        }
        polygon.push_back(static_cast<Index>(corner));
      }
      if (corners) add_fan(mesh, polygon);
    }
  }
}

void skip_ply_element(PlyValues& values, const PlyElement& element) {
  for (std::uint64_t i = 0; i < element.count; ++i) {
    values.begin_item();
    for (const PlyProperty& p : element.properties) {
      const Real length = p.list ? values.value(p.count_type) : 1;
      for (Real k = 0; k < length; ++k) values.value(p.type);
    }
  }
}

// --- OBJ --------------------------------------------------------------------------------------------------------------

// The vertex of a face's corner "7", "7/1", "7//3", "7/1/3" or "-1": 1-based, negative counts back from the last.
Index obj_corner(const Lines& lines, std::string_view word, std::size_t vertices) {
  const std::string_view digits = word.substr(0, word.find('/'));
  long long number = 0;
  const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (code != std::errc{} || end != digits.data() + digits.size()) {
    lines.stop(fmt::format("'{}' is not a vertex number", word));
  }
  const auto known = static_cast<long long>(vertices);
  if (number < 0) number += known + 1;
  if (number < 1 || number > known) lines.stop(fmt::format("'{}' names no vertex: there are {} so far", word, known));
  return static_cast<Index>(number - 1);
}

std::string read_whole(const std::string& path) {
  std::error_code code;  // neither a folder nor a device, which may have no end
  if (std::ifstream(path) && std::filesystem::is_regular_file(path, code)) return read_whole_file(path, most_bytes);
  fail(path, 0, "cannot be read: is it there, and a file?");
}

bool ends_with(std::string path, std::string_view ending) {
  std::transform(path.begin(), path.end(), path.begin(), [](unsigned char c) { return std::tolower(c); });
  return std::string_view(path).ends_with(ending);
}

}  // namespace

TriangleMesh parse_obj(std::string_view content, const std::string& name) {
  TriangleMesh mesh;
  Lines lines(content, name);
  std::vector<Index> polygon;
  while (lines.next_line()) {
    const std::string_view key = lines.word();
    if (key == "v") {
      mesh.vertices.push_back(lines.point());
    } else if (key == "f") {
      polygon.clear();
      for (std::string_view word = lines.word(); !word.empty() && word[0] != '#'; word = lines.word()) {
        polygon.push_back(obj_corner(lines, word, mesh.vertices.size()));
      }
      if (polygon.size() < 3) lines.stop(fmt::format("a face has {} corners; at least 3 are needed", polygon.size()));
      add_fan(mesh, polygon);
    }  // texture, normals, groups and materials say nothing about the solid
  }
  if (mesh.triangles.empty()) fail(name, 0, "the file holds no face");
  return mesh;
}

TriangleMesh parse_stl(std::string_view content, const std::string& name) {
  // Binary files may begin with "solid" too: the size, which the count foretells, decides.
  std::uint32_t count = 0;
  if (content.size() >= stl_header) std::memcpy(&count, content.data() + 80, 4);
  const bool fits = content.size() >= stl_header && content.size() == stl_header + stl_record * std::size_t{count};
  TriangleMesh mesh;
  if (fits) {
    mesh = parse_stl_binary(content, name, count);
  } else if (content.starts_with("solid")) {
    mesh = parse_stl_ascii(content, name);
  } else {
    fail(name, 0, fmt::format("neither an ascii STL file (no 'solid') nor a binary one: {} bytes, but {} triangles "
                              "would take {}", content.size(), count, stl_header + stl_record * std::size_t{count}));
  }
  if (mesh.triangles.empty()) fail(name, 0, "the file holds no triangle");
  weld(mesh);
  return mesh;
}

TriangleMesh parse_ply(std::string_view content, const std::string& name) {
  Lines lines(content, name);
  const PlyHeader header = parse_ply_header(lines);
  PlyValues values(lines, header.binary, name);
  std::uint64_t vertices = 0;
  for (const PlyElement& e : header.elements) vertices = e.name == "vertex" ? e.count : vertices;
  TriangleMesh mesh;
  for (const PlyElement& element : header.elements) {
    if (element.count > values.bytes_left() / values.least_size(element) || element.count >= no_index) {
      values.stop(fmt::format("{} elements '{}' cannot fit in the {} bytes that are left", element.count, element.name,
                              values.bytes_left()));
    }
    if (element.name == "vertex") {
      read_ply_vertices(values, element, mesh);
    } else if (element.name == "face") {
      read_ply_faces(values, element, vertices, mesh);
    } else {
      skip_ply_element(values, element);
    }
  }
  if (mesh.triangles.empty()) fail(name, 0, "the file holds no face");
  return mesh;
}

TriangleMesh read_mesh(const std::string& path) {
  const std::string content = read_whole(path);
  if (content.starts_with("ply\n") || content.starts_with("ply\r")) return parse_ply(content, path);
  if (ends_with(path, ".obj")) return parse_obj(content, path);
  if (ends_with(path, ".stl")) return parse_stl(content, path);
  fail(path, 0, "is not a mesh file: .obj, .ply or .stl");
}

}  // namespace imbibe
