#include "imbibe/scene/builder.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "imbibe/core/portable.h"
#include "imbibe/core/quantity.h"
#include "imbibe/scene/cloth_builder.h"
#include "imbibe/scene/describe_writer.h"
#include "imbibe/scene/placement_checks.h"
#include "imbibe/scene/textile_builder.h"

namespace imbibe {
namespace {

// Measured on the arrays of Particles, the sorted copies and the neighbour lists (about 40 neighbours of 4 bytes in
// two lists) of LiquidFields; and on YarnNetwork, WettingModel, Contents, FaceMap and the solver's matrix.
constexpr double bytes_per_particle = 900;
constexpr double bytes_per_node = 400;  // all in the solve
constexpr double bytes_per_edge = 80;
constexpr double base_bytes = 60e6;  // program, libraries, one picture
// Files of one output: float32 fields of a .vtp point.
constexpr double disk_per_particle = 36, disk_per_point = 36, disk_per_pore = 24, disk_per_picture = 6e5;

std::string bytes_text(double bytes) {
  return bytes >= 1e9 ? fmt::format("{:.3g} GB", bytes / 1e9) : fmt::format("{:.3g} MB", bytes / 1e6);
}

void check_limits(const Scene& scene, const SceneEstimate& need, std::vector<Problem>& problems) {
  const auto refuse = [&](const std::string& key, const std::string& message) {
    problems.push_back(scene_problem(scene, key, message));
  };
  if (need.particles > scene.limits.max_particles)
    refuse("liquid.particle_mass",
           fmt::format("the liquid would be {:.3g} particles, more than limits.max_particles = {:.3g}; raise "
                       "particle_mass {:.3g} times or more",
                       need.particles, scene.limits.max_particles, need.particles / scene.limits.max_particles));
  const double allowed = allowed_memory(scene);
  if (need.memory_bytes > allowed)
    refuse(need.particles * bytes_per_particle > 0.5 * need.memory_bytes || scene.textiles.empty()
               ? "liquid.particle_mass"
               : "textiles",
           fmt::format("the scene would need about {} of memory, more than {} ({}): {:.3g} particles, {:.3g} yarn "
                       "segments",
                       bytes_text(need.memory_bytes), bytes_text(allowed),
                       scene.limits.max_memory ? "limits.max_memory" : "80 % of this machine's", need.particles,
                       need.segments));
  if (need.disk_bytes > scene.limits.max_disk)
    refuse("output.every",
           fmt::format("the run folder would take about {} for {:.3g} outputs, more than limits.max_disk = {}",
                       bytes_text(need.disk_bytes), need.outputs, bytes_text(scene.limits.max_disk)));
}

// How often a source releases before the end of the run.
Real releases(const Source& s, Real duration) {
  if (s.start >= duration) return 0;
  if (s.count <= 1) return 1;
  return std::min(static_cast<Real>(s.count), std::floor((duration - s.start) / s.interval) + 1);
}

void add_at(const Scene& scene, const InputError& error, std::vector<Problem>& problems, const std::string& key = "") {
  for (const Problem& problem : error.problems()) {
    if (problem.file.empty()) {
      const std::string path = key + (key.empty() || problem.key.empty() ? "" : ".") + problem.key;
      problems.push_back(scene_problem(scene, path, problem.message));
    } else {
      problems.push_back(problem);  // of another file, such as a .wif draft
    }
  }
}

void add_textile(const Scene& scene, std::size_t i, const Library& library, const RunningWorld* running, World& world,
                 std::vector<Problem>& problems) {
  const TextileSpec& spec = scene.textiles[i];
  const std::string key = fmt::format("textiles[{}]", i);
  try {
    if (spec.wetting.is_cells()) {
      world.cell_cloths.push_back(build_cell_cloth(scene, i));
      return;
    }
    if (spec.sheet.soft && spec.sheet.is_soft() && spec.sheet.soft->mesh)
      throw InputError({Problem{.key = key + ".sheet.soft.mesh",
                                .message = "a sheet from a mesh takes `wetting: cells`: yarns are woven into rectangles only"}});
    world.textiles.push_back(woven_textile(spec, library.fibres, key, running_textile(running, i)));
  } catch (const InputError& error) {
    add_at(scene, error, problems);
  }
}

// i: of the scene's textiles; index: of the world's.
void add_wetting(const Scene& scene, std::size_t i, std::size_t index, const RunningWorld* running, World& world,
                 std::vector<Problem>& problems) {
  const TextileSpec& spec = scene.textiles[i];
  Textile& textile = world.textiles[index];
  const std::string key = fmt::format("textiles[{}]", i);
  try {
    set_wetting(spec, world, textile, running_textile(running, i));
    try {
      set_contents(spec, world.air, textile, running_textile(running, i));
    } catch (const InputError& error) {
      return add_at(scene, error, problems, key);
    }
    for (std::size_t r = 0; r < spec.reservoirs.size(); ++r) {
      try {
        textile.reservoirs.push_back(make_reservoir(spec.reservoirs[r], textile.fabric->network));
      } catch (const InputError& error) {
        add_at(scene, error, problems, fmt::format("{}.reservoirs[{}]", key, r));
      }
    }
    if (spec.sheet.is_soft()) textile.cloth = build_network_cloth(scene, i, textile, world.air);
  } catch (const InputError& error) {
    add_at(scene, error, problems, key + ".wetting");
  }
}

void add_solid(const Scene& scene, std::size_t i, const RunningWorld* running, World& world, std::vector<Problem>& problems) {
  const SolidSpec& spec = scene.solids[i];
  try {
    SolidBody body;
    body.name = spec.name;
    const bool shared = running && i < running->scene.solids.size() && i < running->world.solids.size() &&
                        write_described(spec.shape) == write_described(running->scene.solids[i].shape);
    body.shape = shared ? running->world.solids[i].shape : make_shape(spec.shape);  // a mesh is read once
    body.material.contact_angle = spec.contact_angle;
    body.material.receding_angle = spec.receding_angle.value_or(-1);
    body.material.friction = spec.friction;
    body.material.velocity = spec.surface_velocity;
    body.colour = Vec3f(spec.colour);
    world.solids.push_back(std::move(body));
  } catch (const InputError& error) {
    add_at(scene, error, problems, fmt::format("solids[{}].shape", i));
  }
}

// What is in the scene, and as much again around it.
Bounds default_domain(const World& world) {
  Bounds all;
  for (const Source& source : world.sources) all.include(bounds_of(source));
  for (const Textile& textile : world.textiles) all.include(bounds_of_sheet(textile));
  for (const CellCloth& cloth : world.cell_cloths)
    for (const Vec3& x : cloth.soft.sheet.position) all.include(x);
  for (const SolidBody& solid : world.solids) {
    if (const Plane* plane = std::get_if<Plane>(&solid.shape)) all.include(plane->point);
    else all.include(bounds_of(solid.shape));
  }
  const Vec3 size = all.size();
  all.grow(std::max({0.02, size.x, size.y, size.z}));
  return all;
}

}  // namespace

double machine_memory() {
  const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGE_SIZE);
  const double whole = pages > 0 && size > 0 ? static_cast<double>(pages) * static_cast<double>(size) : 0;
  double group = 0;  // a group without a limit says "max"
  std::ifstream limit("/sys/fs/cgroup/memory.max");
  return limit >> group && group > 0 && (whole == 0 || group < whole) ? group : whole;
}

