#include "imbibe/coupling/absorption.h"

#include <algorithm>

namespace imbibe {

void book_taken(const Footprint& f, std::span<Real> taken_kg, Particles& particles, ExchangeState& exchange) {
  for (std::size_t s = 0; s < f.supplies.size(); ++s) {  // what waits on the face goes first
    Real& waiting = exchange.waiting_kg[f.supplies[s].node];
    const Real from_film = f.supply_patch[s] == no_index ? taken_kg[s] : std::clamp(taken_kg[s], 0.0, std::max(waiting, 0.0));
    waiting -= from_film;
    taken_kg[s] -= from_film;
  }
  std::vector<Real> cover(f.supplies.size(), 0);
  for (const FootprintLink& link : f.links) cover[f.supply_of_node[link.node]] += link.share;
  std::vector<Real> from_film(f.patches.size(), 0);  // beyond the particles (film.h): owed by all of the patch
  for (std::size_t s = 0; s < f.supplies.size(); ++s) {
    if (f.supply_patch[s] != no_index && !(cover[s] > 0))
      from_film[f.supply_patch[s]] += taken_kg[s] / static_cast<Real>(f.patches[f.supply_patch[s]].particles);
  }
  for (std::size_t p = 0; p < f.particle.size(); ++p) {
    Real& owed = particles.owed_kg[f.particle[p]];
    owed += from_film[f.patch_of[p]];
    for (Index l = f.first_link[p]; l < f.first_link[p + 1]; ++l) {
      const Index s = f.supply_of_node[f.links[l].node];
      owed += taken_kg[s] * (f.links[l].share / cover[s]);
    }
  }
}

namespace {

// Liquid given back to a patch is credit of its particles (they owe less than nothing) until it makes a whole particle.
void turn_credit_into_waiting_mass(const Liquid& liquid, const Footprint& f, std::span<const Real> total,
                                   std::vector<Real>& owed_kg, ExchangeState& exchange) {
  for (std::size_t p = 0; p < f.particle.size(); ++p) {
    const Index i = f.patch_of[p];
    if (total[i] > -liquid.particle_mass) continue;
    const Real due = std::min(owed_kg[f.particle[p]], 0.0);
    owed_kg[f.particle[p]] -= due;
    exchange.waiting_kg[f.links[f.first_link[p]].node] -= due;
  }
}

// Passes what is left of the patches' debts to their survivors: each owes in proportion to what it owed.
void pass_on_debts(const Liquid& liquid, const Footprint& f, std::span<const std::size_t> dying,
                   std::span<const Real> total, std::span<const std::uint8_t> dead, std::vector<Real>& owed_kg,
                   ExchangeState& exchange) {
  std::vector<Real> surviving(f.patches.size(), 0);
  for (std::size_t p = 0; p < f.particle.size(); ++p)
    if (!dead[f.particle[p]]) surviving[f.patch_of[p]] += owed_kg[f.particle[p]];
  std::vector<std::uint8_t> settled(f.patches.size(), 0);
  for (std::size_t p = 0; p < f.particle.size(); ++p) {
    const Index i = f.patch_of[p];
    if (dying[i] == 0 || dead[f.particle[p]] || surviving[i] <= 0) continue;
    const Real left = total[i] - static_cast<Real>(dying[i]) * liquid.particle_mass;
    owed_kg[f.particle[p]] *= std::max(left, 0.0) / surviving[i];
    settled[i] = left >= 0;
  }
  // A patch without debtors left: the difference (rounding, or debts that the dead owed beyond their mass) stays in
  // the books as waiting mass, negative where a neighbour will have to pay. Survivors may have credit on balance, which
  // they keep.
  for (std::size_t p = 0; p < f.particle.size(); ++p) {
    const Index i = f.patch_of[p];
    if (dying[i] == 0 || settled[i]) continue;
    settled[i] = 1;
    const Real kept = std::min(surviving[i], 0.0);
    exchange.waiting_kg[f.links[f.first_link[p]].node] -=
        total[i] - static_cast<Real>(dying[i]) * liquid.particle_mass - kept;
  }
}

}  // namespace

Transfer absorb_particles(Liquid& liquid, const Footprint& f, ExchangeState& exchange, std::span<std::uint8_t> dead) {
  Transfer transfer;
  std::vector<Real>& owed = liquid.particles.owed_kg;
  std::vector<Real> total(f.patches.size(), 0);
  for (std::size_t p = 0; p < f.particle.size(); ++p) total[f.patch_of[p]] += owed[f.particle[p]];
  std::vector<std::size_t> dying(f.patches.size(), 0);
  bool any = false;
  for (std::size_t i = 0; i < f.patches.size(); ++i) {
    // A particle short of a thousandth of its mass dies too: that remainder waits on the face and is taken from there.
    const Real whole = std::max(total[i] / liquid.particle_mass + 1e-3, 0.0);
    dying[i] = std::min(static_cast<std::size_t>(whole), f.patches[i].particles);
    any = any || dying[i] > 0;
  }
  turn_credit_into_waiting_mass(liquid, f, total, owed, exchange);
  if (!any) return transfer;

  std::vector<Index> order(f.particle.size());
  for (std::size_t p = 0; p < order.size(); ++p) order[p] = static_cast<Index>(p);
  // The liquid is drawn from the drop as a whole, and its contact line is held by hysteresis: a particle that died at
  // the rim would tear the line back by a spacing. So those with liquid all around die first.
  const auto at_rim = [&](Index p) { return liquid.particles.kind[f.particle[p]] == ParticleClass::liquid_vapour; };
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
    if (at_rim(a) != at_rim(b)) return at_rim(b);
    return owed[f.particle[a]] > owed[f.particle[b]];
  });
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
  pass_on_debts(liquid, f, dying, total, dead, owed, exchange);
  for (const Index i : f.particle)
    if (dead[i]) owed[i] = 0;
  transfer.kg = liquid.particle_mass * static_cast<Real>(transfer.particles);
  exchange.absorbed_particles += transfer.particles;
  exchange.impulse += transfer.momentum;
  return transfer;
}

}  // namespace imbibe
