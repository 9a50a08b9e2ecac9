#include "imbibe/coupling/footprint.h"

#include "imbibe/core/portable.h"
#include "imbibe/core/union_find.h"

namespace imbibe {
namespace {

void clear(Footprint& f, std::size_t nodes) {
  for (const FaceSupply& supply : f.supplies) f.supply_of_node[supply.node] = no_index;
  f.supply_of_node.resize(nodes, no_index);
  f.particle.clear(), f.patch_of.clear(), f.on_back.clear(), f.first_link.assign(1, 0), f.links.clear();
  f.supplies.clear(), f.supply_patch.clear(), f.patches.clear();
}

// Links of one touching particle at sheet position p, and its share of the wetted area of the nodes.
void add_links(const FaceMap& map, const Vec3& p, Real particle_area, Footprint& f) {
  const bool below = p.z < 0;
  const std::size_t begin = f.links.size();
  Real total = 0;
  map.near(p.x, p.y, !below, [&](const FaceMap::Node& n) {
    const Real w = face_kernel(portable::hypot(p.x - n.x, p.y - n.y), map.reach);
    if (w <= 0) return;
    const Index k = n.index;
    f.links.push_back({k, w * map.face_area[k]});
    total += f.links.back().share;
    if (f.supply_of_node[k] == no_index) {
      f.supply_of_node[k] = static_cast<Index>(f.supplies.size());
      f.supplies.push_back({.node = k, .from_below = below});
    }
    if (!below) f.supplies[f.supply_of_node[k]].from_below = false;  // wetted from both faces: gravity helps
    f.supplies[f.supply_of_node[k]].wetted_share += particle_area * w;
  });
  for (std::size_t l = begin; l < f.links.size(); ++l) f.links[l].share /= total;
  f.first_link.push_back(static_cast<Index>(f.links.size()));
}

// Joins particles through their common nodes and numbers the patches.
void find_patches(const Liquid& liquid, Real particle_area, Footprint& f) {
  std::vector<Index> parent, owner(f.supplies.size(), no_index);
  separate_all(parent, f.particle.size());
  for (Index p = 0; p < f.particle.size(); ++p)
    for (Index l = f.first_link[p]; l < f.first_link[p + 1]; ++l) {
      Index& first = owner[f.supply_of_node[f.links[l].node]];
      if (first == no_index) first = p;
      else unite(parent, first, p);
    }
  f.patch_of.assign(f.particle.size(), no_index);
  for (Index p = 0; p < f.particle.size(); ++p) {
    const Index root = root_of(parent, p);  // the smallest member, so it has its number already
    if (root == p) {
      f.patch_of[p] = static_cast<Index>(f.patches.size());
      f.patches.emplace_back();
    } else {
      f.patch_of[p] = f.patch_of[root];
    }
    FootprintPatch& patch = f.patches[f.patch_of[p]];
    ++patch.particles;
    patch.area += particle_area;
    patch.touching_kg += liquid.particle_mass;
    patch.owed_kg += liquid.particles.owed_kg[f.particle[p]];
  }
  f.supply_patch.resize(f.supplies.size());
  for (std::size_t s = 0; s < f.supplies.size(); ++s) f.supply_patch[s] = f.patch_of[owner[s]];
}

// Total head of the liquid in Pa: no steady pressure at the sheet exceeds it.
Real total_head(const Liquid& liquid, const ClothPlace& place, const Vec3& gravity) {
  Real head = 0;
  const Vec3 foot = place.foot(gravity);
  const Particles& p = liquid.particles;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Float4 &x = p.position[i], &v = p.velocity[i];
    const Real fall = -dot(gravity, Vec3(x.x, x.y, x.z) - foot);
    head = std::max(head, fall + 0.5 * squared_norm(Vec3(v.x, v.y, v.z)));
  }
  const Real radius = portable::cbrt(3 * liquid.mass() / (4 * pi * liquid.kind.density));
  return liquid.kind.density * head + 2 * liquid.kind.surface_tension / radius;
}

void set_pressures(Real head, const ExchangeState& exchange, Footprint& f) {
  Real area = 0;
  for (const FootprintPatch& patch : f.patches) area += patch.area;
  for (FootprintPatch& patch : f.patches) patch.pressure = std::clamp(exchange.normal_force / area, 0.0, head);
}

// What waits lies on the lower face of the sheet where that is the node's own (release.h).
void add_waiting_film(const Liquid& liquid, const YarnNetwork& network, const ClothPlace& place, const FaceMap& map,
                      const Vec3& gravity, const ExchangeState& exchange, Footprint& f) {
  for (Index k = 0; k < exchange.waiting_kg.size(); ++k) {
    const Real kg = exchange.waiting_kg[k];
    if (kg <= 0) continue;
    if (f.supply_of_node[k] == no_index) {
      const bool face_up = dot(gravity, place.normal_at(network.node_centre(k))) <= 0;
      f.supply_of_node[k] = static_cast<Index>(f.supplies.size());
      f.supplies.push_back({.node = k, .from_below = face_up ? map.on_lower[k] != 0 : map.on_upper[k] == 0});
      f.supply_patch.push_back(no_index);
    }
    FaceSupply& supply = f.supplies[f.supply_of_node[k]];
    supply.available_kg += kg;
    supply.wetted_share =
        std::min(1.0, supply.wetted_share + kg / (liquid.kind.density * liquid.spacing() * map.face_area[k]));
  }
}

}  // namespace

void find_footprint(const Liquid& liquid, const YarnNetwork& network, const ClothPlace& place, const FaceMap& map,
                    const Vec3& gravity, const ExchangeState& exchange, Footprint& f) {
  clear(f, network.nodes());
  const Real dx = liquid.spacing(), reach_z = 0.5 * network.thickness + touch_distance(dx);
  const Real half_x = 0.5 * network.size_x, half_y = 0.5 * network.size_y;
  for (std::size_t i = 0; i < liquid.particles.size(); ++i) {
    const Float4& x = liquid.particles.position[i];
    const Vec3 p = place.to_sheet({x.x, x.y, x.z});
    const bool touches = std::abs(p.z) <= reach_z && std::abs(p.x) <= half_x && std::abs(p.y) <= half_y;
    if (!touches) continue;  // nor does a place that is no number: the step's end reports that particle
    const std::size_t before = f.links.size();
    add_links(map, p, dx * dx, f);
    if (f.links.size() == before) {  // beside the last node of the border: nothing to touch
      f.first_link.pop_back();
      continue;
    }
    f.particle.push_back(static_cast<Index>(i));
    f.on_back.push_back(p.z < 0);
  }
  find_patches(liquid, dx * dx, f);
  if (!f.empty()) set_pressures(total_head(liquid, place, gravity), exchange, f);
  for (std::size_t p = 0; p < f.particle.size(); ++p) {
    const FootprintPatch& patch = f.patches[f.patch_of[p]];
    const Real left = liquid.particle_mass * std::max(1 - patch.owed_kg / patch.touching_kg, 0.0);
    for (Index l = f.first_link[p]; l < f.first_link[p + 1]; ++l)
      f.supplies[f.supply_of_node[f.links[l].node]].available_kg += f.links[l].share * left;
  }
  for (std::size_t s = 0; s < f.supplies.size(); ++s) {
    f.supplies[s].wetted_share = std::min(f.supplies[s].wetted_share, 1.0);
    f.supplies[s].pressure = f.patches[f.supply_patch[s]].pressure;
  }
  add_waiting_film(liquid, network, place, map, gravity, exchange, f);
}

}  // namespace imbibe