double allowed_memory(const Scene& scene) {
  const double machine = machine_memory();
  return scene.limits.max_memory.value_or(machine > 0 ? 0.8 * machine : 1e30);
}

LiquidKind liquid_of(const Scene& scene, const Library& library, std::vector<Problem>& problems) {
  const LiquidKindSpec& spec = scene.liquid.kind;
  LiquidKind kind;
  kind.name = spec.name;
  const bool own = spec.density && spec.viscosity && spec.surface_tension;
  if (const LiquidRecord* record = find_liquid(library, spec.name)) {
    kind = record->kind;
  } else if (!own) {
    std::vector<std::string> names;
    for (const LiquidRecord& r : library.liquids) names.push_back(r.kind.name);
    const std::string near = nearest_word(spec.name, names);
    const bool named = scene.places.contains("liquid.kind.name");
    problems.push_back(scene_problem(
        scene, named ? "liquid.kind.name" : "liquid.kind",
        fmt::format("there is no liquid '{}'{}. Known: {}; or give density, viscosity and surface_tension", spec.name,
                    near.empty() ? "" : fmt::format("; did you mean '{}'?", near), fmt::join(names, ", "))));
    return kind;
  }
  kind.density = spec.density.value_or(kind.density);
  kind.viscosity = spec.viscosity.value_or(kind.viscosity);
  kind.surface_tension = spec.surface_tension.value_or(kind.surface_tension);
  return kind;
}

