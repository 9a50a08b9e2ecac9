// Drops at the hem of a woven soft sheet.
#include "imbibe/coupling/hem_drops.h"

#include <gtest/gtest.h>

#include <numeric>

#include "support/woven.h"

namespace imbibe {
namespace {

constexpr Vec3 down{0, 0, -9.81};

struct Hanging {
  Fabric fabric = test::woven("cotton", "cotton", 20);
  Placement upright{.origin = {}, .u = {1, 0, 0}, .v = {0, 0, 1}, .n = {0, -1, 0}};
  ExchangeState exchange;
  Liquid liquid;
  Hem hem;
  Real neck = 0;

  Hanging() {
    exchange.waiting_kg.assign(fabric.network.nodes(), 0);
    liquid.particle_mass = 1e-6;
    neck = hem_neck(liquid.kind.surface_tension, liquid.kind.density, 9.81);
    find_hem(fabric.network, upright, down, neck, hem);
  }
  ReleaseReport release() {
    return release_hem_drops(fabric.network, upright, hem, down, neck, {}, exchange, liquid);
  }
  Real waiting() const { return std::accumulate(exchange.waiting_kg.begin(), exchange.waiting_kg.end(), Real{0}); }
};

TEST(HemDrops, OnlyTheLowerEdgeHoldsDrops) {
  Hanging cloth;
  const YarnNetwork& n = cloth.fabric.network;
  for (std::size_t k = 0; k < n.nodes(); ++k) {
    const Vec3& c = n.node_centre(k);
    const Real to_hem = c.y + 0.5 * n.size_y, to_side = 0.5 * n.size_x - std::abs(c.x);
    if (std::abs(to_hem - to_side) < 1e-9) continue;  // on the diagonal both edges are as near
    const bool lowest = to_hem < to_side && to_hem <= cloth.neck;
    EXPECT_EQ(cloth.hem.holds[k] != 0, lowest) << c.x << " " << c.y;
  }
  Hem flat;
  find_hem(n, Placement{}, down, cloth.neck, flat);  // a level cloth has no lower edge
  EXPECT_TRUE(flat.nodes.empty());
}

TEST(HemDrops, OneFallsAtTatesMassAndNotBefore) {
  Hanging cloth;
  const Real tate = falling_drop_kg(cloth.neck, 0.0728, 9.81);
  EXPECT_NEAR(tate, 57.2e-6, 0.3e-6);  // 0.6 2 pi 2.045 mm gamma/g
  std::vector<Index> middle;
  for (Index k = 0; k < cloth.hem.holds.size(); ++k)
    if (cloth.hem.holds[k] && std::abs(cloth.fabric.network.node_centre(k).x) < 1.5e-3) middle.push_back(k);
  ASSERT_GT(middle.size(), 3u);
  for (const Index k : middle) cloth.exchange.waiting_kg[k] = 0.9 * tate / static_cast<Real>(middle.size());
  EXPECT_EQ(cloth.release().particles, 0u);
  for (const Index k : middle) cloth.exchange.waiting_kg[k] *= 1.2;
  const Real before = cloth.waiting();
  const ReleaseReport drop = cloth.release();
  EXPECT_EQ(drop.particles, 57u);
  EXPECT_NEAR(cloth.waiting(), before - 57e-6, 1e-12 * before);
  Bounds box;
  for (const Float4& x : cloth.liquid.particles.position) box.include({x.x, x.y, x.z});
  const Real hem = -0.5 * cloth.fabric.network.size_y;
  EXPECT_LT(box.upper.z, hem);
  EXPECT_LT(box.size().z, 6e-3);  // one round drop: 57 mm3 are 4.8 mm wide
  EXPECT_LT(box.size().x, 6e-3);
  EXPECT_EQ(cloth.release().particles, 0u);
}

TEST(HemDrops, WhatHangsIsShownAsDropsOfItsMassUnderTheHem) {
  Hanging cloth;
  const YarnNetwork& n = cloth.fabric.network;
  Real total = 0;
  for (const Index k : cloth.hem.nodes) {  // one drop at the left, one at the right
    const Real x = n.node_centre(k).x;
    if (std::abs(std::abs(x) - 6e-3) > 1e-3) continue;
    cloth.exchange.waiting_kg[k] = x < 0 ? 1e-6 : 2e-6;
    total += cloth.exchange.waiting_kg[k];
  }
  const std::vector<HangingDrop> drops = drops_at_hem(n, cloth.upright, cloth.hem, cloth.neck, cloth.exchange);
  ASSERT_EQ(drops.size(), 2u);
  EXPECT_NEAR(drops[0].kg + drops[1].kg, total, 1e-12 * total);
  EXPECT_NEAR(drops[0].kg, 2 * drops[1].kg, 0.3 * drops[0].kg);
  EXPECT_GT(drops[0].at.x, 4e-3);
  EXPECT_LT(drops[1].at.x, -4e-3);
  for (const HangingDrop& drop : drops) EXPECT_NEAR(drop.at.z, -0.5 * n.size_y, 1e-9);
}

TEST(HemDrops, WhatComesTooFastForDropsLeavesAsAStream) {
  Hanging cloth;
  for (Index k = 0; k < cloth.hem.holds.size(); ++k)
    if (cloth.hem.holds[k]) cloth.exchange.waiting_kg[k] = 20e-6;
  EXPECT_GT(cloth.release().particles, 100u);
  cloth.release();  // what is born now keeps clear of the first too
  for (std::size_t i = 0; i < cloth.liquid.particles.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Float4 &a = cloth.liquid.particles.position[i], &b = cloth.liquid.particles.position[j];
      EXPECT_GE(std::hypot(a.x - b.x, a.y - b.y, a.z - b.z), 0.8 * cloth.liquid.spacing() * (1 - 1e-5));
    }
}

}  // namespace
}  // namespace imbibe
