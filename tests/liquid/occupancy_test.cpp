// Free places against all pairs.
#include "imbibe/liquid/occupancy.h"

#include <gtest/gtest.h>

#include "imbibe/geometry/sampling.h"

namespace imbibe {
namespace {

TEST(Occupancy, APlaceIsFreeWhereNoParticleOfTheRegionIsNearer) {
  const Bounds region{{-0.05, -0.05, -0.02}, {0.05, 0.05, 0.02}}, wider{{-0.06, -0.06, -0.06}, {0.06, 0.06, 0.06}};
  constexpr Real clearance = 0.006;
  std::vector<Float4> particles;
  std::vector<Vec3> inside;
  for (std::uint64_t i = 0; i < 900; ++i) {
    const Vec3 p = random_in(wider, {4, i, 0});
    particles.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z), 0});
    const Vec3 rounded{particles.back().x, particles.back().y, particles.back().z};
    if (region.contains(rounded)) inside.push_back(rounded);
  }
  Occupancy occupancy;
  occupancy.reset(particles, region, clearance);
  EXPECT_EQ(occupancy.size(), inside.size());
  std::size_t free = 0;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const Vec3 at = random_in(wider, {5, i, 0});
    const bool wanted = std::none_of(inside.begin(), inside.end(), [&](const Vec3& p) { return norm(p - at) < clearance; });
    ASSERT_EQ(occupancy.is_free(at), wanted);
    if (!wanted || i % 3 != 0) continue;
    occupancy.add(at), inside.push_back(at), ++free;
  }
  EXPECT_GT(free, 50u);
}

}  // namespace
}  // namespace imbibe
