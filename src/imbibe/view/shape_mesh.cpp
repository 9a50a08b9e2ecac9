#include "imbibe/view/shape_mesh.h"

#include <algorithm>

#include "imbibe/geometry/mesh_distance.h"

namespace imbibe {

namespace {

constexpr int around = 96;  // faces round a circle: at 720p no corner is seen

struct AxisFrame {
  Vec3 a, b;
};
AxisFrame frame_of(const Vec3& axis) {
  const Vec3 other = std::abs(axis.z) < 0.9 ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
  const Vec3 a = normalized(cross(other, axis));
  return {a, cross(axis, a)};
}

Index add_vertex(DrawnMesh& mesh, const Vec3& p, const Vec3& n) {
  mesh.vertices.emplace_back(p);
  mesh.normals.emplace_back(n);
  return static_cast<Index>(mesh.vertices.size() - 1);
}

// A surface of revolution about base + t axis: rows of (radius, height, normal outward, normal upward), bottom to top.
struct Row {
  Real radius, height, normal_out, normal_up;
};
void revolve(DrawnMesh& mesh, const Vec3& base, const Vec3& axis, const std::vector<Row>& rows) {
  const AxisFrame f = frame_of(axis);
  const Index first = static_cast<Index>(mesh.vertices.size()), stride = around + 1;
  for (const Row& row : rows)
    for (int i = 0; i <= around; ++i) {
      const Real angle = 2 * pi * i / around;
      const Vec3 out = std::cos(angle) * f.a + std::sin(angle) * f.b;
      add_vertex(mesh, base + row.radius * out + row.height * axis, normalized(row.normal_out * out + row.normal_up * axis));
    }
  for (Index r = 0; r + 1 < rows.size(); ++r)
    for (Index i = 0; i < around; ++i) {
      const Index a = first + r * stride + i, b = a + 1, c = a + stride, d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
}

DrawnMesh mesh_of_one(const Plane&) { return {}; }

DrawnMesh mesh_of_one(const Box& box) {
  DrawnMesh mesh;
  const Real half[3] = {box.size.x / 2, box.size.y / 2, box.size.z / 2};
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const Real sign : {-1.0, 1.0}) {
      const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
      const Vec3 n = sign * box.axes[axis], middle = box.centre + half[axis] * n;
      const Vec3 du = half[u] * box.axes[u], dv = sign * half[v] * box.axes[v];
      const Index a = add_vertex(mesh, middle - du - dv, n), b = add_vertex(mesh, middle + du - dv, n);
      const Index c = add_vertex(mesh, middle + du + dv, n), d = add_vertex(mesh, middle - du + dv, n);
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  return mesh;
}

DrawnMesh mesh_of_one(const Sphere& sphere) {
  DrawnMesh mesh;
  std::vector<Row> rows;
  for (int i = 0; i <= around / 2; ++i) {
    const Real angle = pi * i / (around / 2) - pi / 2;
    rows.push_back({sphere.radius * std::cos(angle), sphere.radius * std::sin(angle), std::cos(angle), std::sin(angle)});
  }
  revolve(mesh, sphere.centre, {0, 0, 1}, rows);
  return mesh;
}

DrawnMesh mesh_of_one(const Cylinder& c) {
  DrawnMesh mesh;
  revolve(mesh, c.base, c.axis, {{0, 0, 0, -1}, {c.radius, 0, 0, -1}});
  revolve(mesh, c.base, c.axis, {{c.radius, 0, 1, 0}, {c.radius, c.height, 1, 0}});
  revolve(mesh, c.base, c.axis, {{c.radius, c.height, 0, 1}, {0, c.height, 0, 1}});
  return mesh;
}

DrawnMesh mesh_of_one(const Cone& c) {
  DrawnMesh mesh;
  revolve(mesh, c.base, c.axis, {{0, 0, 0, -1}, {c.radius, 0, 0, -1}});
  revolve(mesh, c.base, c.axis, {{c.radius, 0, c.height, c.radius}, {0, c.height, c.height, c.radius}});
  return mesh;
}

DrawnMesh mesh_of_one(const MeshShape& shape) {
  DrawnMesh mesh;
  if (!shape) return mesh;
  for (const Vec3& v : shape->mesh().vertices) mesh.vertices.emplace_back(v);
  mesh.triangles = shape->mesh().triangles;
  return mesh;
}

}  // namespace

DrawnMesh mesh_of(const Shape& shape) {
  return std::visit([](const auto& s) { return mesh_of_one(s); }, shape);
}

}  // namespace imbibe
