#include "imbibe/coupling/footprint.h"

#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "imbibe/coupling/absorption.h"
#include "support/faced_cloth.h"

namespace imbibe {
namespace {

struct Scene : test::FacedCloth {
  Footprint footprint;

  // A layer of particles that touches the face, side x side, centred on (x, y).
  void add_layer(int side, Real x, Real y) {
    const Real dx = liquid.spacing(), z = 0.5 * fabric.network.thickness + 0.5 * dx;
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i)
        add_particle(liquid, {x + (i - 0.5 * (side - 1)) * dx, y + (j - 0.5 * (side - 1)) * dx, z}, {0, 0, -0.1});
  }
  void find() { find_footprint(liquid, fabric.network, placement, map, {0, 0, -9.81}, exchange, footprint); }
  Real owed() const { return test::sum(liquid.particles.owed_kg); }
};

TEST(Footprint, SharesOfEveryTouchingParticleSumToOne) {
  Scene s;
  s.add_layer(8, 0, 0);
  s.find();
  ASSERT_EQ(s.footprint.particle.size(), 64u);
  for (std::size_t p = 0; p < 64; ++p) {
    Real sum = 0;
    for (Index l = s.footprint.first_link[p]; l < s.footprint.first_link[p + 1]; ++l) sum += s.footprint.links[l].share;
    EXPECT_NEAR(sum, 1, 1e-12);
  }
}

TEST(Footprint, AvailableMassIsTheMassOfTheTouchingParticlesLessTheirDebt) {
  Scene s;
  s.add_layer(8, 0, 0);
  for (const std::size_t i : {3, 17, 40, 41, 42}) s.liquid.particles.owed_kg[i] = 0.7 * s.liquid.particle_mass;
  s.find();
  Real available = 0;
  for (const FaceSupply& supply : s.footprint.supplies) available += supply.available_kg;
  EXPECT_NEAR(available, (64 - 3.5) * s.liquid.particle_mass, 1e-12 * 64 * s.liquid.particle_mass);
}

TEST(Footprint, AParticleWithoutAPlaceTouchesNothing) {  // as a damaged checkpoint may hold it
  Scene s;
  s.add_layer(2, 0, 0);
  s.liquid.particles.position[1].x = std::numeric_limits<float>::quiet_NaN();
  s.find();
  EXPECT_EQ(s.footprint.particle, (std::vector<Index>{0, 2, 3}));
}

TEST(Footprint, NodesUnderTheMiddleOfALayerAreFullyWetted) {
  Scene s;
  s.add_layer(16, 0, 0);
  s.find();
  int inner = 0;
  for (const FaceSupply& supply : s.footprint.supplies) {
    const Vec3& c = s.fabric.network.node_centre(supply.node);
    if (std::hypot(c.x, c.y) > 1.5e-3) continue;
    ++inner;
    // A square lattice of dx = reach/3 samples the kernel's integral within 2 %.
    EXPECT_NEAR(supply.wetted_share, 1, 0.02);
  }
  EXPECT_GT(inner, 10);
}

TEST(Footprint, TwoDistantDropsAreTwoPatchesAndAJoiningRowMakesOne) {
  Scene s;
  s.add_layer(4, -4e-3, 0);
  s.add_layer(4, 4e-3, 0);
  s.find();
  EXPECT_EQ(s.footprint.patches.size(), 2u);
  for (Real x = -4e-3; x <= 4e-3; x += 0.5e-3)
    add_particle(s.liquid, {x, 2e-3, 0.5 * s.fabric.network.thickness + 0.25e-3}, {});
  s.find();
  EXPECT_EQ(s.footprint.patches.size(), 1u);
}

TEST(Footprint, PressureIsForceOverAreaAndNeverMoreThanTheLiquidsTotalHead) {
  Scene s;
  s.add_layer(10, 0, 0);
  const Real area = 100 * s.liquid.spacing() * s.liquid.spacing();
  s.exchange.normal_force = 4e-4;
  s.find();
  EXPECT_NEAR(s.footprint.patches.front().pressure, 4e-4 / area, 1e-9);
  s.exchange.normal_force = 1;  // a spike of the first touch
  s.find();
  const Real height = 0.5 * s.fabric.network.thickness + 0.5 * s.liquid.spacing();
  const Real radius = std::cbrt(3 * 100 * std::pow(s.liquid.spacing(), 3) / (4 * pi));
  const Real head = 998.2 * (9.81 * height + 0.5 * 0.01) + 2 * 0.0728 / radius;  // speed 0.1 m/s
  EXPECT_NEAR(s.footprint.patches.front().pressure, head, 1e-5 * head);  // positions are float
}

TEST(Absorption, ParticlesDieForWholeMassesOnlyAndTheBooksAddUp) {
  Scene s;
  s.add_layer(8, 0, 0);
  s.find();
  std::vector<Real> taken(s.footprint.supplies.size());
  for (std::size_t i = 0; i < taken.size(); ++i) taken[i] = 0.07 * s.footprint.supplies[i].available_kg;
  const Real sum = std::accumulate(taken.begin(), taken.end(), 0.0);  // 0.07 * 64 = 4.48 particles
  book_taken(s.footprint, taken, s.liquid.particles, s.exchange);
  std::vector<std::uint8_t> dead(64, 0);
  const Transfer transfer = absorb_particles(s.liquid, s.footprint, s.exchange, dead);
  EXPECT_EQ(transfer.particles, 4u);
  EXPECT_EQ(std::accumulate(dead.begin(), dead.end(), 0), 4);
  EXPECT_NEAR(s.owed() + transfer.kg, sum, 1e-13 * sum);
  EXPECT_NEAR(transfer.momentum.z, -0.1 * 4 * s.liquid.particle_mass, 1e-7 * s.liquid.particle_mass);  // float speeds
  EXPECT_EQ(remove_particles(s.liquid.particles, dead), 4u);
  EXPECT_EQ(s.liquid.particles.size(), 60u);
}

TEST(Absorption, DebtsMoveWithTheirParticle) {
  Scene s;
  s.add_layer(1, -4e-3, 0);
  s.find();
  std::vector<Real> taken(s.footprint.supplies.size());
  for (std::size_t i = 0; i < taken.size(); ++i) taken[i] = 0.6 * s.footprint.supplies[i].available_kg;
  book_taken(s.footprint, taken, s.liquid.particles, s.exchange);
  s.liquid.particles.position[0].x += 8e-3f;  // it slides on to where no node was covered
  s.find();
  Real available = 0;
  for (const FaceSupply& supply : s.footprint.supplies) available += supply.available_kg;
  EXPECT_NEAR(available, 0.4 * s.liquid.particle_mass, 1e-12 * s.liquid.particle_mass);
}

TEST(Absorption, LiquidGivenBackPaysDebtsThenIsCreditAndWaitsOnceItMakesAParticle) {
  Scene s;
  s.add_layer(1, 0, 0);
  const Real mass = s.liquid.particle_mass;
  s.liquid.particles.owed_kg[0] = 0.2 * mass;
  s.find();
  std::vector<std::uint8_t> dead(1, 0);
  std::vector<Real> taken(s.footprint.supplies.size(), 0);
  taken[0] = -0.5 * mass;
  book_taken(s.footprint, taken, s.liquid.particles, s.exchange);
  absorb_particles(s.liquid, s.footprint, s.exchange, dead);
  EXPECT_NEAR(s.owed(), -0.3 * mass, 1e-12 * mass);
  taken[0] = -0.8 * mass;
  book_taken(s.footprint, taken, s.liquid.particles, s.exchange);
  absorb_particles(s.liquid, s.footprint, s.exchange, dead);
  EXPECT_EQ(s.owed(), 0);
  EXPECT_NEAR(std::accumulate(s.exchange.waiting_kg.begin(), s.exchange.waiting_kg.end(), 0.0), 1.1 * mass, 1e-12 * mass);
}

TEST(Absorption, ADebtorDiesBesideParticlesWithCreditAndTheBooksAddUp) {
  Scene s;
  s.add_layer(2, 0, 0);
  const Real mass = s.liquid.particle_mass;
  s.liquid.particles.owed_kg = {1.2 * mass, -0.03 * mass, -0.04 * mass, -0.03 * mass};
  s.find();
  std::vector<std::uint8_t> dead(4, 0);
  const Transfer transfer = absorb_particles(s.liquid, s.footprint, s.exchange, dead);
  ASSERT_EQ(transfer.particles, 1u);
  const Real waiting = std::accumulate(s.exchange.waiting_kg.begin(), s.exchange.waiting_kg.end(), 0.0);
  EXPECT_NEAR(s.owed() - waiting + transfer.kg, 1.1 * mass, 1e-12 * mass);
}

TEST(Absorption, MassThatWaitsOnTheFaceIsTakenBackFirst) {
  Scene s;
  s.add_layer(1, 0, 0);
  s.find();
  const Index node = s.footprint.supplies[0].node;
  const Real mass = s.liquid.particle_mass, before = s.footprint.supplies[0].available_kg;
  s.exchange.waiting_kg[node] = 0.1 * mass;
  s.find();
  ASSERT_EQ(s.footprint.supplies[0].node, node);
  EXPECT_NEAR(s.footprint.supplies[0].available_kg, before + 0.1 * mass, 1e-12 * mass);
  std::vector<Real> taken(s.footprint.supplies.size(), 0);
  taken[0] = 0.15 * mass;
  book_taken(s.footprint, taken, s.liquid.particles, s.exchange);
  EXPECT_NEAR(s.exchange.waiting_kg[node], 0, 1e-12 * mass);
  EXPECT_NEAR(s.owed(), 0.05 * mass, 1e-12 * mass);
}

}  // namespace
}  // namespace imbibe
