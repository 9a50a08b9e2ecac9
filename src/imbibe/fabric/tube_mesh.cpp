#include "imbibe/fabric/tube_mesh.h"

#include <fmt/format.h>

#include "imbibe/core/portable.h"

namespace imbibe {
namespace {

void check(const YarnNetwork& net, const TubeParams& p) {
  std::vector<Problem> problems;
  if (p.sides < 3) problems.push_back(Problem{"", 0, 0, "sides", fmt::format("{} is below 3", p.sides)});
  if (p.every_point < 1 || net.points_per_segment % p.every_point != 0)
    problems.push_back(Problem{"", 0, 0, "every_point",
                               fmt::format("{} does not divide the {} steps of a segment", p.every_point, net.points_per_segment)});
  if (!problems.empty()) throw InputError(std::move(problems));
}

void append_ring(const YarnNetwork& net, Index yarn, Index point, int sides, TriangleMesh& mesh) {
  const Vec3 along = yarn_direction(net, yarn, point);
  // Normal of the crimp's plane, then the third axis: (side, up, along) is right-handed.
  const Vec3 side = net.yarn_family[yarn] == Family::warp ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 up = cross(along, side);
  const Real radius = net.yarn_types[net.yarn_type[yarn]].radius;
  for (int k = 0; k < sides; ++k) {
    const Real angle = 2 * pi * k / sides;
    mesh.vertices.push_back(net.points[point] + radius * (portable::cos(angle) * side + portable::sin(angle) * up));
  }
}

// The tube over the points first .. last of a yarn.
void append_tube(const YarnNetwork& net, Index yarn, Index first, Index last, const TubeParams& p, TriangleMesh& mesh) {
  const auto base = static_cast<Index>(mesh.vertices.size()), sides = static_cast<Index>(p.sides);
  const Index step = static_cast<Index>(p.every_point), rings = (last - first) / step + 1;
  for (Index r = 0; r < rings; ++r) append_ring(net, yarn, first + r * step, p.sides, mesh);
  for (Index r = 0; r + 1 < rings; ++r)
    for (Index k = 0; k < sides; ++k) {
      const Index a = base + r * sides + k, b = base + r * sides + (k + 1) % sides;
      mesh.triangles.push_back({a, b, b + sides});
      mesh.triangles.push_back({a, b + sides, a + sides});
    }
  if (!p.caps) return;
  const auto cap = [&](Index ring, Index point, bool end) {
    const auto centre = static_cast<Index>(mesh.vertices.size());
    mesh.vertices.push_back(net.points[point]);
    for (Index k = 0; k < sides; ++k) {
      const Index a = base + ring * sides + k, b = base + ring * sides + (k + 1) % sides;
      if (end) mesh.triangles.push_back({centre, a, b});
      else mesh.triangles.push_back({centre, b, a});
    }
  };
  cap(0, first, false);
  cap(rings - 1, last, true);
}

}  // namespace

Vec3 yarn_direction(const YarnNetwork& net, Index yarn, Index point) {
  const Index first = net.yarn_first_point[yarn], last = net.yarn_first_point[yarn + 1] - 1;
  const Index before = point == first ? point : point - 1, after = point == last ? point : point + 1;
  return normalized(net.points[after] - net.points[before]);
}

Real tube_deviation(Real radius, int sides) { return radius * (1 - portable::cos(pi / sides)); }

void append_segment_tube(const YarnNetwork& net, Index segment, const TubeParams& params, TriangleMesh& mesh) {
  check(net, params);
  const Index yarn = net.segment_yarn[segment], steps = static_cast<Index>(net.points_per_segment);
  const Index first = net.yarn_first_point[yarn] + (segment - net.yarn_first_segment[yarn]) * steps;
  append_tube(net, yarn, first, first + steps, params, mesh);
}

void append_yarn_tube(const YarnNetwork& net, Index yarn, const TubeParams& params, TriangleMesh& mesh) {
  check(net, params);
  append_tube(net, yarn, net.yarn_first_point[yarn], net.yarn_first_point[yarn + 1] - 1, params, mesh);
}

TriangleMesh segment_tube(const YarnNetwork& net, Index segment, const TubeParams& params) {
  TriangleMesh mesh;
  append_segment_tube(net, segment, params, mesh);
  return mesh;
}

TriangleMesh yarn_tube(const YarnNetwork& net, Index yarn, const TubeParams& params) {
  TriangleMesh mesh;
  append_yarn_tube(net, yarn, params, mesh);
  return mesh;
}

TriangleMesh fabric_tubes(const YarnNetwork& net, const TubeParams& params) {
  TriangleMesh mesh;
  for (std::size_t yarn = 0; yarn < net.yarn_family.size(); ++yarn)
    append_yarn_tube(net, static_cast<Index>(yarn), params, mesh);
  return mesh;
}

}  // namespace imbibe
