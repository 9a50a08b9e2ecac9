#include "imbibe/live/capture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

#include "imbibe/geometry/mesh_distance.h"
#include "imbibe/geometry/triangle_mesh.h"
#include "imbibe/live/controls.h"
#include "imbibe/sim/measures.h"

namespace imbibe::live {

using Json = nlohmann::json;

const std::vector<std::string>& step_bounds() {
  static const std::vector<std::string> names{"",         "convective", "gravity", "capillary", "viscous",
                                              "given",    "wetting",    "until",   "drop",      "cloth"};
  return names;
}

int step_bound_index(const char* name) {
  for (std::size_t i = 0; i < step_bounds().size(); ++i)
    if (step_bounds()[i] == name) return static_cast<int>(i);
  return 0;
}

const std::vector<std::string>& live_columns() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all = series_columns();
    all.insert(all.end(), {"speed", "step_bound", "converged"});
    return all;
  }();
  return names;
}

static int shown_stride(const YarnNetwork& network) { return std::max(1, network.points_per_segment / shown_steps_per_segment); }

// Numbers of the points that are shown.
static std::vector<Index> thinned(const YarnNetwork& network) {
  const auto stride = static_cast<Index>(shown_stride(network));
  std::vector<Index> shown;
  for (std::size_t y = 0; y + 1 < network.yarn_first_point.size(); ++y)
    for (Index i = network.yarn_first_point[y]; i < network.yarn_first_point[y + 1]; i += stride) shown.push_back(i);
  return shown;
}

QuantisedPoints thinned_points(const YarnNetwork& network, std::span<const Vec3> all) {
  const std::vector<Index> shown = thinned(network);
  return quantise(shown.size(), [&](std::size_t i) { return all[shown[i]]; });
}

QuantisedPoints sheet_points(const SoftSheet& soft) {
  const auto& nodes = soft.sheet.position;
  return quantise(nodes.size(), [&](std::size_t i) { return nodes[i]; });
}

std::vector<double> live_values(const SeriesRow& row, const LiveColumns& more) {
  std::vector<double> values = series_values(row);
  values.insert(values.end(), {more.speed, static_cast<double>(more.step_bound), more.converged ? 1.0 : 0.0});
  return values;
}

namespace {

QuantisedPoints shown_points(const Textile& textile) { return thinned_points(textile.fabric->network, points_in_world(textile)); }

// Where the sheet is that the yarns ride on; null: they lie fixed.
std::shared_ptr<const QuantisedPoints> moved_sheet(const Textile& textile, const std::shared_ptr<const QuantisedPoints>& before) {
  if (!textile.cloth) return nullptr;
  if (before && !textile.cloth->soft.moves()) return before;
  return std::make_shared<const QuantisedPoints>(sheet_points(textile.cloth->soft));
}

std::vector<CarriedPoint> carried_points(const Textile& textile) {
  std::vector<CarriedPoint> carried;
  const YarnNetwork& network = textile.fabric->network;
  for (const Index i : thinned(network)) {
    const Vec3& p = network.points[i];
    const SurfacePoint at = point_at(*textile.cloth->embedding, textile.cloth->soft.sheet, p.x, p.y);
    const auto share = [&](int k) { return static_cast<std::uint16_t>(std::lround(65535 * std::clamp<Real>(at.weight[k], 0, 1))); };
    carried.push_back({static_cast<std::uint32_t>(at.triangle), share(1), share(2), static_cast<float>(p.z)});
  }
  return carried;
}

std::vector<std::uint32_t> triangles_of(const Sheet& sheet) {
  std::vector<std::uint32_t> triangles;
  for (const auto& t : sheet.triangles) triangles.insert(triangles.end(), {t[0], t[1], t[2]});
  return triangles;
}

// What a cloth of cells holds and where its nodes are; what has not changed is shared with the snapshot before.
void add_cloth(const CellCloth& cloth, std::size_t owner, const Snapshot* before, Snapshot& s) {
  const std::vector<float> saturation = node_saturation(cloth);
  auto bytes = std::make_shared<Saturations>(saturation.size());
  std::transform(saturation.begin(), saturation.end(), bytes->begin(), saturation_byte);
  const bool known = before && owner < before->saturations.size();
  const bool same = known && *before->saturations[owner] == *bytes;
  s.saturations.push_back(same ? before->saturations[owner] : std::move(bytes));
  const bool still = known && before->yarns[owner] && !cloth.soft.moves();
  s.yarns.push_back(still ? before->yarns[owner] : std::make_shared<const QuantisedPoints>(sheet_points(cloth.soft)));
}

// Free particles and hanging drops; of many some, always the same ones (particles are sorted anew in every step).
QuantisedPoints shown_particles(const World& world, const std::vector<Vec3>& hanging) {
  const Particles& p = world.liquid.particles;
  const std::size_t every = std::max<std::size_t>(1, (p.size() + most_shown_particles - 1) / most_shown_particles);
  std::vector<Vec3f> shown;
  shown.reserve(p.size() / every + hanging.size() + 64);
  for (std::size_t i = 0; i < p.size(); ++i)
    if (p.id[i] % every == 0) shown.push_back({p.position[i].x, p.position[i].y, p.position[i].z});
  for (const Vec3& x : hanging) shown.emplace_back(x);
  QuantisedPoints points = quantise(shown.size(), [&](std::size_t i) { return shown[i]; });
  points.every = static_cast<std::uint16_t>(std::min<std::size_t>(every, 65535));
  return points;
}

}  // namespace

