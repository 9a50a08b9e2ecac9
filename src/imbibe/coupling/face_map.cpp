#include "imbibe/coupling/face_map.h"

#include <numeric>

#include "imbibe/core/portable.h"

namespace imbibe {
namespace {

struct Bounds2 {
  Real x0, y0, x1, y1;
};

Bounds2 bounds_of_nodes(const YarnNetwork& network) {
  Bounds2 b{0, 0, 0, 0};
  for (std::size_t k = 0; k < network.nodes(); ++k) {
    const Vec3& c = network.node_centre(k);
    b = {std::min(b.x0, c.x), std::min(b.y0, c.y), std::max(b.x1, c.x), std::max(b.y1, c.y)};
  }
  return b;
}

// A pore shows the yarns around it: its angle is the mean of the segments that it touches.
void fill_angles(const YarnNetwork& network, FaceMap& map) {
  const std::size_t nodes = network.nodes(), segments = network.segments();
  map.cos_advancing.assign(nodes, 0);
  map.cos_receding.assign(nodes, 0);
  std::vector<int> touching(nodes, 0);
  for (std::size_t s = 0; s < segments; ++s) {
    const Fibre& fibre = network.type_of_segment(s).fibre;
    map.cos_advancing[s] = static_cast<float>(portable::cos(fibre.advancing_angle));
    map.cos_receding[s] = static_cast<float>(portable::cos(fibre.receding_angle));
  }
  for (const Edge& edge : network.edges) {
    if (edge.kind != EdgeKind::segment_pore) continue;
    const Index pore = std::max(edge.a, edge.b), segment = std::min(edge.a, edge.b);
    map.cos_advancing[pore] += map.cos_advancing[segment];
    map.cos_receding[pore] += map.cos_receding[segment];
    ++touching[pore];
  }
  for (std::size_t k = segments; k < nodes; ++k)
    if (touching[k] > 0) map.cos_advancing[k] /= touching[k], map.cos_receding[k] /= touching[k];
}

}  // namespace

FaceMap build_face_map(const YarnNetwork& network, Real particle_spacing) {
  FaceMap map;
  const std::size_t nodes = network.nodes();
  map.reach = 1.5 * std::max({particle_spacing, network.pitch_x, network.pitch_y});
  map.bin = map.reach;
  const Bounds2 b = bounds_of_nodes(network);
  map.x0 = b.x0;
  map.y0 = b.y0;
  map.bins_x = static_cast<int>((b.x1 - b.x0) / map.bin) + 1;
  map.bins_y = static_cast<int>((b.y1 - b.y0) / map.bin) + 1;

  map.on_upper.resize(nodes);
  map.on_lower.resize(nodes);
  for (std::size_t k = 0; k < nodes; ++k)
    map.on_upper[k] = network.on_face(k, true), map.on_lower[k] = network.on_face(k, false);
  const auto has_face = [&](std::size_t k) { return map.on_upper[k] || map.on_lower[k]; };
  std::vector<Index> bin_of(nodes);
  map.first.assign(static_cast<std::size_t>(map.bins_x) * map.bins_y + 1, 0);
  for (std::size_t k = 0; k < nodes; ++k) {
    const Vec3& c = network.node_centre(k);
    const auto i = static_cast<Index>((c.x - map.x0) / map.bin), j = static_cast<Index>((c.y - map.y0) / map.bin);
    bin_of[k] = j * static_cast<Index>(map.bins_x) + i;
    if (has_face(k)) ++map.first[bin_of[k] + 1];
  }
  std::partial_sum(map.first.begin(), map.first.end(), map.first.begin());
  map.nodes.resize(map.first.back());
  std::vector<Index> next(map.first.begin(), map.first.end() - 1);
  for (std::size_t k = 0; k < nodes; ++k)
    if (has_face(k)) {
      const Vec3& c = network.node_centre(k);
      map.nodes[next[bin_of[k]]++] = {c.x, c.y, static_cast<Index>(k), map.on_upper[k], map.on_lower[k]};
    }

  map.face_area.assign(nodes, static_cast<float>(network.pitch_x * network.pitch_y));
  for (std::size_t p = 0; p < network.pores(); ++p)
    map.face_area[network.segments() + p] = static_cast<float>(network.pore_area[p]);
  fill_angles(network, map);
  return map;
}

}  // namespace imbibe
