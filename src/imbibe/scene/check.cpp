#include "imbibe/scene/check.h"

#include <fmt/format.h>

#include <algorithm>

#include "imbibe/core/portable.h"
#include "imbibe/core/quantity.h"
#include "imbibe/liquid/liquid_kind.h"

namespace imbibe {
namespace {

// Wall time per particle and step on two cores of the reference machine, and per network node and textile step: the
// goals that the benchmarks hold. Only for the estimate of cost.
constexpr double seconds_per_particle_step = 1.9e-6;
constexpr double seconds_per_node_step = 4e-6;

std::string row(const std::string& name, const std::string& value) { return fmt::format("  {:<34} {}\n", name, value); }

std::string bytes_text(double bytes) {
  return bytes >= 1e9 ? fmt::format("{:.3g} GB", bytes / 1e9) : fmt::format("{:.3g} MB", bytes / 1e6);
}

std::string time_text(double seconds) {
  if (seconds < 90) return fmt::format("{:.2g} s", seconds);
  if (seconds < 5400) return fmt::format("{:.2g} min", seconds / 60);
  return fmt::format("{:.2g} h", seconds / 3600);
}

std::string liquid_text(const World& world) {
  const Liquid& liquid = world.liquid;
  const LiquidKind& k = liquid.kind;
  const Real g = norm(world.gravity);
  std::string text = fmt::format("liquid: {}\n", k.name);
  text += row("density", format_quantity(k.density, "kg/m3", "kg/m3"));
  text += row("viscosity", format_quantity(k.viscosity, "Pa s", "mPa s"));
  text += row("surface tension", format_quantity(k.surface_tension, "N/m", "mN/m"));
  if (g > 0 && k.surface_tension > 0) text += row("capillary length", fmt::format("{:.3f} mm", capillary_length(k, g) * 1e3));
  if (world.sources.empty()) return text;
  text += row("particle mass, spacing",
              fmt::format("{:.4g} mg, {:.4g} mm", liquid.particle_mass * 1e6, liquid.spacing() * 1e3));
  for (const Source& source : world.sources) {
    const DropNumbers n = drop_numbers(source, liquid, g);
    text += fmt::format("{}{}\n", source.name, source.count > 1 && source.form != SourceForm::pipe ? fmt::format(" ({} times)", source.count) : "");
    text += row("volume, mass", fmt::format("{:.4g} uL, {:.4g} mg", n.mass / k.density * 1e9, n.mass * 1e6));
    text += row("radius, particles", fmt::format("{:.4g} mm, {:.0f} ({:.1f} across)", n.radius * 1e3, n.particles, n.particles_across));
    text += row("Bond number", fmt::format("{:.3g}", n.bond_number));
    text += row("Weber, capillary number", fmt::format("{:.3g}, {:.3g}", n.weber_number, n.capillary_number));
  }
  return text;
}

std::string cost_text(const Scene& scene, const World& world) {
  const SceneEstimate e = estimate_scene(scene, world.liquid.kind);
  std::string text = "cost (estimates)\n";
  text += row("particles, at most", fmt::format("{:.0f}", e.particles));
  text += row("yarn segments, pores, edges", fmt::format("{:.0f}, {:.0f}, {:.0f}", e.segments, e.pores, e.edges));
  text += row("memory", fmt::format("{} of {} in this machine", bytes_text(e.memory_bytes), bytes_text(machine_memory())));
  text += row("outputs, run folder", fmt::format("{:.0f}, {}", e.outputs, bytes_text(e.disk_bytes)));
  double most = scene.duration / 0.02 * (e.segments + e.pores) * seconds_per_node_step;
  if (e.particles > 0) {
    const Real viscous = 0.125 * world.liquid.kind.density * e.spacing * e.spacing /
                         std::max(world.liquid.kind.viscosity, 1e-12);
    text += row("step bound, capillary waves", fmt::format("{:.3g} ms", e.capillary_step * 1e3));
    text += row("explicit viscous bound", fmt::format("{:.3g} ms (not binding where viscosity is implicit)", viscous * 1e3));
    Real speed = 0;
    for (const Source& s : world.sources) speed = std::max(speed, norm(s.velocity));
    if (speed > 0)
      text += row("step bound, first speed",
                  fmt::format("{:.3g} ms", scene.liquid.solver.convective_factor * e.spacing / speed * 1e3));
    most += scene.duration / std::min<double>(e.capillary_step, scene.duration) * e.particles * seconds_per_particle_step;
  }
  text += row("wall time, at most about",
              fmt::format("{} on two cores, if the liquid moves all the time; resting liquid costs little", time_text(most)));
  return text;
}

}  // namespace

DropNumbers drop_numbers(const Source& source, const Liquid& liquid, Real gravity) {
  DropNumbers n;
  const LiquidKind& k = liquid.kind;
  const Real volume = source.form == SourceForm::pipe ? source.volume * source.count
                      : source.form == SourceForm::box ? source.size.x * source.size.y * source.size.z : source.volume;
  const Real speed = norm(source.velocity);
  n.radius = portable::cbrt(3 * volume / (4 * pi));
  n.mass = volume * k.density;
  n.particles = static_cast<Real>(particle_count(source, liquid));
  n.particles_across = 2 * n.radius / liquid.spacing();
  const Real gamma = k.surface_tension > 0 ? k.surface_tension : std::numeric_limits<Real>::quiet_NaN();
  n.bond_number = k.density * gravity * n.radius * n.radius / gamma;
  n.weber_number = k.density * speed * speed * 2 * n.radius / gamma;
  n.capillary_number = k.viscosity * speed / gamma;
  return n;
}

std::string textile_report(const World& world, std::size_t i) {
  const Textile& textile = world.textiles[i];
  const LiquidKind& kind = world.liquid.kind;
  return fmt::format("textile: {}\n", textile.name) +
         describe_fabric(*textile.fabric, {.name = kind.name, .density = kind.density,
                                           .surface_tension = kind.surface_tension});
}

std::string check_report(const Scene& scene, const World& world) {
  std::string text = scene.title.empty() ? "" : scene.title + "\n\n";
  text += row("duration", time_text(scene.duration));
  text += row("air", fmt::format("{:.4g} degC, {:.3g} % relative humidity", world.air.temperature - 273.15,
                                 world.air.humidity * 100));
  text += "\n" + liquid_text(world);
  for (std::size_t i = 0; i < world.textiles.size(); ++i) text += "\n" + textile_report(world, i);
  for (const SolidBody& solid : world.solids)
    text += fmt::format("\nsolid: {}, contact angle {:.4g} deg\n", solid.name, degrees(solid.material.contact_angle));
  return text + "\n" + cost_text(scene, world);
}

}  // namespace imbibe