Snapshot take_snapshot(const World& world, const std::vector<std::vector<Real>>& saturations, const Snapshot* before) {
  Snapshot s;
  const auto& positions = world.liquid.particles.position;
  const std::vector<Vec3> hanging = hanging_liquid(world);
  const std::size_t free = positions.size(), count = free + hanging.size();
  const bool still = before && before->particles && before->particle_count == count && world.pace.resting;
  s.particle_count = count;
  s.particles = still ? before->particles : std::make_shared<const QuantisedPoints>(shown_particles(world, hanging));
  for (std::size_t t = 0; t < world.textiles.size(); ++t) {
    s.yarns.push_back(nullptr);
    s.sheets.push_back(moved_sheet(world.textiles[t], before ? before->sheets[t] : nullptr));
    auto bytes = std::make_shared<Saturations>(saturations[t].size());
    std::transform(saturations[t].begin(), saturations[t].end(), bytes->begin(), saturation_byte);
    const bool same = before && t < before->saturations.size() && *before->saturations[t] == *bytes;
    s.saturations.push_back(same ? before->saturations[t] : std::move(bytes));
  }
  for (std::size_t c = 0; c < world.cell_cloths.size(); ++c) add_cloth(world.cell_cloths[c], world.textiles.size() + c, before, s);
  return s;
}

