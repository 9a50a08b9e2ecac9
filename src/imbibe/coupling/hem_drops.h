// Drops that hang at the hem of a woven soft sheet. What the network gives off within a drop's neck of a lower edge runs
// into one drop there, which falls when it has the mass at which drops fall (wetting/hem_drop.h); until then the yarns may
// take it back. So does free liquid that runs down a face slowly enough to be stopped by the drop, v < sqrt(2 g r). (A
// sheet's edge is no wall of the free liquid: a drop of single particles would not hang there.)
//
//   neck r = 0.75 sqrt(gamma/(rho g)),  falls at 0.6 2 pi r gamma/g: 2 mm and 57 mg for water
//
// Edges that look up or stand upright hold none: what comes out there runs down the faces.
// Tested in tests/coupling/hem_drops_test.cpp.
#pragma once

#include <span>
#include <vector>

#include "imbibe/coupling/release.h"

namespace imbibe {

// m, from the origin: `count` particles as a drop that hangs under it; the points of a cubic lattice nearest to one of them,
// the highest `top` spacings below.
std::vector<Vec3> hanging_drop(std::size_t count, Real spacing, Real top, const Vec3& down);

Real hem_neck(Real surface_tension, Real density, Real gravity);  // m

// The nodes whose liquid hangs at a lower edge of the cloth as it lies now; 1 per such node of the network.
void find_hem(const YarnNetwork& network, const ClothPlace& place, const Vec3& gravity, Real neck,
              std::vector<std::uint8_t>& at_hem);

// Particles on the faces at a lower edge that run into the drop there: they become waiting mass, and their momentum the
// cloth's. Returns what they owed, kg; it has been paid.
struct CaughtAtHem {
  std::size_t particles = 0;
  Real owed_kg = 0;
};
CaughtAtHem catch_at_hem(const YarnNetwork& network, const ClothPlace& place, std::span<const std::uint8_t> at_hem,
                         const Vec3& gravity, Real neck, SoftSheet& soft, std::span<const std::uint8_t> held,
                         ExchangeState& exchange, Liquid& liquid, std::span<std::uint8_t> dead);

// Gives off the drops that fall. `report.places` say where on the sheet each particle came from.
ReleaseReport release_hem_drops(const YarnNetwork& network, const ClothPlace& place, std::span<const std::uint8_t> at_hem,
                                const Vec3& gravity, Real neck, const SolidAt& solid_at, ExchangeState& exchange,
                                Liquid& liquid);

}  // namespace imbibe
