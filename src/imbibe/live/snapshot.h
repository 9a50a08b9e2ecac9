// What a viewer sees of one instant, small and independent of the World it was taken from: positions in 16 bits,
// saturations in 8. Shared by all viewers, never changed once made.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "imbibe/core/types.h"

namespace imbibe::live {

// A saturation in steps of 1/saturation_scale: half a per cent, up to 1.275 (bulging menisci are above 1). Whatever the
// colour bar shows as liquid is at least one step.
inline constexpr int saturation_scale = 200;
std::uint8_t saturation_byte(Real saturation);

// Points in a box cut into 65535 steps along each side: at most half a step off.
struct QuantisedPoints {
  Vec3f origin{}, step{};           // m: position = origin + step * value
  std::vector<std::uint16_t> xyz;   // three per point
  std::uint16_t every = 1;          // it stands for so many: the others are not shown
  std::size_t size() const { return xyz.size() / 3; }
};
// `point(i)` gives anything with x, y, z.
template <class Point>
QuantisedPoints quantise(std::size_t count, Point&& point) {
  QuantisedPoints q;
  if (count == 0) return q;
  Vec3f low(point(0).x, point(0).y, point(0).z), high = low;
  for (std::size_t i = 0; i < count; ++i) {
    const auto p = point(i);
    low = {std::min(low.x, float(p.x)), std::min(low.y, float(p.y)), std::min(low.z, float(p.z))};
    high = {std::max(high.x, float(p.x)), std::max(high.y, float(p.y)), std::max(high.z, float(p.z))};
  }
  q.origin = low;
  q.step = (high - low) * (1.0f / 65535);
  const Vec3f inverse{q.step.x > 0 ? 1 / q.step.x : 0, q.step.y > 0 ? 1 / q.step.y : 0, q.step.z > 0 ? 1 / q.step.z : 0};
  const auto steps = [](float x) { return static_cast<std::uint16_t>(std::min(std::max(x + 0.5f, 0.0f), 65535.0f)); };
  q.xyz.resize(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto p = point(i);
    q.xyz[3 * i] = steps((float(p.x) - low.x) * inverse.x);
    q.xyz[3 * i + 1] = steps((float(p.y) - low.y) * inverse.y);
    q.xyz[3 * i + 2] = steps((float(p.z) - low.z) * inverse.z);
  }
  return q;
}

// Particles that a frame shows at most; of more every second, third, ... by number, so that frames stay below 200 kB.
inline constexpr std::size_t most_shown_particles = 16000;

using Saturations = std::vector<std::uint8_t>;  // per node of a textile: segments, then pores

struct Snapshot {
  std::uint32_t generation = 0;   // counts the worlds that were built: geometry is that of the scene message
  std::uint32_t number = 0;       // counts the snapshots of a swatch
  std::uint16_t flags = 0;        // see protocol.h
  std::vector<double> values;     // as the columns of the hello message
  std::size_t particle_count = 0;  // of free and hanging liquid; no more than most_shown_particles or so are in `particles`
  std::shared_ptr<const QuantisedPoints> particles;              // kept while the liquid rests
  // Per textile, then per cloth of cells: what its nodes hold, and where its yarns' points or its nodes are.
  std::vector<std::shared_ptr<const Saturations>> saturations;
  std::vector<std::shared_ptr<const QuantisedPoints>> yarns;     // null: it does not move, or its sheet says where
  // Per textile: where the nodes of the soft sheet are that its yarns ride on (Geometry::carried). A fiftieth of the points.
  std::vector<std::shared_ptr<const QuantisedPoints>> sheets;    // null: it has none
};

// Where a point of a yarn rides: on a triangle of the sheet, by the weights of its second and third corner in 65535ths, and
// so far from it along the normal.
struct CarriedPoint {
  std::uint32_t triangle = 0;
  std::uint16_t second = 0, third = 0;
  float height = 0;  // m
};
static_assert(sizeof(CarriedPoint) == 12);

// What does not change while one world runs.
struct Geometry {
  std::uint32_t generation = 0;
  std::string scene_json;                          // the scene message
  std::vector<QuantisedPoints> yarns, pores;       // per textile: centre lines of all yarns; pores
  std::vector<std::vector<std::uint32_t>> sheet_triangles;  // per textile, of the sheet that its yarns ride on; empty: none
  std::vector<std::vector<CarriedPoint>> carried;  // per textile: the points of `yarns`
  std::vector<QuantisedPoints> cloth_nodes;        // per cloth of cells
  std::vector<std::vector<std::uint32_t>> cloth_triangles;
  std::vector<std::vector<float>> cloth_uv;        // m, two per node: where it lies in the flat cloth
  std::vector<std::vector<float>> mesh_vertices;   // per solid, then per prop: three per vertex; empty for plain shapes
  std::vector<std::vector<std::uint32_t>> mesh_triangles;
};

}  // namespace imbibe::live