namespace {

Json vector_json(const Vec3& v) { return {v.x, v.y, v.z}; }
Json colour_json(const Vec3f& c) { return {c.x, c.y, c.z}; }

Json solid_json(const SolidBody& solid) {
  Json json{{"name", solid.name}, {"colour", colour_json(solid.colour)}, {"contact_angle", solid.material.contact_angle}};
  if (const auto* plane = std::get_if<Plane>(&solid.shape))
    json.update({{"form", "plane"}, {"point", vector_json(plane->point)}, {"normal", vector_json(plane->normal)}});
  else if (const auto* box = std::get_if<Box>(&solid.shape))
    json.update({{"form", "box"}, {"centre", vector_json(box->centre)}, {"size", vector_json(box->size)}});
  else if (const auto* sphere = std::get_if<Sphere>(&solid.shape))
    json.update({{"form", "sphere"}, {"centre", vector_json(sphere->centre)}, {"radius", sphere->radius}});
  else if (const auto* cylinder = std::get_if<Cylinder>(&solid.shape))
    json.update({{"form", "cylinder"}, {"base", vector_json(cylinder->base)}, {"axis", vector_json(cylinder->axis)},
                 {"radius", cylinder->radius}, {"height", cylinder->height}});
  else if (const auto* cone = std::get_if<Cone>(&solid.shape))
    json.update({{"form", "cone"}, {"base", vector_json(cone->base)}, {"axis", vector_json(cone->axis)},
                 {"radius", cone->radius}, {"height", cone->height}});
  else
    json["form"] = "mesh";
  return json;
}

Json textile_json(const Textile& textile) {
  const YarnNetwork& network = textile.fabric->network;
  const auto stride = static_cast<Index>(shown_stride(network));
  Json radius = Json::array(), colour = Json::array(), family = Json::array(), segments = Json::array(), points = Json::array();
  for (std::size_t y = 0; y < network.yarn_family.size(); ++y) {
    const YarnType& type = network.yarn_types[network.yarn_type[y]];
    radius.push_back(static_cast<float>(type.radius));
    colour.push_back(colour_json(type.colour));
    family.push_back(network.yarn_family[y] == Family::warp ? 0 : 1);
    segments.push_back(network.yarn_first_segment[y + 1] - network.yarn_first_segment[y]);
    points.push_back((network.yarn_first_point[y + 1] - 1 - network.yarn_first_point[y]) / stride + 1);
  }
  return {{"name", textile.name},
          {"size", {network.size_x, network.size_y}},
          {"thickness", network.thickness},
          {"pitch", {network.pitch_x, network.pitch_y}},
          {"origin", vector_json(textile.placement.origin)},
          {"u", vector_json(textile.placement.u)},
          {"v", vector_json(textile.placement.v)},
          {"n", vector_json(textile.placement.n)},
          {"steps_per_segment", network.points_per_segment / static_cast<int>(stride)},
          {"segments", network.segments()},
          {"pores", network.pores()},
          {"yarn_radius", radius},
          {"yarn_colour", colour},
          {"yarn_family", family},
          {"yarn_segments", segments},
          {"yarn_points", points}};
}

// `mesh` null: a plain shape, described in the scene message.
void add_mesh(const TriangleMesh* mesh, Geometry& geometry) {
  std::vector<float> vertices;
  std::vector<std::uint32_t> triangles;
  if (mesh) {
    for (const auto& p : mesh->vertices) vertices.insert(vertices.end(), {float(p.x), float(p.y), float(p.z)});
    for (const auto& t : mesh->triangles) triangles.insert(triangles.end(), {t[0], t[1], t[2]});
  }
  geometry.mesh_vertices.push_back(std::move(vertices));
  geometry.mesh_triangles.push_back(std::move(triangles));
}

const TriangleMesh* mesh_of(const SolidBody& solid) {
  const auto* shape = std::get_if<MeshShape>(&solid.shape);
  return shape ? &(*shape)->mesh() : nullptr;
}

Json cloth_json(const CellCloth& cloth) {
  return {{"name", cloth.name}, {"colour", colour_json(cloth.colour)}, {"nodes", cloth.soft.sheet.size()}};
}

Json prop_json(const Prop& prop) {
  return {{"name", prop.name}, {"colour", colour_json(prop.colour)}, {"contact_angle", 0}, {"form", "mesh"}};
}

}  // namespace

