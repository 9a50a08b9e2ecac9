#include "imbibe/scene/textile_builder.h"

#include <algorithm>

#include "imbibe/scene/describe_writer.h"
#include "imbibe/wetting/conditioning.h"

namespace imbibe {
namespace {

Placement placement_of(const TextileSpec& spec) {
  Placement p;
  p.origin = spec.centre;
  p.u = normalized(spec.weft_direction);
  p.v = normalized(spec.warp_direction);
  p.n = cross(p.u, p.v);
  return p;
}

// A yarn type that warp and weft share becomes one for each, so that they can have angles of their own.
void part_families(YarnNetwork& network) {
  const std::size_t types = network.yarn_types.size();
  std::vector<bool> in_warp(types, false);
  std::vector<Index> for_weft(types, no_index);
  for (std::size_t y = 0; y < network.yarn_type.size(); ++y)
    if (network.yarn_family[y] == Family::warp) in_warp[network.yarn_type[y]] = true;
  for (std::size_t y = 0; y < network.yarn_type.size(); ++y) {
    const Index type = network.yarn_type[y];
    if (network.yarn_family[y] == Family::warp || !in_warp[type]) continue;
    if (for_weft[type] == no_index) {
      for_weft[type] = static_cast<Index>(network.yarn_types.size());
      network.yarn_types.push_back(YarnType(network.yarn_types[type]));
    }
    network.yarn_type[y] = for_weft[type];
  }
}

// A textile's own contact angles replace those of its fibres, so that every part that asks a fibre sees them.
void set_contact_angles(const TextileSpec& spec, const FibreLibrary& fibres, Fabric& fabric) {
  YarnNetwork& network = fabric.network;
  if (spec.warp_contact_angle || spec.weft_contact_angle) part_families(network);
  for (YarnType& type : network.yarn_types) {
    Fibre& fibre = type.fibre;
    const Fibre own = find_fibre(fibres, fibre.name)->fibre;  // a running textile's have been replaced already
    fibre.advancing_angle = spec.contact_angle.value_or(own.advancing_angle);
    fibre.receding_angle = spec.receding_angle.value_or(own.receding_angle);
  }
  for (std::size_t y = 0; y < network.yarn_type.size(); ++y) {
    const auto& of_family = network.yarn_family[y] == Family::warp ? spec.warp_contact_angle : spec.weft_contact_angle;
    if (of_family) network.yarn_types[network.yarn_type[y]].fibre.advancing_angle = *of_family;
  }
  for (YarnType& type : network.yarn_types)
    type.fibre.receding_angle = std::min(type.fibre.receding_angle, type.fibre.advancing_angle);
}

bool same_fabric(const FabricSpec& a, const FabricSpec& b) {
  return a.folder == b.folder && write_described(a) == write_described(b);
}

bool same_angles(const TextileSpec& a, const TextileSpec& b) {
  return a.contact_angle == b.contact_angle && a.warp_contact_angle == b.warp_contact_angle &&
         a.weft_contact_angle == b.weft_contact_angle && a.receding_angle == b.receding_angle;
}

bool same_liquid(const WettingLiquid& a, const WettingLiquid& b) {
  return a.density == b.density && a.viscosity == b.viscosity && a.surface_tension == b.surface_tension &&
         a.advancing_angle == b.advancing_angle && a.receding_angle == b.receding_angle;
}

// Whether contents of one model can be those of the other, array by array.
bool same_contents(const WettingModel& a, const WettingModel& b) {
  return a.segments == b.segments && a.pores == b.pores && a.params.sorption == b.params.sorption &&
         a.params.shells == b.params.shells && a.params.hysteresis == b.params.hysteresis;
}

// What `regain` and `start` say, in place of conditioned fibres without liquid between them.
Contents starting_contents(const TextileSpec& spec, const YarnNetwork& network, const WettingModel& model, Air air) {
  const StartSpec& start = spec.start;
  air.humidity = spec.regain ? humidity_in_balance(model, *spec.regain) : start.humidity.value_or(air.humidity);
  Contents contents = conditioned_contents(model, air);
  for (std::size_t node = 0; node < network.nodes(); ++node) {
    Real held = network.is_pore(node) ? start.pores : start.yarns;
    const Vec3& x = network.node_centre(node);
    for (const SpotSpec& spot : start.spots) {
      const Real u = 2 * (x.x - spot.centre[0]) / spot.size[0], v = 2 * (x.y - spot.centre[1]) / spot.size[1];
      const bool inside = spot.round ? u * u + v * v <= 1 : std::abs(u) <= 1 && std::abs(v) <= 1;
      if (inside) held = network.is_pore(node) ? spot.pores : spot.yarns;
    }
    contents.liquid_kg[node] = held * model.liquid.density * current_volume(model, contents, node);
    if (!contents.reached_saturation.empty()) contents.reached_saturation[node] = held;
  }
  return contents;
}

}  // namespace

RunningTextile running_textile(const RunningWorld* running, std::size_t i) {
  if (!running || i >= running->scene.textiles.size() || running->scene.textiles[i].wetting.is_cells()) return {};
  const auto& specs = running->scene.textiles;
  const auto before = specs.begin() + static_cast<std::ptrdiff_t>(i);
  const auto index = static_cast<std::size_t>(std::count_if(specs.begin(), before, [](const TextileSpec& t) { return !t.wetting.is_cells(); }));
  if (index >= running->world.textiles.size()) return {};
  return {&specs[i], &running->world.textiles[index]};
}

Textile woven_textile(const TextileSpec& spec, const FibreLibrary& fibres, const std::string& key,
                      const RunningTextile& running) {
  Textile textile;
  textile.name = spec.name;
  textile.placement = placement_of(spec);
  const bool known = running.spec && same_fabric(spec.fabric, running.spec->fabric);
  if (known && same_angles(spec, *running.spec)) {
    textile.fabric = running.textile->fabric;
    return textile;
  }
  auto fabric = std::make_shared<Fabric>(known ? *running.textile->fabric : build_fabric(spec.fabric, fibres, key));
  set_contact_angles(spec, fibres, *fabric);
  textile.fabric = std::move(fabric);
  return textile;
}

void set_wetting(const TextileSpec& spec, const World& world, Textile& textile, const RunningTextile& running) {
  const YarnNetwork& network = textile.fabric->network;
  const LiquidKind& kind = world.liquid.kind;
  const WettingLiquid liquid{.density = kind.density, .viscosity = kind.viscosity, .surface_tension = kind.surface_tension};
  const Textile* old = running.textile;
  const bool same_network = old && same_fabric(spec.fabric, running.spec->fabric);
  const bool all_same = old && old->fabric == textile.fabric && same_liquid(liquid, old->model->liquid) &&
                        write_described(spec.wetting.network) == write_described(running.spec->wetting.network);
  textile.model = all_same ? old->model
                           : std::make_shared<const WettingModel>(build_wetting_model(network, spec.wetting.network, liquid));
  const Real spacing = world.liquid.particle_mass > 0 ? world.liquid.spacing() : 0;
  textile.faces = old && old->fabric == textile.fabric ? old->faces : std::make_shared<const FaceMap>(build_face_map(network, spacing));
  textile.yarn_boxes = same_network ? old->yarn_boxes : std::make_shared<const YarnContactIndex>(build_contact_index(network));
  textile.contact = spec.contact;
  textile.exchange.waiting_kg.assign(network.nodes(), 0);
}

void set_contents(const TextileSpec& spec, const Air& air, Textile& textile, const RunningTextile& running) {
  const Textile* old = running.textile;
  const bool goes_on = old && same_contents(*old->model, *textile.model);
  if (goes_on && spec.regain) humidity_in_balance(*textile.model, *spec.regain);  // throws what the start would
  textile.contents = goes_on ? old->contents : starting_contents(spec, textile.fabric->network, *textile.model, air);
}

}  // namespace imbibe
