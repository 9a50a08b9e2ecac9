#include <fmt/format.h>

#include <cstring>
#include <fstream>

#include "imbibe/geometry/mesh_file.h"

namespace imbibe {
namespace {

template <class T>
void append(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void append_point(std::string& bytes, const Vec3& v) {
  for (const Real c : {v.x, v.y, v.z}) append(bytes, static_cast<float>(c));
}

std::string obj_text(const TriangleMesh& mesh) {
  std::string text;
  for (const Vec3& v : mesh.vertices) text += fmt::format("v {:.9g} {:.9g} {:.9g}\n", v.x, v.y, v.z);
  for (const auto& t : mesh.triangles) text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return text;
}

std::string ply_bytes(const TriangleMesh& mesh) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
      mesh.vertices.size(), mesh.triangles.size());
  for (const Vec3& v : mesh.vertices) append_point(bytes, v);
  for (const auto& t : mesh.triangles) {
    append(bytes, std::uint8_t{3});
    for (const Index corner : t) append(bytes, corner);
  }
  return bytes;
}

std::string stl_bytes(const TriangleMesh& mesh) {
  std::string bytes(80, '\0');
  append(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    append_point(bytes, triangle_normal(mesh, t));
    for (int k = 0; k < 3; ++k) append_point(bytes, mesh.corner(t, k));
    append(bytes, std::uint16_t{0});
  }
  return bytes;
}

}  // namespace

void write_mesh(const TriangleMesh& mesh, const std::string& path) {
  std::string content;
  if (path.ends_with(".obj")) content = obj_text(mesh);
  else if (path.ends_with(".ply")) content = ply_bytes(mesh);
  else if (path.ends_with(".stl")) content = stl_bytes(mesh);
  else throw InputError(path + ": is not a mesh file: .obj, .ply or .stl");
  std::ofstream file(path, std::ios::binary);
  file.write(content.data(), static_cast<std::streamsize>(content.size()));
  file.close();
  if (!file) throw InputError(path + ": cannot be written");
}

}  // namespace imbibe
