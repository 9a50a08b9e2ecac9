#include "imbibe/coupling/absorption.h"

#include <algorithm>

namespace imbibe {

void book_taken(const Footprint& footprint, std::span<const Real> taken_kg, ExchangeState& exchange) {
  for (std::size_t s = 0; s < footprint.supplies.size(); ++s) {
    const Index node = footprint.supplies[s].node;
    Real& owed = exchange.owed_kg[node];
    owed += taken_kg[s];
    if (owed < 0) {
      exchange.waiting_kg[node] -= owed;
      owed = 0;
    }
  }
}

namespace {

// The debt over each touching particle: a node's debt is split over the particles above it by their shares.
std::vector<Real> debts(const Footprint& f, const ExchangeState& exchange) {
  std::vector<Real> cover(f.supplies.size(), 0), debt(f.particle.size(), 0);
  for (const FootprintLink& link : f.links) cover[f.supply_of_node[link.node]] += link.share;
  for (std::size_t p = 0; p < f.particle.size(); ++p)
    for (Index l = f.first_link[p]; l < f.first_link[p + 1]; ++l) {
      const FootprintLink& link = f.links[l];
      debt[p] += exchange.owed_kg[link.node] * link.share / cover[f.supply_of_node[link.node]];
    }
  return debt;
}

}  // namespace

Transfer absorb_particles(const Liquid& liquid, const Footprint& f, ExchangeState& exchange,
                          std::span<std::uint8_t> dead) {
  Transfer transfer;
  std::vector<Real> owed(f.patches.size(), 0);
  for (std::size_t s = 0; s < f.supplies.size(); ++s)
    owed[f.supply_patch[s]] += exchange.owed_kg[f.supplies[s].node];
  std::vector<std::size_t> dying(f.patches.size(), 0);
  bool any = false;
  for (std::size_t i = 0; i < f.patches.size(); ++i) {
    // A rounding of the division must not kill a particle that is short of 1e-12 of its mass: the debt stays >= 0.
    dying[i] = std::min(static_cast<std::size_t>(owed[i] / liquid.particle_mass), f.patches[i].particles);
    any = any || dying[i] > 0;
  }
  if (!any) return transfer;

  const std::vector<Real> debt = debts(f, exchange);
  std::vector<Index> order(f.particle.size());
  for (std::size_t p = 0; p < order.size(); ++p) order[p] = static_cast<Index>(p);
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return debt[a] > debt[b]; });
  std::vector<std::size_t> left = dying;
  for (const Index p : order) {
    if (left[f.patch_of[p]] == 0) continue;
    --left[f.patch_of[p]];
    const Index i = f.particle[p];
    dead[i] = 1;
    const Float4& v = liquid.particles.velocity[i];
    transfer.momentum += liquid.particle_mass * Vec3(v.x, v.y, v.z);
    ++transfer.particles;
  }
  for (std::size_t s = 0; s < f.supplies.size(); ++s) {
    const Index i = f.supply_patch[s];
    if (dying[i] == 0) continue;
    exchange.owed_kg[f.supplies[s].node] *= 1 - static_cast<Real>(dying[i]) * liquid.particle_mass / owed[i];
  }
  transfer.kg = liquid.particle_mass * static_cast<Real>(transfer.particles);
  exchange.absorbed_particles += transfer.particles;
  exchange.impulse += transfer.momentum;
  return transfer;
}

}  // namespace imbibe
