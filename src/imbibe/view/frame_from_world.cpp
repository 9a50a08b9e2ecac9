#include "imbibe/view/frame_from_world.h"

#include <algorithm>

#include "imbibe/sim/measures.h"

namespace imbibe {

namespace {

void add_textile(DrawnYarns& yarns, const Textile& textile, const Air& air) {
  const YarnNetwork& network = textile.fabric->network;
  const std::vector<Real> saturations = node_saturations(textile, air);
  const auto per_segment = static_cast<std::size_t>(network.points_per_segment);
  const std::vector<Vec3> places = points_in_world(textile);
  std::vector<Vec3f> points;
  std::vector<float> values;
  for (std::size_t y = 0; y < network.yarn_family.size(); ++y) {
    const std::size_t first_point = network.yarn_first_point[y], end_point = network.yarn_first_point[y + 1];
    const std::size_t first = network.yarn_first_segment[y], segments = network.yarn_first_segment[y + 1] - first;
    points.clear(), values.clear();
    for (std::size_t i = first_point; i < end_point; ++i) {
      points.emplace_back(places[i]);
      // The last point ends the last segment: as in the run's files.
      const std::size_t segment = first + std::min((i - first_point) / per_segment, segments - 1);
      values.push_back(static_cast<float>(saturations[segment]));
    }
    const YarnType& type = network.yarn_types[network.yarn_type[y]];
    add_yarn(yarns, points, values, static_cast<float>(type.radius), type.colour);
  }
}

DrawnCloth drawn_cloth(const CellCloth& cloth) {
  const Sheet& sheet = cloth.soft.sheet;
  DrawnCloth drawn;
  drawn.name = cloth.name;
  for (const Vec3& x : sheet.position) drawn.mesh.vertices.emplace_back(x);
  drawn.mesh.triangles = sheet.triangles;
  set_normals(drawn.mesh);
  drawn.saturation = node_saturation(cloth);
  for (std::size_t n = 0; n < sheet.size(); ++n)
    drawn.uv.push_back({static_cast<float>(sheet.u[n]), static_cast<float>(sheet.v[n])});
  drawn.colour = cloth.colour;
  return drawn;
}

DrawnSolid drawn_prop(const Prop& prop) {
  DrawnSolid drawn;
  for (const Vec3& x : prop.mesh.vertices) drawn.mesh.vertices.emplace_back(x);
  drawn.mesh.triangles = prop.mesh.triangles;
  drawn.colour = prop.colour;
  return drawn;
}

}  // namespace

Frame frame_from_world(const World& world, const std::string& title) {
  Frame frame;
  frame.time = world.time;
  frame.title = title;
  for (const Textile& textile : world.textiles) add_textile(frame.yarns, textile, world.air);
  if (!world.textiles.empty()) frame.up = Vec3f(world.textiles.front().placement.n);
  for (const CellCloth& cloth : world.cell_cloths) frame.cloths.push_back(drawn_cloth(cloth));
  for (const Prop& prop : world.props) frame.solids.push_back(drawn_prop(prop));
  frame.particle_spacing = world.liquid.spacing();
  frame.particles.reserve(world.liquid.particles.size());
  for (const Float4& p : world.liquid.particles.position) frame.particles.push_back({p.x, p.y, p.z});
  for (const Vec3& p : hanging_liquid(world)) frame.particles.emplace_back(p);
  for (const SolidBody& solid : world.solids) frame.solids.push_back({solid.shape, {}, solid.colour});
  return frame;
}

}  // namespace imbibe
