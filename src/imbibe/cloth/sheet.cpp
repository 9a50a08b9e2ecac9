#include "imbibe/cloth/sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "imbibe/core/random.h"

namespace imbibe {
namespace {

// What a sheet takes per node with the constraints and the caches of a step, roughly; asked before memory is taken.
constexpr std::size_t greatest_node_count = 4'000'000;

void fill_node_arrays(Sheet& sheet) {
  const std::size_t n = sheet.size();
  sheet.velocity.assign(n, Vec3{});
  sheet.added_mass.assign(n, 0);
  sheet.stiffness_factor.assign(n, 1);
  sheet.damping_added.assign(n, 0);
  sheet.cling.assign(n, 0);
}

std::uint64_t topology_key_of(const Sheet& sheet) {
  std::uint64_t key = mixed(sheet.size());
  const auto add = [&](std::uint64_t word) { key = mixed(key ^ word); };
  const auto bits = [](Real x) { return std::bit_cast<std::uint64_t>(x); };
  add(sheet.columns), add(sheet.rows);
  for (const auto& t : sheet.triangles) add(t[0]), add(t[1]), add(t[2]);
  for (std::size_t i = 0; i < sheet.size(); ++i) add(bits(sheet.u[i])), add(bits(sheet.v[i]));
  return key;
}

Real material_area(const Sheet& sheet, const std::array<Index, 3>& t) {
  return 0.5 * ((sheet.u[t[1]] - sheet.u[t[0]]) * (sheet.v[t[2]] - sheet.v[t[0]]) -
                (sheet.u[t[2]] - sheet.u[t[0]]) * (sheet.v[t[1]] - sheet.v[t[0]]));
}

// The cells of a grid are cut along alternating diagonals, so that no diagonal direction of the cloth is preferred.
void cut_cells(Sheet& sheet) {
  const Index nx = sheet.columns;
  for (Index j = 0; j + 1 < sheet.rows; ++j) {
    for (Index i = 0; i + 1 < nx; ++i) {
      const Index a = i + nx * j, b = a + 1, c = a + nx + 1, d = a + nx;
      if ((i + j) % 2 == 0) {
        sheet.triangles.push_back({a, b, c}), sheet.triangles.push_back({a, c, d});
      } else {
        sheet.triangles.push_back({a, b, d}), sheet.triangles.push_back({b, c, d});
      }
    }
  }
}

struct MeshFaults {
  std::size_t without_area = 0, first_without_area = 0;
  std::size_t turned = 0, first_turned = 0;
  std::size_t without_extent = 0, first_without_extent = 0;
};

MeshFaults find_faults(const Sheet& sheet) {
  MeshFaults faults;
  Real total = 0;
  for (const auto& t : sheet.triangles) total += std::abs(material_area(sheet, t));
  const Real none = 1e-12 * total / static_cast<Real>(std::max<std::size_t>(1, sheet.triangles.size()));
  const TriangleMesh mesh = surface_mesh(sheet);
  for (std::size_t k = 0; k < sheet.triangles.size(); ++k) {
    const Real area = material_area(sheet, sheet.triangles[k]);
    if (!(std::abs(area) > none)) {
      if (faults.without_area++ == 0) faults.first_without_area = k;
    } else if (area < 0) {
      if (faults.turned++ == 0) faults.first_turned = k;
    }
    if (!(norm(area_vector(mesh, k)) > 1e-12 * std::abs(area))) {
      if (faults.without_extent++ == 0) faults.first_without_extent = k;
    }
  }
  return faults;
}

std::vector<Problem> find_mesh_problems(const TriangleMesh& mesh, std::span<const std::array<Real, 2>> uv,
                                        Real areal_mass, const std::string& name) {
  std::vector<Problem> problems;
  const auto wrong = [&](std::string message) { problems.push_back({.file = name, .message = std::move(message)}); };
  if (!(areal_mass > 0)) wrong(fmt::format("the areal mass {} kg/m2 must be above 0", areal_mass));
  if (uv.size() != mesh.vertices.size()) {
    wrong(uv.empty() ? std::string("the mesh has no material coordinates (UV); an OBJ file gives them as vt lines")
                     : fmt::format("{} material coordinates (UV) for {} vertices", uv.size(), mesh.vertices.size()));
  }
  for (const auto& c : uv) {
    if (!std::isfinite(c[0]) || !std::isfinite(c[1])) {
      wrong("a material coordinate (UV) is not finite");
      break;
    }
  }
  if (mesh.vertices.size() > greatest_node_count) {
    wrong(fmt::format("{} nodes; at most {} fit", mesh.vertices.size(), greatest_node_count));
  }
  MeshDefects defects = find_defects(mesh);
  defects.open_edges = defects.holes = 0;  // a sheet has hems
  defects.inside_out = false;
  for (Problem& p : describe_defects(defects, mesh, name)) problems.push_back(std::move(p));
  return problems;
}

// Vertices that no triangle uses would be nodes without mass.
void add_loose_nodes(const TriangleMesh& mesh, const std::string& name, std::vector<Problem>& problems) {
  std::vector<bool> used(mesh.vertices.size());
  for (const auto& t : mesh.triangles) used[t[0]] = used[t[1]] = used[t[2]] = true;
  const auto loose = std::find(used.begin(), used.end(), false);
  if (loose == used.end()) return;
  problems.push_back({.file = name, .message = fmt::format("{} vertices belong to no triangle, the first is vertex {}",
                                                           std::count(used.begin(), used.end(), false),
                                                           loose - used.begin())});
}

void add_faults(const MeshFaults& faults, const std::string& name, std::vector<Problem>& problems) {
  const auto wrong = [&](std::size_t count, std::size_t first, const char* what) {
    if (count == 0) return;
    problems.push_back({.file = name, .message = fmt::format("{} triangle{} {}, the first is triangle {}", count,
                                                             count == 1 ? "" : "s", what, first)});
  };
  wrong(faults.without_area, faults.first_without_area, "without area in the material coordinates (UV)");
  wrong(faults.turned, faults.first_turned, "clockwise in the material coordinates (UV) where others are not");
  wrong(faults.without_extent, faults.first_without_extent, "without area in space");
}

}  // namespace

Vec3 displacement_at(const PinPath& path, Real time) {
  const auto& keys = path.keys;
  if (keys.empty()) return {};
  const auto after = std::upper_bound(keys.begin(), keys.end(), time, [](Real t, const PinKey& k) { return t < k.time; });
  if (after == keys.begin()) return keys.front().displacement;
  if (after == keys.end()) return keys.back().displacement;
  const PinKey& a = *(after - 1);
  const Real part = (time - a.time) / (after->time - a.time);
  return a.displacement + part * (after->displacement - a.displacement);
}

std::vector<Problem> find_problems(const GridSheet& grid) {
  std::vector<Problem> problems;
  const auto wrong = [&](const char* key, std::string message) {
    problems.push_back({.key = key, .message = std::move(message)});
  };
  if (!(grid.width > 0)) wrong("width", fmt::format("{} m must be above 0", grid.width));
  if (!(grid.height > 0)) wrong("height", fmt::format("{} m must be above 0", grid.height));
  if (!(grid.areal_mass > 0)) wrong("areal_mass", fmt::format("{} kg/m2 must be above 0", grid.areal_mass));
  if (grid.columns < 2) wrong("columns", fmt::format("{} nodes; a sheet needs at least 2", grid.columns));
  if (grid.rows < 2) wrong("rows", fmt::format("{} nodes; a sheet needs at least 2", grid.rows));
  const std::size_t count = std::size_t{grid.columns} * grid.rows;
  if (count > greatest_node_count) wrong("columns", fmt::format("{} nodes; at most {} fit", count, greatest_node_count));
  if (!is_finite(grid.corner)) wrong("corner", "is not finite");
  if (!(norm(grid.along_u) > 0) || !is_finite(grid.along_u)) wrong("along_u", "has no direction");
  if (!(norm(cross(grid.along_u, grid.along_v)) > 1e-9 * norm(grid.along_u) * norm(grid.along_v))) {
    wrong("along_v", "must not be parallel to along_u");
  }
  return problems;
}

Sheet make_sheet(const GridSheet& grid) {
  if (auto problems = find_problems(grid); !problems.empty()) throw InputError(std::move(problems));
  Sheet sheet;
  sheet.columns = grid.columns, sheet.rows = grid.rows;
  sheet.areal_mass = grid.areal_mass;
  const Vec3 eu = normalized(grid.along_u);
  const Vec3 ev = normalized(grid.along_v - dot(grid.along_v, eu) * eu);
  const Real du = grid.width / (grid.columns - 1), dv = grid.height / (grid.rows - 1);
  for (Index j = 0; j < grid.rows; ++j) {
    for (Index i = 0; i < grid.columns; ++i) {
      const Real u = du * i, v = dv * j;
      sheet.u.push_back(u), sheet.v.push_back(v);
      sheet.position.push_back(grid.corner + u * eu + v * ev);
      // A node stands for the quarters of its cells.
      const Real across = i == 0 || i + 1 == grid.columns ? 0.5 : 1, along = j == 0 || j + 1 == grid.rows ? 0.5 : 1;
      sheet.dry_mass.push_back(grid.areal_mass * du * dv * across * along);
    }
  }
  cut_cells(sheet);
  fill_node_arrays(sheet);
  sheet.topology_key = topology_key_of(sheet);
  return sheet;
}

Sheet make_sheet(const TriangleMesh& mesh, std::span<const std::array<Real, 2>> uv, Real areal_mass,
                 const std::string& name) {
  std::vector<Problem> problems = find_mesh_problems(mesh, uv, areal_mass, name);
  if (!problems.empty()) throw InputError(std::move(problems));
  add_loose_nodes(mesh, name, problems);
  Sheet sheet;
  sheet.areal_mass = areal_mass;
  sheet.position = mesh.vertices;
  sheet.triangles = mesh.triangles;
  for (const auto& c : uv) sheet.u.push_back(c[0]), sheet.v.push_back(c[1]);
  // A map that is clockwise throughout is a matter of the file's convention; one that is so in part is an error.
  const auto clockwise = [&](const auto& t) { return material_area(sheet, t) < 0; };
  if (std::all_of(sheet.triangles.begin(), sheet.triangles.end(), clockwise)) {
    for (Real& u : sheet.u) u = -u;
  }
  add_faults(find_faults(sheet), name, problems);
  if (!problems.empty()) throw InputError(std::move(problems));
  sheet.dry_mass.assign(sheet.size(), 0);
  for (const auto& t : sheet.triangles) {
    for (const Index i : t) sheet.dry_mass[i] += areal_mass * material_area(sheet, t) / 3;
  }
  fill_node_arrays(sheet);
  sheet.topology_key = topology_key_of(sheet);
  return sheet;
}

// --- pins -----------------------------------------------------------------------------------------------------------

namespace {

[[noreturn]] void unknown_place(const char* what, const std::string& name, const std::vector<std::string>& known) {
  std::string message = fmt::format("there is no {} '{}'", what, name);
  if (const std::string near = nearest_word(name, known); !near.empty()) message += fmt::format("; did you mean {}?", near);
  message += fmt::format(" ({})", fmt::join(known, ", "));
  throw InputError(message);
}

void require_grid(const Sheet& sheet, const char* what) {
  if (!sheet.is_grid()) {
    throw InputError(fmt::format("a sheet made from a mesh has no {}s; pin it at material coordinates", what));
  }
}

}  // namespace

std::vector<Index> nodes_of_corner(const Sheet& sheet, const std::string& corner) {
  static const std::vector<std::string> known{"bottom_left", "bottom_right", "top_left", "top_right"};
  const auto found = std::find(known.begin(), known.end(), corner);
  if (found == known.end()) unknown_place("corner", corner, known);
  require_grid(sheet, "corner");
  const auto which = static_cast<Index>(found - known.begin());
  return {(which % 2) * (sheet.columns - 1) + (which / 2) * (sheet.rows - 1) * sheet.columns};
}

std::vector<Index> nodes_of_edge(const Sheet& sheet, const std::string& edge) {
  static const std::vector<std::string> known{"left", "right", "bottom", "top"};
  const auto found = std::find(known.begin(), known.end(), edge);
  if (found == known.end()) unknown_place("edge", edge, known);
  require_grid(sheet, "edge");
  const auto which = found - known.begin();
  const bool upright = which < 2;
  const Index last = which % 2 == 1 ? 1 : 0;
  std::vector<Index> nodes;
  for (Index k = 0; k < (upright ? sheet.rows : sheet.columns); ++k) {
    nodes.push_back(upright ? last * (sheet.columns - 1) + k * sheet.columns
                            : last * (sheet.rows - 1) * sheet.columns + k);
  }
  return nodes;
}

Index node_nearest(const Sheet& sheet, Real u, Real v) {
  Index best = 0;
  Real best_squared = std::numeric_limits<Real>::infinity();
  for (Index i = 0; i < sheet.size(); ++i) {
    const Real du = sheet.u[i] - u, dv = sheet.v[i] - v, squared = du * du + dv * dv;
    if (squared < best_squared) best_squared = squared, best = i;
  }
  return best;
}

void pin_nodes(Sheet& sheet, std::span<const Index> nodes, const PinPath& path, Real until) {
  std::vector<Problem> problems;
  const auto wrong = [&](std::string message) { problems.push_back({.message = std::move(message)}); };
  for (std::size_t k = 0; k < path.keys.size(); ++k) {
    if (!std::isfinite(path.keys[k].time) || !is_finite(path.keys[k].displacement)) {
      wrong(fmt::format("key {} of the pins' path is not finite", k));
    } else if (k > 0 && !(path.keys[k].time > path.keys[k - 1].time)) {
      wrong(fmt::format("key times must rise: {} s comes after {} s", path.keys[k].time, path.keys[k - 1].time));
    }
  }
  std::map<Index, Pin> pins;
  for (const Pin& pin : sheet.pins) pins.emplace(pin.node, pin);
  const bool moves = !path.keys.empty();
  const auto number = moves ? static_cast<Index>(sheet.pin_paths.size()) : no_index;
  for (const Index node : nodes) {
    if (node >= sheet.size()) {
      wrong(fmt::format("node {} does not exist; the sheet has {} nodes", node, sheet.size()));
      continue;
    }
    const Pin pin{.node = node, .anchor = sheet.position[node], .path = number, .until = until};
    const auto [there, added] = pins.emplace(node, pin);
    // Two edges share a corner: the same path twice is one pin, the later of both releases.
    if (!added && (moves || there->second.path != no_index)) {
      wrong(fmt::format("node {} is pinned twice, and one of the pins moves", node));
    } else if (!added) {
      there->second.until = std::max(there->second.until, until);
    }
  }
  if (!problems.empty()) throw InputError(std::move(problems));
  if (moves) sheet.pin_paths.push_back(path);
  sheet.pins.clear();
  for (const auto& [node, pin] : pins) sheet.pins.push_back(pin);
}

// --- measures -------------------------------------------------------------------------------------------------------

Vec3 momentum(const Sheet& sheet) {
  Vec3 sum;
  for (std::size_t i = 0; i < sheet.size(); ++i) sum += sheet.mass(i) * sheet.velocity[i];
  return sum;
}

Real kinetic_energy(const Sheet& sheet) {
  Real sum = 0;
  for (std::size_t i = 0; i < sheet.size(); ++i) sum += 0.5 * sheet.mass(i) * squared_norm(sheet.velocity[i]);
  return sum;
}

Real total_mass(const Sheet& sheet) {
  Real sum = 0;
  for (std::size_t i = 0; i < sheet.size(); ++i) sum += sheet.mass(i);
  return sum;
}

TriangleMesh surface_mesh(const Sheet& sheet) { return {sheet.position, sheet.triangles}; }

std::vector<Real> node_areas(const Sheet& sheet) {
  std::vector<Real> areas(sheet.size());
  for (std::size_t i = 0; i < sheet.size(); ++i) areas[i] = sheet.dry_mass[i] / sheet.areal_mass;
  return areas;
}

}  // namespace imbibe
