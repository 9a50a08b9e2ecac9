#include "imbibe/io/vtk.h"

#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <span>

#include "imbibe/core/error.h"
#include "imbibe/core/output_file.h"

namespace imbibe {

static_assert(std::endian::native == std::endian::little, "the file says LittleEndian");
static_assert(sizeof(Vec3f) == 3 * sizeof(float), "points are written as they lie in memory");

namespace {

// XML first names each block by its offset into the appended data; the blocks follow in the same order, each with its
// length in bytes ahead.
class AppendedBlocks {
 public:
  // Adds a block and returns the DataArray element that names it.
  template <class T>
  std::string element(const std::string& name, std::span<const T> values, int components) {
    const std::string text = fmt::format(
        "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"/>\n",
        std::is_same_v<T, float> ? "Float32" : "Int32", escaped(name), components, offset_);
    blocks_.push_back(std::as_bytes(values));
    offset_ += sizeof(std::uint64_t) + values.size_bytes();
    return text;
  }

  void write_to(OutputFile& file) const {
    for (const std::span<const std::byte>& block : blocks_) {
      const std::uint64_t bytes = block.size();
      file.write(&bytes, sizeof bytes);
      file.write(block.data(), block.size());
    }
  }

  static std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) {
      switch (c) {
        case '&': out += "&amp;"; break;
        case '<': out += "&lt;"; break;
        case '>': out += "&gt;"; break;
        case '"': out += "&quot;"; break;
        default: out += c;
      }
    }
    return out;
  }

 private:
  std::vector<std::span<const std::byte>> blocks_;
  std::uint64_t offset_ = 0;
};

void require_finite(std::span<const float> values, int components, const std::string& array,
                    const std::filesystem::path& path, const VtkTime& when) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) {
      throw NumericalError(when.time_s, when.step, "output",
                           fmt::format("array '{}' of {} is {} at point {}", array, path.filename().string(), values[i],
                                       i / static_cast<std::size_t>(components)));
    }
  }
}

std::span<const float> as_floats(const std::vector<Vec3f>& points) {
  return {reinterpret_cast<const float*>(points.data()), 3 * points.size()};
}

}  // namespace

void write_vtp(const std::filesystem::path& path, const PolyData& data, const VtkTime& when) {
  const std::size_t count = data.points.size();
  require_finite(as_floats(data.points), 3, "points", path, when);
  for (const PointArray& array : data.arrays) {
    const std::size_t expected = count * static_cast<std::size_t>(array.components);
    IMBIBE_ASSERT(std::visit([](const auto& v) { return v.size(); }, array.values) == expected);
    if (const auto* floats = std::get_if<std::vector<float>>(&array.values)) {
      require_finite(*floats, array.components, array.name, path, when);
    }
  }

  const bool triangles = !data.triangles.empty(), lines = !data.line_start.empty() && !triangles;
  const std::size_t cells = triangles ? data.triangles.size() : lines ? data.line_start.size() - 1 : count;
  std::vector<std::int32_t> connectivity(triangles ? 3 * cells : count), ends(cells);
  for (std::size_t i = 0; i < connectivity.size(); ++i)
    connectivity[i] = triangles ? data.triangles[i / 3][i % 3] : static_cast<std::int32_t>(i);
  for (std::size_t i = 0; i < cells; ++i)
    ends[i] = triangles ? static_cast<std::int32_t>(3 * i + 3) : lines ? data.line_start[i + 1] : static_cast<std::int32_t>(i + 1);
  IMBIBE_ASSERT(!lines || (data.line_start.front() == 0 && static_cast<std::size_t>(data.line_start.back()) == count));

  AppendedBlocks blocks;
  std::string text =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>\n";
  text += fmt::format(
      "<FieldData><DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">{}"
      "</DataArray></FieldData>\n",
      when.time_s);
  text += fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\" NumberOfStrips=\"0\""
                      " NumberOfPolys=\"{}\">\n",
                      count, lines || triangles ? 0 : cells, lines ? cells : 0, triangles ? cells : 0);
  text += "<Points>\n" + blocks.element<float>("Points", as_floats(data.points), 3) + "</Points>\n";
  const char* cell_kind = triangles ? "Polys" : lines ? "Lines" : "Verts";
  text += fmt::format("<{}>\n", cell_kind);
  text += blocks.element<std::int32_t>("connectivity", connectivity, 1);
  text += blocks.element<std::int32_t>("offsets", ends, 1);
  text += fmt::format("</{}>\n<PointData>\n", cell_kind);
  for (const PointArray& array : data.arrays) {
    std::visit([&]<class T>(const std::vector<T>& v) { text += blocks.element<T>(array.name, v, array.components); },
               array.values);
  }
  text += "</PointData>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_";

  OutputFile file(path);
  file.write(text);
  blocks.write_to(file);
  file.write("\n</AppendedData>\n</VTKFile>\n");
  file.commit();
}

void write_pvd(const std::filesystem::path& path, const std::vector<PvdEntry>& entries) {
  std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n";
  for (const PvdEntry& entry : entries) {
    text += fmt::format("<DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", entry.time_s,
                        AppendedBlocks::escaped(entry.file));
  }
  write_whole_file(path, text + "</Collection>\n</VTKFile>\n");
}

std::vector<PvdEntry> read_pvd(const std::filesystem::path& path) {
  std::vector<PvdEntry> entries;
  if (!std::filesystem::exists(path)) return entries;
  const std::string text = read_whole_file(path);
  const std::string time_mark = "timestep=\"", file_mark = "file=\"";
  for (std::size_t at = 0; (at = text.find(time_mark, at)) != std::string::npos;) {
    at += time_mark.size();
    PvdEntry entry;
    entry.time_s = std::strtod(text.c_str() + at, nullptr);
    const std::size_t from = text.find(file_mark, at);
    if (from == std::string::npos) break;
    const std::size_t start = from + file_mark.size();
    entry.file = text.substr(start, text.find('"', start) - start);
    entries.push_back(std::move(entry));
    at = start;
  }
  return entries;
}

}  // namespace imbibe
