// OBJ with texture coordinates: geometry by the OBJ reader, then one pass over vt and f.
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>

#include "imbibe/core/output_file.h"
#include "imbibe/geometry/mesh_file.h"

namespace imbibe {
namespace {

[[noreturn]] void fail(const std::string& name, int line, const std::string& message) {
  throw InputError({Problem{.file = name, .line = line, .column = line > 0 ? 1 : 0, .key = {}, .message = message}});
}

// "v/vt/vn" -> vertex and texture numbers, from 0; negative numbers count from the end. No vt: nullopt.
std::optional<std::pair<std::size_t, std::size_t>> corner(std::string_view word, std::size_t vertices,
                                                          std::size_t textures) {
  const auto number = [](std::string_view text, std::size_t count) -> std::optional<std::size_t> {
    long value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (code != std::errc{} || end != text.data() + text.size()) return {};
    const long at = value > 0 ? value - 1 : static_cast<long>(count) + value;
    if (at < 0 || at >= static_cast<long>(count)) return {};
    return static_cast<std::size_t>(at);
  };
  const std::size_t slash = word.find('/');
  if (slash == std::string_view::npos) return {};
  const std::string_view rest = word.substr(slash + 1);
  const auto v = number(word.substr(0, slash), vertices), t = number(rest.substr(0, rest.find('/')), textures);
  if (!v || !t) return {};
  return std::pair{*v, *t};
}

}  // namespace

UvMesh parse_uv_obj(std::string_view content, const std::string& name) {
  UvMesh result;
  result.mesh = parse_obj(content, name);
  std::vector<std::array<double, 2>> textures;
  std::vector<std::size_t> texture_of(result.mesh.vertices.size(), std::size_t(-1));
  std::size_t vertices = 0;
  std::istringstream lines{std::string(content)};
  std::string line;
  for (int row = 1; std::getline(lines, line); ++row) {
    std::istringstream words(line);
    std::string kind, word;
    words >> kind;
    if (kind == "v") ++vertices;
    if (kind == "vt") {
      std::array<double, 2> uv{};
      if (!(words >> uv[0] >> uv[1]) || !std::isfinite(uv[0]) || !std::isfinite(uv[1]))
        fail(name, row, "a texture coordinate wants two numbers");
      textures.push_back(uv);
    }
    if (kind != "f") continue;
    while (words >> word) {
      const auto pair = corner(word, vertices, textures.size());
      if (!pair)
        fail(name, row, fmt::format("the corner '{}' has no texture coordinate (vt): a soft sheet needs UV, which say "
                                    "where each vertex lies in the cloth", word));
      std::size_t& own = texture_of[pair->first];
      if (own != std::size_t(-1) && textures[own] != textures[pair->second])
        fail(name, row, fmt::format("vertex {} has two texture coordinates (a seam): cut the sheet there, a vertex on each side",
                                    pair->first + 1));
      own = pair->second;
    }
  }
  result.uv.assign(result.mesh.vertices.size(), {0, 0});
  for (std::size_t v = 0; v < texture_of.size(); ++v) {
    if (texture_of[v] == std::size_t(-1)) fail(name, 0, fmt::format("vertex {} belongs to no face", v + 1));
    result.uv[v] = textures[texture_of[v]];
  }
  return result;
}

UvMesh read_uv_mesh(const std::string& path) {
  if (path.size() < 4 || path.substr(path.size() - 4) != ".obj")
    throw InputError({Problem{.file = path, .message = "a soft sheet's mesh is an OBJ file with texture coordinates"}});
  return parse_uv_obj(read_whole_file(path), path);
}

}  // namespace imbibe
