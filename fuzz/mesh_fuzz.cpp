// OBJ, PLY and STL: the first byte says which; a small closed mesh is then used as a solid.
#include "fuzz.h"
#include "imbibe/geometry/mesh_distance.h"
#include "imbibe/geometry/mesh_file.h"

using namespace imbibe;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string content = fuzz::text_of(data + 1, size - 1);
  fuzz::reads([&] {
    const TriangleMesh mesh = data[0] == 'o' ? parse_obj(content, "fuzz.obj")
                            : data[0] == 'p' ? parse_ply(content, "fuzz.ply")
                                             : parse_stl(content, "fuzz.stl");
    IMBIBE_ASSERT(!mesh.triangles.empty());
    for (const Vec3& v : mesh.vertices) IMBIBE_ASSERT(is_finite(v));
    for (const auto& triangle : mesh.triangles)
      for (const Index corner : triangle) IMBIBE_ASSERT(corner < mesh.vertices.size());
    if (mesh.triangles.size() > 500) return;
    const MeshDistance solid(mesh, "fuzz");
    for (const Vec3& point : {Vec3{0, 0, 0}, mesh.vertices[0], Vec3{1, 2, 3}}) solid.nearest(point);
  });
  return 0;
}
