// Liquid that the textile gives back: it waits at its node until it makes a whole particle, which is then born at a
// free place of the face near by. What opens a face leaves at its opening pressure, so the step gives no excess pressure
// and the particle starts at rest; a caller that knows an excess gets release_speed().
#pragma once

#include "imbibe/coupling/exchange_state.h"
#include "imbibe/coupling/face_map.h"
#include "imbibe/fabric/network.h"
#include "imbibe/liquid/particles.h"

namespace imbibe {

struct ReleaseReport {
  std::size_t particles = 0;
  Real kg = 0;
  Vec3 momentum{};  // N s, given to the new particles; the sheet takes the opposite
};

// Speed of liquid leaving under an excess pressure [m/s]: Torricelli, u = sqrt(2 dp / rho), 0 for dp <= 0.
Real release_speed(Real excess_pressure, Real density);

// Turns waiting mass into particles on the lower face (or the upper one when gravity points the other way) where the
// waiting mass within reach of a node is a whole particle and the place is free: no particle within 0.8 dx.
// `excess_pressure`: Pa by which the node's pressure is above what opens the face; indexed by node, may be empty.
ReleaseReport release_particles(const YarnNetwork& network, const Placement& placement, const FaceMap& map,
                                std::span<const Real> excess_pressure, const Vec3& gravity, ExchangeState& exchange,
                                Liquid& liquid);

}  // namespace imbibe
