#include "imbibe/scene/cloth_builder.h"

#include <fmt/format.h>

#include <algorithm>

#include "imbibe/core/portable.h"
#include "imbibe/geometry/mesh_file.h"

namespace imbibe {
namespace {

constexpr int most_particles_of_pipe = 2'000'000'000;
constexpr Real fullest_jet = 0.5;  // of its bore's volume: random places at 0.8 spacings from each other fill no more

std::string key_of(std::size_t textile) { return fmt::format("textiles[{}]", textile); }

void rethrow_at(const std::string& key, const InputError& error) {
  std::vector<Problem> problems = error.problems();
  for (Problem& p : problems)
    if (p.file.empty()) p.key = key + (p.key.empty() ? "" : "." + p.key);
  throw InputError(std::move(problems));
}

Real areal_mass_of(const TextileSpec& spec, const SoftSheetSpec& soft) {
  return spec.fabric.areal_mass.value_or(soft.cloth.hand.areal_mass);
}

Index node_count(int given, Real length, Real distance) {
  return given > 0 ? static_cast<Index>(given) : static_cast<Index>(std::lround(length / distance)) + 1;
}

GridSheet grid_of(const TextileSpec& spec, const SoftSheetSpec& soft) {
  GridSheet grid;
  const Vec3 u = normalized(spec.weft_direction), v = normalized(spec.warp_direction);
  grid.width = spec.fabric.size[0], grid.height = spec.fabric.size[1];
  grid.corner = spec.centre - 0.5 * grid.width * u - 0.5 * grid.height * v;
  grid.along_u = u, grid.along_v = v;
  const Real distance = soft.node_distance.value_or(std::max(grid.width, grid.height) / 23);
  grid.columns = node_count(soft.columns, grid.width, distance);
  grid.rows = node_count(soft.rows, grid.height, distance);
  grid.areal_mass = areal_mass_of(spec, soft);
  return grid;
}

Sheet free_form_sheet(const TextileSpec& spec, const SoftSheetSpec& soft) {
  UvMesh file = read_uv_mesh(*soft.mesh);
  apply_transform(file.mesh, soft.transform);
  for (auto& uv : file.uv) uv = {soft.uv_scale * uv[0], soft.uv_scale * uv[1]};
  return make_sheet(file.mesh, file.uv, areal_mass_of(spec, soft), *soft.mesh);
}

// How far apart nodes are, m: the diagonal of a grid's cell, or of a square of a mesh's mean area per node.
Real node_spacing(const Sheet& sheet) {
  if (sheet.is_grid()) return portable::hypot(sheet.u[1] - sheet.u[0], sheet.v[sheet.columns] - sheet.v[0]);
  Real area = 0;
  for (const Real a : node_areas(sheet)) area += a;
  return std::sqrt(2 * area / static_cast<Real>(sheet.size()));
}

// The node at a point (m from the lower left corner of the cloth's outline). Throws InputError for a point off the cloth.
Index node_at(const Sheet& sheet, const std::array<Real, 2>& point) {
  const auto [left, right] = std::minmax_element(sheet.u.begin(), sheet.u.end());
  const auto [bottom, top] = std::minmax_element(sheet.v.begin(), sheet.v.end());
  const Real u = *left + point[0], v = *bottom + point[1];
  const Index node = node_nearest(sheet, u, v);
  const Real away = portable::hypot(sheet.u[node] - u, sheet.v[node] - v), spacing = node_spacing(sheet);
  // A point of a grid is at most half a diagonal from a node; meshes are not that even.
  if (away > (sheet.is_grid() ? 0.5 + 1e-9 : 1) * spacing) {
    Problem off;
    off.message = fmt::format("({:.4g}, {:.4g}) mm is off the cloth: {:.4g} mm from its nearest node, of a cloth of {:.4g} x {:.4g} mm",
                              point[0] * 1e3, point[1] * 1e3, away * 1e3, (*right - *left) * 1e3, (*top - *bottom) * 1e3);
    throw InputError(std::vector<Problem>{off});
  }
  return node;
}

void add_pin(Sheet& sheet, const PinSpec& pin) {
  std::vector<Index> nodes;
  if (pin.corner) nodes = nodes_of_corner(sheet, *pin.corner);
  else if (pin.edge) nodes = nodes_of_edge(sheet, *pin.edge);
  else if (pin.point) nodes = {node_at(sheet, *pin.point)};
  PinPath path;
  for (const PinMoveSpec& key : pin.motion) path.keys.push_back({key.time, key.displacement});
  pin_nodes(sheet, nodes, path, pin.until.value_or(std::numeric_limits<Real>::infinity()));
}

// A tube with a wall, closed at its rims, its mouth at the origin and its body below.
TriangleMesh plain_tube(Real bore, Real length) {
  constexpr int sides = 32;
  TriangleMesh mesh;
  const Real radii[4] = {bore, 1.2 * bore, 1.2 * bore, bore}, heights[4] = {0, 0, -length, -length};
  for (int k = 0; k < sides; ++k)
    for (int r = 0; r < 4; ++r) {
      const Real angle = 2 * pi * k / sides;
      mesh.vertices.push_back({radii[r] * portable::cos(angle), radii[r] * portable::sin(angle), heights[r]});
    }
  for (int k = 0; k < sides; ++k)
    for (int r = 0; r < 4; ++r) {
      const auto at = [&](int side, int ring) { return static_cast<Index>(4 * (side % sides) + ring % 4); };
      mesh.triangles.push_back({at(k, r), at(k, r + 1), at(k + 1, r + 1)});
      mesh.triangles.push_back({at(k, r), at(k + 1, r + 1), at(k + 1, r)});
    }
  return mesh;
}

Real rate_of(const PipeSpec& spec, Real particle_volume) {
  return spec.particle_rate ? *spec.particle_rate : spec.flow.value_or(0) / particle_volume;
}

}  // namespace

void apply_presets(Scene& scene, std::vector<Problem>& problems) {
  for (std::size_t i = 0; i < scene.textiles.size(); ++i) {
    std::optional<SoftSheetSpec>& soft = scene.textiles[i].sheet.soft;
    if (!soft || !soft->preset) continue;
    const std::string key = key_of(i) + ".sheet.soft.preset", hand_key = key_of(i) + ".sheet.soft.cloth.hand.";
    try {
      const FabricHand named = fabric_hand(*soft->preset), own = soft->cloth.hand;
      FabricHand& hand = soft->cloth.hand;
      hand = named;
      const auto keep = [&](const char* name, Real FabricHand::*value) {
        if (scene.places.contains(hand_key + name)) hand.*value = own.*value;
      };
      keep("areal_mass", &FabricHand::areal_mass), keep("thickness", &FabricHand::thickness);
      keep("stretch_weft", &FabricHand::stretch_weft), keep("stretch_warp", &FabricHand::stretch_warp);
      keep("shear", &FabricHand::shear), keep("twist", &FabricHand::twist);
      keep("bending_weft", &FabricHand::bending_weft), keep("bending_warp", &FabricHand::bending_warp);
    } catch (const InputError& error) {
      for (const Problem& p : error.problems()) problems.push_back(scene_problem(scene, key, p.message));
    }
  }
}

void check_cloth_keys(const Scene& scene, std::size_t i, std::vector<Problem>& problems) {
  const TextileSpec& spec = scene.textiles[i];
  const auto refuse = [&](const std::string& key, const std::string& message) {
    problems.push_back(scene_problem(scene, key_of(i) + key, message));
  };
  if (spec.wetting.is_cells() && !spec.fabric.areal_mass && !spec.sheet.soft)
    refuse("", "a cloth of cells needs its areal_mass (or a soft sheet with a preset)");
  if (spec.wetting.is_cells() && spec.regain) refuse(".regain", "a cloth of cells knows no fibres that could be conditioned");
  if (spec.wetting.is_cells() && spec.warp_contact_angle) refuse(".warp_contact_angle", "a cloth of cells has no warp: contact_angle");
  if (spec.wetting.is_cells() && spec.weft_contact_angle) refuse(".weft_contact_angle", "a cloth of cells has no weft: contact_angle");
  if (!spec.sheet.soft) return;
  const SoftSheetSpec& soft = *spec.sheet.soft;
  for (std::size_t k = 0; k < soft.pins.size(); ++k) {
    const PinSpec& pin = soft.pins[k];
    const std::string key = fmt::format(".sheet.soft.pins[{}]", k);
    if (pin.corner.has_value() + pin.edge.has_value() + pin.point.has_value() != 1)
      refuse(key, "wants exactly one of corner, edge, point");
    for (std::size_t m = 1; m < pin.motion.size(); ++m)
      if (!(pin.motion[m].time > pin.motion[m - 1].time))
        refuse(fmt::format("{}.motion[{}].time", key, m), "is not after the time before it");
  }
  if (!soft.mesh) {
    if (soft.columns == 1) refuse(".sheet.soft.columns", "wants 2 nodes or more");
    if (soft.rows == 1) refuse(".sheet.soft.rows", "wants 2 nodes or more");
    const GridSheet grid = grid_of(spec, soft);
    if (static_cast<double>(grid.columns) * grid.rows > 4e6)
      refuse(".sheet.soft", fmt::format("{} x {} nodes are more than 4 million", grid.columns, grid.rows));
  }
}

void check_pipe_keys(const Scene& scene, std::vector<Problem>& problems) {
  for (std::size_t i = 0; i < scene.liquid.pipes.size(); ++i) {
    const PipeSpec& p = scene.liquid.pipes[i];
    const std::string key = fmt::format("liquid.pipes[{}]", i);
    const auto refuse = [&](const char* name, const std::string& message) {
      problems.push_back(scene_problem(scene, key + name, message));
    };
    if (p.flow.has_value() == p.particle_rate.has_value()) refuse("", "wants exactly one of flow and particle_rate");
    if (!p.file && (!p.radius || !p.length)) refuse("", "wants radius and length, or the file of a mesh");
    if (p.stop && *p.stop <= p.start) refuse(".stop", "is not after start");
  }
}

SoftSheet build_soft_sheet(const Scene& scene, std::size_t i, const Fabric* fabric) {
  TextileSpec spec = scene.textiles[i];
  const SoftSheetSpec soft = spec.sheet.soft.value_or(SoftSheetSpec{});
  SoftSheet result;
  if (fabric != nullptr) {
    spec.fabric.size = {fabric->network.size_x, fabric->network.size_y};
    spec.fabric.areal_mass = fabric->numbers.areal_mass;
  }
  result.cloth = soft.cloth;
  result.cloth.hand.areal_mass = areal_mass_of(spec, soft);
  const std::string key = key_of(i) + (spec.sheet.soft ? ".sheet.soft" : "");
  try {
    if (soft.mesh) {
      result.sheet = free_form_sheet(spec, soft);
    } else {
      const GridSheet grid = grid_of(spec, soft);
      result.sheet = make_sheet(grid);
    }
  } catch (const InputError& error) {
    rethrow_at(key + (soft.mesh ? ".mesh" : ""), error);
  }
  result.sheet.fixed = !spec.sheet.is_soft();
  std::vector<Problem> problems;
  for (std::size_t k = 0; k < soft.pins.size(); ++k) {
    try {
      add_pin(result.sheet, soft.pins[k]);
    } catch (const InputError& error) {
      for (Problem p : error.problems()) p.key = fmt::format("{}.pins[{}]", key, k), problems.push_back(p);
    }
  }
  if (!problems.empty()) throw InputError(std::move(problems));
  if (spec.contact_angle) result.contact_angle = *spec.contact_angle;
  if (fabric != nullptr && !scene.places.contains(key_of(i) + ".sheet.soft.cloth.hand.thickness"))
    result.cloth.hand.thickness = fabric->network.thickness;
  return result;
}

NetworkCloth build_network_cloth(const Scene& scene, std::size_t i, const Textile& built, const Air& air) {
  const TextileSpec& spec = scene.textiles[i];
  NetworkCloth cloth =
      make_network_cloth(build_soft_sheet(scene, i, built.fabric.get()), built.fabric->network, *built.model, air,
                         spec.sheet.soft ? spec.sheet.soft->wet : WetClothParams{});
  std::vector<std::uint8_t> held;
  find_held(cloth.soft, held);
  WeighScratch scratch;
  weigh(cloth, held, built.fabric->network, *built.model, built.contents, built.exchange, {}, scratch);
  return cloth;
}

CellCloth build_cell_cloth(const Scene& scene, std::size_t i) {
  const TextileSpec& spec = scene.textiles[i];
  CellCloth cloth;
  cloth.name = spec.name;
  cloth.soft = build_soft_sheet(scene, i);
  if (!spec.contact_angle) cloth.soft.contact_angle = radians(45);
  cloth.params = spec.wetting.cells.value_or(CellParams{});
  cloth.wet = spec.sheet.soft ? spec.sheet.soft->wet : WetClothParams{};
  cloth.colour = Vec3f(spec.colour);
  fit_cells(cloth);
  return cloth;
}

PipeGeometry pipe_geometry(const PipeSpec& spec) {
  PipeGeometry g;
  Vec3 mouth{};
  if (spec.file) {
    g.mesh = read_mesh(*spec.file);
    const Bounds b = bounds_of(g.mesh);
    const Vec3 size = b.size();
    mouth = {b.centre().x, b.centre().y, b.upper.z};
    g.radius = 0.8 * 0.5 * std::min(size.x, size.y) * spec.transform.scale;
    g.length = size.z * spec.transform.scale;
  } else {
    g.mesh = plain_tube(*spec.radius / spec.transform.scale, *spec.length / spec.transform.scale);
  }
  g.radius = spec.radius.value_or(g.radius);
  g.length = spec.length.value_or(g.length);
  apply_transform(g.mesh, spec.transform);
  TriangleMesh probe;
  probe.vertices = {mouth, mouth + Vec3{0, 0, 1}};
  MeshTransform stand = spec.transform;
  stand.flip = false;
  apply_transform(probe, stand);
  g.mouth = probe.vertices[0];
  g.axis = normalized(probe.vertices[1] - probe.vertices[0]);
  return g;
}

Real particles_of_pipe(const PipeSpec& spec, Real duration, Real particle_volume) {
  const Real time = std::min(spec.stop.value_or(duration), duration) - spec.start;
  return std::max(0.0, time * rate_of(spec, particle_volume));
}

Source source_of_pipe(const Scene& scene, std::size_t i, Real particle_mass, Real density) {
  const PipeSpec& spec = scene.liquid.pipes[i];
  const PipeGeometry g = pipe_geometry(spec);
  const Real volume = particle_mass / density;
  Source s;
  s.name = spec.name.empty() ? fmt::format("pipe {}", i + 1) : spec.name;
  s.form = SourceForm::pipe;
  s.centre = g.mouth, s.velocity = spec.speed * g.axis;
  s.radius = g.radius, s.length = g.length;
  s.submerged = spec.submerged;
  s.volume = volume;
  s.start = spec.start;
  s.interval = 1 / rate_of(spec, volume);
  s.count = static_cast<int>(std::min<Real>(most_particles_of_pipe,
                                            std::floor(particles_of_pipe(spec, scene.duration, volume) + 1e-9) + 1));
  s.seed = scene.seed * 1000003 + i;
  return s;
}

void check_pipes(const Scene& scene, const World& world, std::vector<Problem>& problems) {
  for (std::size_t i = 0; i < scene.liquid.pipes.size(); ++i) {
    const std::string key = fmt::format("liquid.pipes[{}]", i);
    const std::size_t first = world.sources.size() - scene.liquid.pipes.size();
    const Source& s = world.sources[first + i];
    const auto refuse = [&](const char* name, const std::string& message) {
      problems.push_back(scene_problem(scene, key + name, message));
    };
    const Vec3 room = world.domain.size();
    if (2 * s.radius > std::min({room.x, room.y, room.z}))
      refuse(".radius", fmt::format("the pipe is {:.4g} mm wide, wider than the domain ({:.4g} x {:.4g} x {:.4g} mm)",
                                    2e3 * s.radius, 1e3 * room.x, 1e3 * room.y, 1e3 * room.z));
    else if (!world.domain.contains(s.centre))
      refuse(".transform", "its mouth lies outside the domain");
    const Real bore = pi * s.radius * s.radius, flow = s.volume / s.interval;
    if (flow > fullest_jet * bore * norm(s.velocity))
      refuse(".speed", fmt::format("{:.4g} mL/s at {:.4g} m/s do not fit through a bore of {:.4g} mm: single particles in "
                                   "random places fill at most half of it; raise speed to {:.3g} m/s or widen it",
                                   1e6 * flow, norm(s.velocity), 2e3 * s.radius, flow / (fullest_jet * bore)));
  }
}

}  // namespace imbibe
