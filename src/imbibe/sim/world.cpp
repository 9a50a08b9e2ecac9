#include "imbibe/sim/world.h"

#include <algorithm>
#include <numeric>

namespace imbibe {

bool any_soft_sheet(const World& world) {
  return !world.cell_cloths.empty() || std::any_of(world.textiles.begin(), world.textiles.end(),
                                                   [](const Textile& textile) { return textile.cloth.has_value(); });
}

Real MassBalance::error() const {
  const Real before = initial + supplied;
  const Real now = free + sorbed + yarn + pore + cell + evaporated + left;
  return before > 0 ? std::abs(now - before) / before : std::abs(now);
}

static Real sum(const std::vector<Real>& values, std::size_t begin, std::size_t end) {
  return std::accumulate(values.begin() + static_cast<std::ptrdiff_t>(begin),
                         values.begin() + static_cast<std::ptrdiff_t>(end), Real{0});
}

MassBalance mass_balance(const World& world) {
  MassBalance b;
  // Particles that are still there but no longer own all their mass, and mass that is not a particle yet.
  const std::vector<Real>& owed = world.liquid.particles.owed_kg;
  b.free = world.liquid.mass() - sum(owed, 0, owed.size());
  for (const Textile& textile : world.textiles) {
    const std::size_t segments = textile.fabric->network.segments(), nodes = textile.fabric->network.nodes();
    b.sorbed += sum(textile.contents.sorbed_kg, 0, textile.contents.sorbed_kg.size());
    b.yarn += sum(textile.contents.liquid_kg, 0, segments);
    b.pore += sum(textile.contents.liquid_kg, segments, nodes);
    b.free += sum(textile.exchange.waiting_kg, 0, textile.exchange.waiting_kg.size());
  }
  for (const CellCloth& cloth : world.cell_cloths) {
    b.cell += cell_kg(cloth);
    b.free += waiting_kg(cloth);
  }
  b.evaporated = world.ledger.evaporated_kg;
  b.left = world.ledger.left_kg;
  b.supplied = world.ledger.supplied_kg;
  b.initial = world.ledger.initial_kg;
  return b;
}

}  // namespace imbibe