std::vector<Source> sources_of(const Scene& scene) {
  std::vector<Source> sources;
  const auto add_drop = [&](const DropSpec& drop, const std::string& fallback) -> Source& {
    Source& s = sources.emplace_back();
    s.name = drop.name.empty() ? fallback : drop.name;
    s.form = SourceForm::drop;
    s.centre = drop.centre, s.volume = drop.volume, s.velocity = drop.velocity, s.start = drop.start;
    s.stretch = drop.stretch, s.cap_angle = drop.cap_angle.value_or(0);
    return s;
  };
  const LiquidSpec& liquid = scene.liquid;
  for (std::size_t i = 0; i < liquid.drops.size(); ++i) add_drop(liquid.drops[i], fmt::format("drop {}", i + 1));
  for (std::size_t i = 0; i < liquid.boxes.size(); ++i) {
    const LiquidBoxSpec& box = liquid.boxes[i];
    Source& s = sources.emplace_back();
    s.name = box.name.empty() ? fmt::format("box {}", i + 1) : box.name;
    s.form = SourceForm::box;
    s.centre = box.centre, s.size = box.size, s.velocity = box.velocity, s.start = box.start;
    s.vortex = box.vortex;
  }
  for (std::size_t i = 0; i < liquid.droppers.size(); ++i) {
    const DropperSpec& dropper = liquid.droppers[i];
    Source& s = add_drop(dropper.drop, fmt::format("dropper {}", i + 1));
    s.interval = dropper.interval, s.count = dropper.count;
  }
  return sources;
}

void add_pipes(const Scene& scene, World& world) {
  for (std::size_t i = 0; i < scene.liquid.pipes.size(); ++i) {
    try {
      world.sources.push_back(source_of_pipe(scene, i, world.liquid.particle_mass, world.liquid.kind.density));
      world.props.push_back({.name = world.sources.back().name, .mesh = pipe_geometry(scene.liquid.pipes[i]).mesh});
    } catch (const InputError& error) {
      std::vector<Problem> problems = error.problems();
      for (Problem& p : problems)
        if (p.file.empty()) p.key = fmt::format("liquid.pipes[{}].file", i);
      throw InputError(std::move(problems));
    }
  }
}

SceneEstimate estimate_scene(const Scene& scene, const LiquidKind& kind) {
  SceneEstimate e;
  e.capillary_step = std::numeric_limits<Real>::infinity();
  const Real particle_mass = scene.liquid.particle_mass.value_or(0);
  if (particle_mass > 0) {
    Real volume = 0;
    for (const Source& s : sources_of(scene))
      volume += releases(s, scene.duration) * (s.form == SourceForm::box ? s.size.x * s.size.y * s.size.z : s.volume);
    e.particles = volume * kind.density / particle_mass;
    e.spacing = portable::cbrt(particle_mass / kind.density);
    if (kind.surface_tension > 0)
      e.capillary_step = scene.liquid.solver.capillary_factor *
                         std::sqrt(kind.density * portable::pow(e.spacing, 3) / (2 * pi * kind.surface_tension));
  }
  for (const PipeSpec& pipe : scene.liquid.pipes)
    if (particle_mass > 0) e.particles += particles_of_pipe(pipe, scene.duration, particle_mass / kind.density);
  double fabric_bytes = 0, points = 0;
  for (const TextileSpec& textile : scene.textiles) {
    if (textile.wetting.is_cells()) continue;
    const FabricEstimate f = estimate_fabric(textile.fabric);
    e.segments += f.segments, e.pores += f.pores, e.edges += f.edges;
    points += f.points, fabric_bytes += f.bytes;
  }
  e.memory_bytes = base_bytes + e.particles * bytes_per_particle + fabric_bytes +
                   (e.segments + e.pores) * bytes_per_node + e.edges * bytes_per_edge;
  e.outputs = std::ceil(scene.duration / output_interval(scene)) + 1;
  e.disk_bytes = e.outputs * ((scene.output.particles ? e.particles * disk_per_particle : 0) +
                              (scene.output.textiles ? points * disk_per_point + e.pores * disk_per_pore : 0) +
                              (scene.output.pictures ? disk_per_picture : 0));
  return e;
}

