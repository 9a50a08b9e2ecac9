// Absorption through accumulators: the network takes mass in any amount; a particle dies only when its whole mass has
// been taken, so no mass is ever rounded. What a particle owes moves with it (Particles::owed_kg).
// Tested in tests/coupling/footprint_test.cpp.
#pragma once

#include <span>

#include "imbibe/coupling/footprint.h"

namespace imbibe {

// What left one side and reached the other. Applied to both sides by the caller's books.
struct Transfer {
  Real kg = 0;
  Vec3 momentum{};  // N s, of the particles that died
  std::size_t particles = 0;
};

// Books what the network took from each supply: first from the mass that waits on the face there, the rest as debts of
// the particles above it, by their shares (taken_kg is left with that rest). A negative amount is given back to the
// liquid above: it pays debts and becomes credit (negative debt).
void book_taken(const Footprint& footprint, std::span<Real> taken_kg, Particles& particles,
                ExchangeState& exchange);

// In each patch, while its debts hold whole particles, touching particles die (dead[i] = 1): those away from the rim
// first, of these the ones that owe most, the smallest index on a tie. What they owed short of or beyond their mass
// passes to the patch's other particles. Credit that makes a whole particle waits on the face to become one.
Transfer absorb_particles(Liquid& liquid, const Footprint& footprint, ExchangeState& exchange,
                          std::span<std::uint8_t> dead);

}  // namespace imbibe
