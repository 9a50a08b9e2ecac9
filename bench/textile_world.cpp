#include "textile_world.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "imbibe/scene/builder.h"
#include "imbibe/scene/library.h"
#include "imbibe/scene/scene.h"

namespace imbibe::bench {

World world_of(const std::string& text) {
  std::vector<std::string> data;
  if (const char* folder = std::getenv("IMBIBE_DATA_DIR")) data.emplace_back(folder);
  return build_world(read_scene_text(text, "bench.yaml"), read_library(library_folders("bench.yaml", data)));
}

World cloth_world(std::int64_t nodes, const std::string& liquid) {
  const double side = std::sqrt(static_cast<double>(nodes) / 3) / 3000;  // m; 30 yarns per cm, 3 nodes per crossing
  const std::string text = fmt::format(R"(version: 1
title: bench
duration: 1 s
liquid:
  kind: water
{}
textiles:
  - name: cloth
    size: [{:.9g} m, {:.9g} m]
    weave: plain
    warp: {{fibre: cotton, linear_density: 20 tex, density: 30 /cm}}
    weft: {{fibre: cotton, linear_density: 20 tex, density: 30 /cm}}
limits: {{max_particles: 1e8, max_memory: 20 GB, max_disk: 10000 GB}}
)",
                                       liquid.empty() ? "  particle_mass: 0.1 mg" : liquid, side, side);
  return world_of(text);
}

void wet(Textile& textile) {
  const WettingModel& m = *textile.model;
  const Real distance = 20e-3;  // m, of the stains' centres
  const Real radius = 0.4 * distance, greatest = 0.9, power = 1 / (2 + 1 / m.params.yarn_size_index);
  for (std::size_t i = 0; i < m.nodes(); ++i) {
    const Vec3& c = m.centre[i];
    const Real x = std::remainder(c.x, distance), y = std::remainder(c.y, distance);
    const Real inside = 1 - (x * x + y * y) / (radius * radius);
    if (inside <= 0) continue;
    Real s = greatest * std::pow(inside, power);
    if (i >= m.segments) {
      const Real pressure = filling_pressure(m, 0, s).value;
      s = saturation_at({m.entry(i), m.size_index(i), m.open(i), m.overfill(i)}, pressure);
    }
    textile.contents.liquid_kg[i] = s * m.volume(i) * m.liquid.density;
  }
}

}  // namespace imbibe::bench
