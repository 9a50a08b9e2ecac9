// What of a World goes into its .vtp files.
#include <algorithm>

#include "imbibe/core/error.h"
#include "imbibe/io/run_folder.h"
#include "imbibe/sim/measures.h"

namespace imbibe {
namespace {

constexpr std::int32_t hanging_class = 3;

}  // namespace

PolyData liquid_poly_data(const Liquid& liquid, std::span<const Vec3> hanging) {
  const Particles& particles = liquid.particles;
  const std::size_t free = particles.size(), count = free + hanging.size();
  PolyData data;
  data.points.reserve(count);
  std::vector<float> velocity, density = particles.density, pressure = particles.pressure;
  velocity.reserve(3 * count);
  std::vector<std::int32_t> id(count, -1), kind(count, hanging_class);
  for (std::size_t i = 0; i < free; ++i) {
    const Float4 &x = particles.position[i], &v = particles.velocity[i];
    data.points.push_back({x.x, x.y, x.z});
    velocity.insert(velocity.end(), {v.x, v.y, v.z});
    id[i] = static_cast<std::int32_t>(particles.id[i]);
    kind[i] = static_cast<std::int32_t>(particles.kind[i]);
  }
  for (const Vec3& place : hanging) data.points.push_back(Vec3f(place));
  velocity.resize(3 * count, 0);
  density.resize(count, static_cast<float>(liquid.kind.density)), pressure.resize(count, 0);
  data.add("velocity", std::move(velocity), 3);
  data.add("density", std::move(density));
  data.add("mass", std::vector<float>(count, static_cast<float>(liquid.particle_mass)));
  data.add("pressure", std::move(pressure));
  data.add("class", std::move(kind));  // 0 inside, 1 at the vapour, 2 at a solid, 3 hanging at a cloth
  data.add("id", std::move(id));
  return data;
}

PolyData textile_poly_data(const Textile& textile, const std::vector<Real>& saturations) {
  const YarnNetwork& network = textile.fabric->network;
  const Contents& contents = textile.contents;
  const std::size_t count = network.points.size();
  PolyData data;
  data.points.reserve(count);
  for (const Vec3& p : points_in_world(textile)) data.points.push_back(Vec3f(p));
  std::vector<float> saturation, sorbed, liquid, regain;
  std::vector<std::int32_t> yarn, family, layer;
  for (std::vector<float>* values : {&saturation, &sorbed, &liquid, &regain}) values->reserve(count);
  yarn.reserve(count), family.reserve(count);
  const auto per_segment = static_cast<std::size_t>(network.points_per_segment);
  for (std::size_t y = 0; y < network.yarn_family.size(); ++y) {
    const std::size_t first = network.yarn_first_segment[y], segments = network.yarn_first_segment[y + 1] - first;
    data.line_start.push_back(static_cast<std::int32_t>(network.yarn_first_point[y]));
    const std::size_t points = network.yarn_first_point[y + 1] - network.yarn_first_point[y];
    for (std::size_t i = 0; i < points; ++i) {
      const std::size_t s = first + std::min(i / per_segment, segments - 1);  // the last point ends the last segment
      saturation.push_back(static_cast<float>(saturations[s]));
      sorbed.push_back(static_cast<float>(contents.sorbed_kg[s]));
      liquid.push_back(static_cast<float>(contents.liquid_kg[s]));
      regain.push_back(static_cast<float>(node_regain(*textile.model, contents, s)));
      yarn.push_back(static_cast<std::int32_t>(y));
      family.push_back(static_cast<std::int32_t>(network.yarn_family[y]));
      if (network.layers > 1) layer.push_back(network.layer_of(s));
    }
  }
  if (!data.line_start.empty()) data.line_start.push_back(static_cast<std::int32_t>(count));
  data.add("saturation", std::move(saturation));
  data.add("sorbed_kg", std::move(sorbed));
  data.add("yarn_kg", std::move(liquid));
  data.add("regain", std::move(regain));
  data.add("yarn", std::move(yarn));
  data.add("family", std::move(family));
  if (network.layers > 1) data.add("layer", std::move(layer));  // 0 = uppermost
  return data;
}

PolyData pore_poly_data(const Textile& textile, const std::vector<Real>& saturations) {
  const YarnNetwork& network = textile.fabric->network;
  PolyData data;
  std::vector<float> saturation, liquid;
  std::vector<std::int32_t> layer;
  const std::vector<Vec3> places = nodes_in_world(textile);
  for (std::size_t p = 0; p < network.pores(); ++p) {
    const std::size_t node = network.segments() + p;
    data.points.push_back(Vec3f(places[node]));
    saturation.push_back(static_cast<float>(saturations[node]));
    liquid.push_back(static_cast<float>(textile.contents.liquid_kg[node]));
    if (network.layers > 1) layer.push_back(network.layer_of(node));
  }
  data.add("saturation", std::move(saturation));
  data.add("pore_kg", std::move(liquid));
  if (network.layers > 1) data.add("layer", std::move(layer));
  return data;
}

PolyData cell_cloth_poly_data(const CellCloth& cloth) {
  const Sheet& sheet = cloth.soft.sheet;
  PolyData data;
  std::vector<float> velocity, uv, water;
  for (std::size_t n = 0; n < sheet.size(); ++n) {
    data.points.push_back(Vec3f(sheet.position[n]));
    const Vec3f v(sheet.velocity[n]);
    velocity.insert(velocity.end(), {v.x, v.y, v.z});
    uv.insert(uv.end(), {static_cast<float>(sheet.u[n]), static_cast<float>(sheet.v[n])});
    water.push_back(static_cast<float>(sheet.added_mass[n]));
  }
  for (const auto& t : sheet.triangles)
    data.triangles.push_back({static_cast<std::int32_t>(t[0]), static_cast<std::int32_t>(t[1]), static_cast<std::int32_t>(t[2])});
  data.add("saturation", node_saturation(cloth));
  data.add("cell_kg", std::move(water));
  data.add("velocity", std::move(velocity), 3);
  data.add("uv", std::move(uv), 2);
  return data;
}

}  // namespace imbibe
