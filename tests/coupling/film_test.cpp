#include "imbibe/coupling/film.h"

#include <gtest/gtest.h>

#include "imbibe/coupling/absorption.h"
#include "support/faced_cloth.h"

namespace imbibe {
namespace {

// A layer of particles on cotton whose pores have a pressure within a radius of the middle.
struct Scene : test::FacedCloth {
  WettingModel model;
  Contents contents;
  Footprint footprint;

  Scene(Real full_radius, Real spacing = 0.5e-3, Real pressure = 0) {
    model = build_wetting_model(fabric.network, {}, {});
    contents = conditioned_contents(model, {});
    liquid.particle_mass = 998.2 * spacing * spacing * spacing;
    map = build_face_map(fabric.network, spacing);
    for (std::size_t k = model.segments; k < model.nodes(); ++k) {
      const Vec3& c = fabric.network.node_centre(k);
      if (std::hypot(c.x, c.y) < full_radius) 
        contents.liquid_kg[k] = 998.2 * current_volume(model, contents, k) * saturation_at(retention_of(model.at(k)), pressure);
    }
  }
  void add_layer(int columns, int rows) {
    const Real dx = liquid.spacing(), z = 0.5 * fabric.network.thickness + 0.5 * dx;
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i)
        add_particle(liquid, {(i - 0.5 * (columns - 1)) * dx, (j - 0.5 * (rows - 1)) * dx, z}, {});
  }
  void spread() {
    find_footprint(liquid, fabric.network, placement, map, {0, 0, -9.81}, exchange, footprint);
    spread_films(liquid, map, model, contents, exchange, footprint);
  }
  // m2 of pores under liquid, by the footprint's shares.
  Real wetted_area() const {
    Real area = 0;
    for (const FaceSupply& s : footprint.supplies)
      if (s.node >= model.segments) area += s.wetted_share * map.face_area[s.node];
    return area;
  }
};

// Wet cotton recedes at arccos(.5 cos 10 + .5) = 7.06 degrees; cap of height a tan(theta/2) and volume pi h (3 a^2 + h^2)/6.
Real base_of_cotton_cap(Real volume) {
  const Real slope = std::tan(0.5 * std::acos(0.5 * std::cos(radians(10)) + 0.5));
  const Real a = std::cbrt(6 * volume / (pi * slope * (3 + slope * slope)));
  return pi * a * a;
}

TEST(Film, ACapsBaseMeetsTheTableOfSessileDrops) {
  // a/R0 at 30, 90 and 150 degrees, given to four digits.
  const Real volume = 4 * pi / 3;
  for (const auto& [angle, ratio] : {std::pair{30.0, 2.134}, {90.0, 1.260}, {150.0, 0.5022}})
    EXPECT_NEAR(std::sqrt(cap_base_area(volume, std::cos(radians(angle))) / pi), ratio, 0.0005);
  EXPECT_TRUE(std::isinf(cap_base_area(1, 1)));
}

TEST(Film, OnFlushPoresItCoversTheBaseOfItsCapWhateverTheSizeOfItsParticles) {
  Scene coarse(6e-3), fine(6e-3, 0.25e-3);
  coarse.add_layer(4, 4);  // 2 uL, 4 mm2
  fine.add_layer(16, 8);   // 2 uL, 8 mm2
  for (Scene* s : {&coarse, &fine}) {
    s->spread();
    // 24 mm2; the receding angle of cotton is 10 degrees in float, and the mass of a particle is 998.2 dx^3.
    EXPECT_NEAR(s->wetted_area(), base_of_cotton_cap(2e-9), 1e-4 * base_of_cotton_cap(2e-9));
  }
}

TEST(Film, ItGoesNoFartherThanPoresAreFlush) {
  Scene s(2e-3);
  s.add_layer(4, 4);
  s.spread();
  for (const FaceSupply& supply : s.footprint.supplies) {
    if (supply.node < s.model.segments || supply.wetted_share <= 0) continue;
    const Vec3& c = s.fabric.network.node_centre(supply.node);
    // The kernel of the particles alone reaches 1.5 mm beyond their square of 2 mm.
    const bool by_particles = std::abs(c.x) < 0.75e-3 + s.map.reach && std::abs(c.y) < 0.75e-3 + s.map.reach;
    EXPECT_TRUE(by_particles || std::hypot(c.x, c.y) < 2e-3);
    if (std::hypot(c.x, c.y) < 2e-3) {
      EXPECT_NEAR(supply.wetted_share, 1, 1e-12);
    }
  }
}

TEST(Film, OverDryPoresAndOnYarnsThatRejectNothingChanges) {
  Scene dry(0);
  dry.add_layer(4, 4);
  dry.spread();
  Footprint plain;
  find_footprint(dry.liquid, dry.fabric.network, dry.placement, dry.map, {0, 0, -9.81}, dry.exchange, plain);
  ASSERT_EQ(dry.footprint.supplies.size(), plain.supplies.size());
  for (std::size_t i = 0; i < plain.supplies.size(); ++i) {
    EXPECT_EQ(dry.footprint.supplies[i].wetted_share, plain.supplies[i].wetted_share);
    EXPECT_EQ(dry.footprint.supplies[i].available_kg, plain.supplies[i].available_kg);
  }
  Scene rejecting(6e-3);
  std::fill(rejecting.map.cos_receding.begin(), rejecting.map.cos_receding.end(), -1.0f);
  rejecting.add_layer(4, 4);
  rejecting.spread();
  EXPECT_LT(rejecting.wetted_area(), 4.5e-6);
}

TEST(Film, PoresThatTheirYarnsHaveFilledAreNoPartOfIt) {
  Scene s(6e-3, 0.5e-3, -100);  // P_e is 343 Pa here
  s.add_layer(4, 4);
  s.spread();
  EXPECT_LT(s.wetted_area(), 4.5e-6);
}

TEST(Film, ItOffersWhatItsParticlesHoldAndTheyOweWhatItGave) {
  Scene s(6e-3);
  s.add_layer(4, 4);
  s.liquid.particles.owed_kg[5] = 0.5 * s.liquid.particle_mass;
  s.exchange.waiting_kg[s.model.segments] = 0.25 * s.liquid.particle_mass;  // far away, no part of the film
  s.spread();
  Real offered = 0;
  std::vector<Real> taken;
  for (std::size_t i = 0; i < s.footprint.supplies.size(); ++i) {
    offered += s.footprint.supplies[i].available_kg;
    taken.push_back(s.footprint.supply_patch[i] == no_index ? 0 : 0.1 * s.footprint.supplies[i].available_kg);
  }
  EXPECT_NEAR(offered, 15.75 * s.liquid.particle_mass, 1e-12 * s.liquid.particle_mass);
  book_taken(s.footprint, taken, s.liquid.particles, s.exchange);
  EXPECT_EQ(s.footprint.patches.size(), 1u);
  EXPECT_NEAR(test::sum(s.liquid.particles.owed_kg), (0.5 + 1.55) * s.liquid.particle_mass, 1e-12 * s.liquid.particle_mass);
}

}  // namespace
}  // namespace imbibe
