// Absorption through accumulators: the network takes mass in any amount; a particle dies only when its whole mass has
// been taken, so no mass is ever rounded.
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

// Adds what the network took from each supply to the debts of its node. A negative amount (given back to the liquid
// above) pays debts first; what it exceeds them by waits to become particles.
void book_taken(const Footprint& footprint, std::span<const Real> taken_kg, ExchangeState& exchange);

// In each patch, while its debt holds whole particles, the touching particles with the largest debt die (dead[i] = 1),
// and the patch's debts shrink in proportion. Particles of the smallest index first on a tie.
Transfer absorb_particles(const Liquid& liquid, const Footprint& footprint, ExchangeState& exchange,
                          std::span<std::uint8_t> dead);

}  // namespace imbibe
