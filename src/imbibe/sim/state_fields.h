// The one list of everything in a World that changes while it runs. state_hash() and the checkpoint are visitors of
// it: a new field of the state is added here and nowhere else.
//
// A visitor has:
//   void group(const std::string& name);          the fields that follow belong to this path, e.g. "textiles/0"
//   template <class T> void value(const char* name, T& x);               scalars (arithmetic, enum, Vec3)
//   template <class T> void array(const char* name, std::vector<T>& x);  arithmetic, enum, Vec3, Float4
// The same function serves const worlds: the fields are then const. It visits as many textiles and sources as the world
// has.
//
// Not state, and so not here: what the scene builds (fabric, model, placement, solids, liquid kind, parameters,
// domain, and what a source is to emit).
#pragma once

#include <string>

#include "imbibe/sim/world.h"

namespace imbibe {

template <class Visitor, class AnySheet>
void visit_soft_sheet(Visitor& v, AnySheet& soft, const std::string& group) {
  v.group(group);
  v.array("position", soft.sheet.position);
  v.array("velocity", soft.sheet.velocity);
  v.array("added_mass", soft.sheet.added_mass);
  v.array("stiffness_factor", soft.sheet.stiffness_factor);
  v.array("damping_added", soft.sheet.damping_added);
  v.array("cling", soft.sheet.cling);
  v.value("sheet_time", soft.sheet.time);
  v.value("substep", soft.sheet.substep);
  v.value("support_impulse", soft.support_impulse);
  v.value("liquid_impulse", soft.liquid_impulse);
  v.value("given_force", soft.given.force);
  v.value("given_moment", soft.given.moment);
  v.value("load_force", soft.load.force);
  v.value("load_moment", soft.load.moment);
  v.value("load_at_rest_force", soft.load_at_rest.force);
  v.value("load_at_rest_moment", soft.load_at_rest.moment);
  v.value("calm_s", soft.calm_s);
  v.array("calm_place", soft.calm_place);
  v.value("mass_at_rest", soft.mass_at_rest);
  v.value("at_rest", soft.at_rest);
}

template <class Visitor, class AnyWorld>
void visit_state(Visitor& v, AnyWorld& world) {
  v.group("world");
  v.value("time", world.time);
  v.value("step", world.step);
  v.value("seed", world.seed);
  v.value("gravity", world.gravity);

  v.group("air");
  v.value("temperature", world.air.temperature);
  v.value("humidity", world.air.humidity);
  v.value("mass_transfer", world.air.mass_transfer);

  v.group("ledger");
  v.value("initial_kg", world.ledger.initial_kg);
  v.value("supplied_kg", world.ledger.supplied_kg);
  v.value("evaporated_kg", world.ledger.evaporated_kg);
  v.value("left_kg", world.ledger.left_kg);

  v.group("pace");
  v.value("wetting_interval", world.pace.wetting_interval);
  v.value("since_wetting", world.pace.since_wetting);
  v.value("resting", world.pace.resting);
  v.value("calm_since", world.pace.calm_since);
  v.value("calm_centre", world.pace.calm_centre);
  v.value("calm_extent", world.pace.calm_extent);
  v.value("calm_velocity", world.pace.calm_velocity);
  v.value("particles_at_rest", world.pace.particles_at_rest);

  v.group("density");
  v.value("steps", world.density.steps);
  v.value("sum_of_means", world.density.sum_of_means);
  v.value("worst_mean", world.density.worst_mean);
  v.value("sum_of_compressions", world.density.sum_of_compressions);
  v.value("worst_mean_compression", world.density.worst_mean_compression);
  v.value("worst_particle", world.density.worst_particle);

  v.group("liquid");
  v.value("particle_mass", world.liquid.particle_mass);
  v.value("next_id", world.liquid.next_id);
  auto& particles = world.liquid.particles;
  v.array("position", particles.position);
  v.array("velocity", particles.velocity);
  v.array("id", particles.id);
  v.array("kind", particles.kind);
  v.array("density", particles.density);
  v.array("pressure", particles.pressure);
  v.array("warm_pressure", particles.warm_pressure);
  v.array("warm_divergence", particles.warm_divergence);
  v.array("owed_kg", particles.owed_kg);

  for (std::size_t i = 0; i < world.sources.size(); ++i) {
    v.group("sources/" + std::to_string(i));
    v.value("emitted", world.sources[i].emitted);
    v.value("carried", world.sources[i].carried);
    v.value("supplied_kg", world.sources[i].supplied_kg);
  }

  for (std::size_t i = 0; i < world.textiles.size(); ++i) {
    auto& textile = world.textiles[i];
    v.group("textiles/" + std::to_string(i));
    v.array("sorbed_kg", textile.contents.sorbed_kg);
    v.array("liquid_kg", textile.contents.liquid_kg);
    v.array("shell_regain", textile.contents.shell_regain);
    v.array("reached_saturation", textile.contents.reached_saturation);
    v.array("waiting_kg", textile.exchange.waiting_kg);
    v.value("normal_force", textile.exchange.normal_force);
    v.value("impulse", textile.exchange.impulse);
    v.value("contacts", textile.exchange.contacts);
    v.value("absorbed_particles", textile.exchange.absorbed_particles);
    v.value("released_particles", textile.exchange.released_particles);
    v.value("bounces", textile.exchange.bounces);
    if (textile.cloth) {
      visit_soft_sheet(v, textile.cloth->soft, "textiles/" + std::to_string(i) + "/sheet");
      v.value("borrowed_kg", textile.cloth->borrowed_kg);
    }
    for (std::size_t r = 0; r < textile.reservoirs.size(); ++r) {
      v.group("textiles/" + std::to_string(i) + "/reservoirs/" + std::to_string(r));
      v.value("supplied_kg", textile.reservoirs[r].supplied_kg);
    }
  }

  for (std::size_t i = 0; i < world.cell_cloths.size(); ++i) {
    auto& cloth = world.cell_cloths[i];
    visit_soft_sheet(v, cloth.soft, "cell_cloths/" + std::to_string(i));
    v.array("parcel_kg", cloth.contents.parcel_kg);
    v.array("parcel_place", cloth.contents.parcel_place);
    v.array("parcel_velocity", cloth.contents.parcel_velocity);
    v.array("content_kg", cloth.contents.content_kg);
    v.array("waiting_kg", cloth.waiting_kg);
    v.value("absorbed_particles", cloth.absorbed_particles);
    v.value("released_particles", cloth.released_particles);
    v.value("bounces", cloth.bounces);
    v.value("crossings", cloth.crossings);
  }
}

}  // namespace imbibe
