// Liquid that the textile gives back: it waits at its node until it makes a whole particle, which is then born at a
// free place of the face near by.
//
//   u = min( sqrt(2 dp / rho), q / A )
//
//   u    m/s    speed, out of the face, of what leaves in this step; what waited from earlier steps is at rest
//   dp   Pa     pressure of the node at the face above its opening pressure (wetting/transport.h)
//   q    m3/s   flow out of the node; A m2 its mouth: the gap between the yarns, or half the surface of the segment
// Torricelli, as far as the flow fills the mouth: most of dp is spent on friction in the throat, and u never exceeds what
// continuity gives. A particle has the momentum of what it was made of, so it has no more energy than dp gave. On a sheet
// that moves it has the sheet's velocity besides.
// Which face: the one that is lower, where the pressure reaches the opening first (by rho g t); the other one where a
// solid closes the lower, or where liquid already hangs there and the pressure suffices above too.
// Source: seed A section 5.1 (reborn with the speed that the pressure difference gives); the form is ours.
// Tested in tests/coupling/release_test.cpp.
#pragma once

#include <functional>
#include <span>

#include "imbibe/coupling/embedding.h"
#include "imbibe/coupling/exchange_state.h"
#include "imbibe/coupling/face_map.h"
#include "imbibe/fabric/network.h"
#include "imbibe/liquid/particles.h"
#include "imbibe/wetting/wetting_step.h"

namespace imbibe {

struct ReleaseReport {
  std::size_t particles = 0;
  Real kg = 0;
  Vec3 momentum{};  // N s, given to the new particles; the sheet takes the opposite
  std::vector<Vec3> places;  // m, in sheet coordinates, where each was born, in the order of the new particles
};

// The equation. 0 for dp <= 0.
Real release_speed(Real excess_pressure, Real density, Real flow, Real mouth_area);

// m2, through which a node gives off to one face.
Real mouth_area(const YarnNetwork& network, Index node);

// Whether a solid is at a place of the world.
using SolidAt = std::function<bool(const Vec3&)>;

// Adds `released` to what waits and turns waiting mass into particles where that within reach of a node is a whole
// particle and the place is free: no particle within 0.8 dx, no solid.
ReleaseReport release_particles(const YarnNetwork& network, const ClothPlace& place, const FaceMap& map,
                                std::span<const ReleasedLiquid> released, const Vec3& gravity, const SolidAt& solid_at,
                                ExchangeState& exchange, Liquid& liquid);

}  // namespace imbibe
