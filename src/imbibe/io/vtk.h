// Files for ParaView and other readers of VTK's XML formats, written without linking VTK.
//   .vtp  PolyData: points with a vertex cell each, or poly-lines, or triangles; point data; binary appended ("raw"), float32/int32
//   .pvd  Collection: which file belongs to which time; rewritten whole, so it is readable at any moment
// Format: "VTK File Formats", The Visualization Toolkit User's Guide, XML section. header_type UInt64, little endian.
// A value that is not finite is never written: the writer throws NumericalError naming the array and the point.
// Tested in tests/io/vtk_test.cpp by reading back with VTK itself (python3-vtk9).
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "imbibe/core/types.h"

namespace imbibe {

// One array of point data: `components` values per point, point-major.
struct PointArray {
  std::string name;
  int components = 1;
  std::variant<std::vector<float>, std::vector<std::int32_t>> values;
};

struct PolyData {
  std::vector<Vec3f> points;
  // Poly-line k joins points [line_start[k], line_start[k+1]). Empty: every point is a vertex cell of its own.
  std::vector<std::int32_t> line_start;
  std::vector<std::array<std::int32_t, 3>> triangles;  // in place of lines and vertices
  std::vector<PointArray> arrays;

  void add(std::string name, std::vector<float> values, int components = 1) {
    arrays.push_back({std::move(name), components, std::move(values)});
  }
  void add(std::string name, std::vector<std::int32_t> values, int components = 1) {
    arrays.push_back({std::move(name), components, std::move(values)});
  }
};

// When and where the data come from: the time goes into the file (field data TimeValue), both into errors.
struct VtkTime {
  Real time_s = 0;
  std::uint64_t step = 0;
};

void write_vtp(const std::filesystem::path& path, const PolyData& data, const VtkTime& when);

struct PvdEntry {
  Real time_s = 0;
  std::string file;  // relative to the .pvd
};

void write_pvd(const std::filesystem::path& path, const std::vector<PvdEntry>& entries);
// The entries of a .pvd written by write_pvd; empty when there is no such file.
std::vector<PvdEntry> read_pvd(const std::filesystem::path& path);

}  // namespace imbibe
