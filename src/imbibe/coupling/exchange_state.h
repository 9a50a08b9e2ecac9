// What textile and free liquid owe each other between steps: mass that was moved in the books but not yet as whole
// particles. A particle dies only when its whole mass was taken (Particles::owed_kg) and is born only when a queue holds
// one.
#pragma once

#include <vector>

#include "imbibe/core/types.h"

namespace imbibe {

struct ExchangeState {
  std::vector<Real> waiting_kg;  // per node: released by the textile, not yet a particle
  Real normal_force = 0;         // N, of the liquid on the sheet, averaged over about 2 ms
  Vec3 impulse{};                // N s, momentum given to the (fixed) textile since the start
  std::uint64_t contacts = 0;    // particle hits on yarns since the start
  std::uint64_t absorbed_particles = 0, released_particles = 0, bounces = 0;
};

}  // namespace imbibe
