// Reading and writing triangle meshes: OBJ, PLY (ascii, binary little endian), STL (ascii, binary; equal corners welded).
// Polygons are cut into fans. A malformed file is an InputError naming the line (text) or the byte (binary); counts
// are checked against the file's size before memory is taken. Whether the mesh is closed is asked elsewhere
// (triangle_mesh.h).
#pragma once

#include <string>
#include <string_view>

#include "imbibe/geometry/triangle_mesh.h"

namespace imbibe {

// Chooses the format by the file's content (PLY, STL) or its ending (.obj).
TriangleMesh read_mesh(const std::string& path);

// The parsers, on the content of a file; `name` stands in messages.
TriangleMesh parse_obj(std::string_view content, const std::string& name);
TriangleMesh parse_ply(std::string_view content, const std::string& name);
TriangleMesh parse_stl(std::string_view content, const std::string& name);

// A mesh with one texture coordinate per vertex, for a sheet: OBJ only. A mesh without vt, or with a vertex that has two
// of them (a seam), is an InputError.
struct UvMesh {
  TriangleMesh mesh;
  std::vector<std::array<double, 2>> uv;
};
UvMesh read_uv_mesh(const std::string& path);
UvMesh parse_uv_obj(std::string_view content, const std::string& name);

// Chooses the format by the ending: .obj, .ply (binary), .stl (binary). Throws InputError when it cannot be written.
void write_mesh(const TriangleMesh& mesh, const std::string& path);

}  // namespace imbibe