Geometry take_geometry(std::uint32_t generation, const Scene& scene, const World& world, const Library& library,
                       const SceneTexts& texts) {
  Geometry g;
  g.generation = generation;
  Json textiles = Json::array(), cloths = Json::array(), solids = Json::array();
  for (const Textile& textile : world.textiles) {
    textiles.push_back(textile_json(textile));
    g.yarns.push_back(shown_points(textile));
    const std::vector<Vec3> nodes = nodes_in_world(textile);
    const std::size_t segments = textile.fabric->network.segments();
    g.pores.push_back(quantise(nodes.size() - segments, [&](std::size_t i) { return nodes[segments + i]; }));
    const bool rides = textile.cloth && !texts.replay;  // a run's files say where the yarns are
    g.sheet_triangles.push_back(rides ? triangles_of(textile.cloth->soft.sheet) : std::vector<std::uint32_t>{});
    g.carried.push_back(rides ? carried_points(textile) : std::vector<CarriedPoint>{});
  }
  for (const CellCloth& cloth : world.cell_cloths) {
    cloths.push_back(cloth_json(cloth));
    g.cloth_nodes.push_back(sheet_points(cloth.soft));
    const Sheet& sheet = cloth.soft.sheet;
    g.cloth_triangles.push_back(triangles_of(sheet));
    std::vector<float>& uv = g.cloth_uv.emplace_back();
    for (std::size_t i = 0; i < sheet.size(); ++i) uv.insert(uv.end(), {float(sheet.u[i]), float(sheet.v[i])});
  }
  for (const SolidBody& solid : world.solids) solids.push_back(solid_json(solid)), add_mesh(mesh_of(solid), g);
  for (const Prop& prop : world.props) solids.push_back(prop_json(prop)), add_mesh(&prop.mesh, g);
  const Json json{{"type", "scene"},
                  {"swatch", texts.swatch},
                  {"generation", generation},
                  {"title", scene.title},
                  {"replay", texts.replay},
                  {"folder", texts.folder},
                  {"duration", scene.duration},
                  {"gravity", vector_json(world.gravity)},
                  {"liquid", {{"name", world.liquid.kind.name},
                              {"spacing", world.liquid.particle_mass > 0 ? world.liquid.spacing() : 0},
                              {"particle_mass", world.liquid.particle_mass},
                              {"density", world.liquid.kind.density}}},
                  {"textiles", textiles},
                  {"cloths", cloths},
                  {"solids", solids},
                  {"controls", Json::parse(texts.replay ? "[]" : controls_json(scene, world, library))},
                  {"history", Json::parse(texts.history_json)}};
  g.scene_json = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  return g;
}

namespace {

std::string inspect_cloth(const CellCloth& cloth, std::size_t owner, std::size_t node) {
  const std::vector<float> saturation = node_saturation(cloth);
  if (node >= saturation.size()) return "";
  const Sheet& sheet = cloth.soft.sheet;
  const Real dry = sheet.dry_mass[node], held = sheet.added_mass[node];
  return Json{{"type", "inspect"},        {"textile", owner},        {"node", node},
              {"name", cloth.name},       {"kind", "cell"},          {"place", vector_json(sheet.position[node])},
              {"saturation", saturation[node]}, {"liquid_kg", held}, {"dry_kg", dry},
              {"speed", norm(sheet.velocity[node])}}
      .dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::string inspect(const World& world, std::size_t textile_index, std::size_t node, const Vec3* known_place) {
  const std::size_t cloth = textile_index - world.textiles.size();
  if (textile_index >= world.textiles.size())
    return cloth < world.cell_cloths.size() ? inspect_cloth(world.cell_cloths[cloth], textile_index, node) : "";
  const Textile& textile = world.textiles[textile_index];
  const WettingModel& model = *textile.model;
  const YarnNetwork& network = textile.fabric->network;
  if (node >= model.nodes()) return "";
  const Vec3 place = known_place ? *known_place : nodes_in_world(textile)[node];
  Json json{{"type", "inspect"},
            {"textile", textile_index},
            {"node", node},
            {"name", textile.name},
            {"place", vector_json(place)},
            {"saturation", saturation(model, textile.contents, node)},
            {"liquid_kg", textile.contents.liquid_kg[node]},
            {"capacity_kg", current_volume(model, textile.contents, node) * model.liquid.density},
            {"pressure", node_pressure(model, textile.contents, node)}};
  if (network.is_pore(node)) {
    const std::size_t pore = node - network.segments();
    json.update({{"kind", "pore"},
                 {"throat", network.pore_throat[pore]},
                 {"opening", {network.pore_opening_x[pore], network.pore_opening_y[pore]}}});
  } else {
    const YarnType& type = network.type_of_segment(node);
    const Index yarn = network.segment_yarn[node];
    json.update({{"kind", network.family_of_segment(node) == Family::warp ? "warp" : "weft"},
                 {"yarn", yarn},
                 {"segment", node - network.yarn_first_segment[yarn]},
                 {"fibre", type.fibre.name},
                 {"radius", type.radius},
                 {"contact_angle", type.fibre.advancing_angle},
                 {"regain", node_regain(model, textile.contents, node)},
                 {"sorbed_kg", textile.contents.sorbed_kg[node]}});
  }
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace imbibe::live
