#include "imbibe/coupling/yarn_tube.h"

#include <algorithm>
#include <cmath>

#include "imbibe/core/portable.h"
#include "imbibe/geometry/curve.h"

namespace imbibe {
namespace {

struct Direction {
  Real cosine, sine;
};
const std::array<Direction, tube_sides> corner_directions = [] {
  std::array<Direction, tube_sides> directions;
  for (int k = 0; k < tube_sides; ++k) {
    const Real angle = 2 * pi * k / tube_sides;
    directions[static_cast<std::size_t>(k)] = {portable::cos(angle), portable::sin(angle)};
  }
  return directions;
}();

// A crimped yarn lies in a plane across the other family; a frame beside that plane's normal never twists.
Vec3 plane_normal_of(const YarnNetwork& network, Index yarn) {
  return network.yarn_family[yarn] == Family::weft ? Vec3{0, 1, 0} : Vec3{1, 0, 0};
}

}  // namespace

Vec3 ring_centre(const std::array<Vec3, tube_sides>& ring) {
  Vec3 sum{};
  for (const Vec3& corner : ring) sum += corner;
  return sum / static_cast<Real>(tube_sides);
}

std::array<Vec3, tube_sides> tube_ring(const YarnNetwork& network, Index yarn, Index point) {
  const Index first = network.yarn_first_point[yarn], last = network.yarn_first_point[yarn + 1];
  const std::span<const Vec3> points(network.points.data() + first, last - first);
  const CrossFrame frame = frame_beside(tangent_at(points, point - first), plane_normal_of(network, yarn));
  const Real radius = radius_of_yarn(network, yarn);
  std::array<Vec3, tube_sides> ring;
  for (std::size_t k = 0; k < tube_sides; ++k) {
    const auto [cosine, sine] = corner_directions[k];
    ring[k] = network.points[point] + radius * (cosine * frame.side + sine * frame.up);
  }
  return ring;
}

Real mesh_deviation(const YarnNetwork& network) {
  Real largest = 0;
  for (Index y = 0; y < network.yarn_family.size(); ++y) {
    // Between corners a chord lies inside the circle. At a bend of the centre line the ring stands across the mean
    // direction, so it is narrower by the cosine of half the bend seen along either piece.
    Real least_cosine = 1;
    for (Index i = network.yarn_first_point[y] + 1; i + 1 < network.yarn_first_point[y + 1]; ++i) {
      const Vec3 before = network.points[i] - network.points[i - 1], after = network.points[i + 1] - network.points[i];
      least_cosine = std::min(least_cosine, dot(normalized(before), normalized(after)));
    }
    const Real narrower = std::sqrt((1 + least_cosine) / 2) * portable::cos(pi / tube_sides);
    largest = std::max(largest, radius_of_yarn(network, y) * (1 - narrower));
  }
  return largest;
}

}  // namespace imbibe