RunPlan run_plan(const Scene& scene) {
  RunPlan plan;
  plan.until = scene.duration;
  plan.every = output_interval(scene);
  plan.max_steps = scene.limits.max_steps ? static_cast<std::uint64_t>(*scene.limits.max_steps) : 0;
  if (scene.limits.max_step) plan.step.max_step = *scene.limits.max_step;
  plan.step.rest_allowed = scene.liquid.rest;
  return plan;
}

World build_world(const Scene& scene, const Library& library, const RunningWorld* running) {
  std::vector<Problem> problems;
  World world;
  world.liquid.kind = liquid_of(scene, library, problems);
  world.liquid.particle_mass = scene.liquid.particle_mass.value_or(0);
  // Only estimates so far: nothing is allocated for a scene that the machine cannot hold.
  check_limits(scene, estimate_scene(scene, world.liquid.kind), problems);
  const bool any_network = std::any_of(scene.textiles.begin(), scene.textiles.end(),
                                       [](const TextileSpec& t) { return !t.wetting.is_cells(); });
  if (any_network && !(world.liquid.kind.viscosity > 0 && world.liquid.kind.surface_tension > 0))
    problems.push_back(scene_problem(scene, "liquid.kind",
                                     "a textile takes up only a liquid with viscosity and surface tension above 0"));
  if (!problems.empty()) throw InputError(std::move(problems));

  world.seed = scene.seed;
  world.gravity = scene.gravity;
  world.air = {scene.air.temperature, scene.air.humidity, scene.air.mass_transfer};
  world.liquid_params = scene.liquid.solver;
  world.sources = sources_of(scene);
  for (std::size_t i = 0; i < scene.textiles.size(); ++i) add_textile(scene, i, library, running, world, problems);
  for (std::size_t i = 0; i < scene.solids.size(); ++i) add_solid(scene, i, running, world, problems);
  try {
    add_pipes(scene, world);
  } catch (const InputError& error) {
    add_at(scene, error, problems);
  }
  if (running) running->continue_sources(world);
  const bool all_built = problems.empty() && world.textiles.size() + world.cell_cloths.size() == scene.textiles.size() && world.solids.size() == scene.solids.size();
  if (all_built) {
    world.domain = default_domain(world);
    if (scene.domain.lower) world.domain.lower = *scene.domain.lower;
    if (scene.domain.upper) world.domain.upper = *scene.domain.upper;
    check_placements(scene, world, running ? &running->world : nullptr, problems);
    check_pipes(scene, world, problems);
  }
  if (!problems.empty()) throw InputError(std::move(problems));
  for (std::size_t i = 0, index = 0; i < scene.textiles.size(); ++i)
    if (!scene.textiles[i].wetting.is_cells()) add_wetting(scene, i, index++, running, world, problems);
  if (!problems.empty()) throw InputError(std::move(problems));
  for (const Textile& textile : world.textiles)
    world.ledger.initial_kg += total_sorbed_kg(*textile.model, textile.contents) +
                               total_yarn_kg(*textile.model, textile.contents) +
                               total_pore_kg(*textile.model, textile.contents);
  return world;
}

}  // namespace imbibe
