// Drops that hang under a wet soft cloth: how large they grow, where they hang, when they fall.
//
//   m = f 2 pi r gamma / g,   r = 0.75 sqrt(gamma/(rho g))
//
// m kg, what breaks off; r m, radius of the drop's neck; gamma N/m; rho kg/m3; g m/s2; f 0.6, the part of the hanging drop
// that falls. Water: r = 2 mm, m = 57 mg.
// Source: Tate, Phil. Mag. 27 (1864) 176; f: Harkins & Brown, J. Am. Chem. Soc. 41 (1919) 499, 0.60 to 0.65 for r/V^(1/3)
// from 0.7 to 1.2 and up to 0.75 for narrower necks. A hem has no rim that would set r: liquid wets it, and the neck is as
// wide as the drop lets it be, about three quarters of the capillary length (drops from wet cloth and from taps weigh 40 to
// 60 mg). Assumes it fills slowly against its own swinging (5 ms).
// What a woven sheet gives off within a neck of a lower edge runs into one drop there, which falls whole when it has that
// mass; until then the yarns may take it back. So does free liquid that runs down a face slowly enough to be stopped by the
// drop, v < sqrt(2 g r). (A sheet's edge is no wall of the free liquid: a drop of single particles would not hang there.)
// Edges that look up or stand upright hold none: what comes out there runs down the faces. Cloths of cells hold drops where
// they leak (cell_cloth.h). A hanging drop is mass of its cloth, shown as the particles that it will be (hanging_drop).
// Tested in tests/coupling/hem_drops_test.cpp and cell_cloth_test.cpp.
#pragma once

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "imbibe/coupling/release.h"

namespace imbibe {

constexpr Real falling_part = 0.6;

// kg; infinite without gravity.
constexpr Real falling_drop_kg(Real neck_radius, Real surface_tension, Real gravity) {
  return gravity > 0 ? falling_part * 2 * pi * neck_radius * surface_tension / gravity
                     : std::numeric_limits<Real>::infinity();
}

// In particle spacings: how far under the cloth the highest particle of a hanging drop is, and how near to others one may be
// born (nearer it would start with a pressure burst). What comes faster than drops can fall leaves as it comes.
constexpr Real hanging_spacings = 0.6, clear_spacings = 0.8, drops_of_a_stream = 3;

// m, from the origin: `count` particles as a drop that hangs under it; the points of a cubic lattice nearest to one of them,
// the highest `top` spacings below.
std::vector<Vec3> hanging_drop(std::size_t count, Real spacing, Real top, const Vec3& down);

Real hem_neck(Real surface_tension, Real density, Real gravity);  // m

// The nodes whose liquid hangs at a lower edge of the cloth as it lies now.
struct Hem {
  std::vector<std::uint8_t> holds;  // 1 per such node of the network
  std::vector<Index> nodes;         // they
};
void find_hem(const YarnNetwork& network, const ClothPlace& place, const Vec3& gravity, Real neck, Hem& hem);

// What hangs now. `kg` of all of them add up to what waits at the hem.
struct HangingDrop {
  Vec3 at{};  // m, in the world: where it hangs
  Real kg = 0;
};
std::vector<HangingDrop> drops_at_hem(const YarnNetwork& network, const ClothPlace& place, const Hem& hem, Real neck,
                                      const ExchangeState& exchange);

// Waiting masses within `reach` of the greatest one of them make one drop there, and so on. near(a, b): whether b is.
template <class Near>
std::vector<std::pair<Index, Real>> gather_drops(std::span<const Index> places, std::span<const Real> waiting_kg, Near&& near) {
  std::vector<Index> left;
  for (const Index k : places)
    if (waiting_kg[k] > 0) left.push_back(k);
  std::stable_sort(left.begin(), left.end(), [&](Index a, Index b) { return waiting_kg[a] > waiting_kg[b]; });
  std::vector<std::pair<Index, Real>> drops;
  while (!left.empty()) {
    const Index top = left.front();
    Real kg = 0;
    for (const Index k : left) kg += near(top, k) ? waiting_kg[k] : 0;
    drops.push_back({top, kg});
    std::erase_if(left, [&](Index k) { return k == top || near(top, k); });
  }
  return drops;
}

// Particles on the faces at a lower edge that run into the drop there: they become waiting mass, and their momentum the
// cloth's. Returns what they owed, kg; it has been paid.
struct CaughtAtHem {
  std::size_t particles = 0;
  Real owed_kg = 0;
};
CaughtAtHem catch_at_hem(const YarnNetwork& network, const ClothPlace& place, const Hem& hem, const Vec3& gravity,
                         Real neck, SoftSheet& soft, std::span<const std::uint8_t> held, ExchangeState& exchange, Liquid& liquid, std::span<std::uint8_t> dead);

// Gives off the drops that fall. `report.places` say where on the sheet each particle came from.
ReleaseReport release_hem_drops(const YarnNetwork& network, const ClothPlace& place, const Hem& hem, const Vec3& gravity, Real neck,
                                const SolidAt& solid_at, ExchangeState& exchange,
                                Liquid& liquid);

}  // namespace imbibe
