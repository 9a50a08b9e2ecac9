// A small world with a real fabric in it, for tests of output: a plain-woven cotton swatch, 10 x 8 yarns, and liquid.
#pragma once

#include <memory>

#include "imbibe/sim/world.h"

namespace imbibe::testing {

inline std::shared_ptr<const Fabric> small_fabric(const std::string& fibre = "cotton", bool monofilament = false) {
  const FibreLibrary library = read_fibre_library({std::string(IMBIBE_SOURCE_DIR) + "/fibres"});
  FabricSpec spec;
  spec.size = {0.01, 0.008};
  spec.warp.fibre = spec.weft.fibre = fibre;
  spec.warp.diameter = spec.weft.diameter = 4e-4;
  spec.warp.density = spec.weft.density = 1000;  // 10 per cm: 10 ends along x, 8 picks along y, pitch 1 mm
  spec.warp.monofilament = spec.weft.monofilament = monofilament;
  return std::make_shared<const Fabric>(build_fabric(spec, library));
}

inline Textile small_textile(const std::string& name, std::shared_ptr<const Fabric> fabric, const Air& air) {
  Textile textile;
  textile.name = name;
  textile.fabric = std::move(fabric);
  textile.model = std::make_shared<const WettingModel>(build_wetting_model(textile.fabric->network, {}, {}));
  textile.contents = conditioned_contents(*textile.model, air);
  textile.exchange.waiting_kg.assign(textile.model->nodes(), 0);
  return textile;
}

inline World small_world(std::size_t particles = 20) {
  World world;
  world.textiles.push_back(small_textile("swatch", small_fabric(), world.air));
  for (const Real kg : world.textiles[0].contents.sorbed_kg) world.ledger.initial_kg += kg;
  world.liquid.particle_mass = 1e-8;
  for (std::size_t i = 0; i < particles; ++i) {
    add_particle(world.liquid, {1e-4 * static_cast<Real>(i), 0, 2e-3}, {0, 0, -0.3});
  }
  world.ledger.supplied_kg = world.liquid.mass();
  return world;
}

}  // namespace imbibe::testing
