#include "imbibe/liquid/neighbours.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "imbibe/core/error.h"
#include "imbibe/core/parallel.h"
#include "imbibe/core/random.h"
#include "imbibe/liquid/particles.h"

namespace imbibe {
namespace {

Liquid random_cloud(std::size_t count, const Vec3& size, std::uint64_t seed) {
  Liquid liquid;
  liquid.particle_mass = liquid.kind.density;  // spacing 1
  for (std::size_t i = 0; i < count; ++i) {
    const RandomCounter c{seed, i, 0};
    add_particle(liquid, {size.x * uniform(c, 0), size.y * uniform(c, 1), size.z * uniform(c, 2)}, {});
  }
  return liquid;
}

struct Searched {
  Liquid liquid;
  Neighbours n;
};

Searched searched(Liquid liquid, std::span<const std::uint32_t> side = {}) {
  Searched s{std::move(liquid), {}};
  sort_particles(s.n, s.liquid.particles, kernel_for(s.liquid.spacing()));
  std::vector<Float4> position = s.liquid.particles.position;
  pad_positions(position, s.n.count);
  build_lists(s.n, position, side);
  return s;
}

std::vector<Index> list_of(const Neighbours& n, std::size_t i) {
  const Slice slice = n.slice(i / simd::lanes * simd::lanes);
  std::vector<Index> list;
  for (std::size_t k = 0; k < slice.slots; ++k) {
    const Index j = slice.index[k * simd::lanes + i % simd::lanes];
    if (j < n.count) list.push_back(j);
  }
  std::sort(list.begin(), list.end());
  return list;
}

std::vector<Index> by_brute_force(const Searched& s, std::size_t i, std::span<const std::uint32_t> side = {}) {
  std::vector<Index> list;
  const auto& p = s.liquid.particles.position;
  const float limit = s.n.kernel.support * s.n.kernel.support;
  for (std::size_t j = 0; j < p.size(); ++j) {
    const float dx = p[i].x - p[j].x, dy = p[i].y - p[j].y, dz = p[i].z - p[j].z;
    if (j == i || dx * dx + dy * dy + dz * dz >= limit) continue;
    if (!side.empty() && separated(side[i], side[j])) continue;
    list.push_back(static_cast<Index>(j));
  }
  return list;
}

class NeighboursOfClouds : public testing::TestWithParam<std::tuple<std::size_t, Vec3>> {};

TEST_P(NeighboursOfClouds, are_those_of_brute_force) {
  const auto& [count, size] = GetParam();
  const Searched s = searched(random_cloud(count, size, count));
  for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(list_of(s.n, i), by_brute_force(s, i)) << "particle " << i;
}

INSTANTIATE_TEST_SUITE_P(Clouds, NeighboursOfClouds,
                         testing::Values(std::tuple{std::size_t{1}, Vec3{1, 1, 1}},
                                         std::tuple{std::size_t{7}, Vec3{1, 1, 1}},
                                         std::tuple{std::size_t{1500}, Vec3{10, 10, 10}},
                                         std::tuple{std::size_t{1500}, Vec3{3, 3, 3}},      // crowded
                                         std::tuple{std::size_t{2000}, Vec3{4000, 3, 2}},   // sparse and flat
                                         std::tuple{std::size_t{1029}, Vec3{-9, 12, -1}})); // negative coordinates

TEST(Neighbours, slope_is_that_of_the_kernel_and_zero_in_padding) {
  const Searched s = searched(random_cloud(900, {8, 8, 8}, 5));
  const auto& p = s.liquid.particles.position;
  for (std::size_t i = 0; i < s.n.count; ++i) {
    const Slice slice = s.n.slice(i / simd::lanes * simd::lanes);
    for (std::size_t k = 0; k < slice.slots; ++k) {
      const std::size_t at = k * simd::lanes + i % simd::lanes;
      const Index j = slice.index[at];
      if (j >= s.n.count) {
        EXPECT_EQ(slice.slope[at], 0);
        continue;
      }
      const float dx = p[i].x - p[j].x, dy = p[i].y - p[j].y, dz = p[i].z - p[j].z;
      EXPECT_EQ(slice.slope[at], s.n.kernel.slope(std::sqrt(dx * dx + dy * dy + dz * dz)));
    }
  }
}

TEST(Neighbours, particles_on_different_sides_of_a_sheet_do_not_see_each_other) {
  Searched s = searched(random_cloud(1200, {8, 8, 8}, 9));
  std::vector<std::uint32_t> side;
  for (const Float4& p : s.liquid.particles.position) {
    const std::uint32_t second = p.x > 3 ? 2u : 0u;
    side.push_back(second | (p.z > 4 ? 1u : p.z > 2 ? 1u << 16 : 0u));
  }
  std::vector<Float4> position = s.liquid.particles.position;
  pad_positions(position, s.n.count);
  build_lists(s.n, position, side);
  std::size_t cut = 0;
  for (std::size_t i = 0; i < s.n.count; ++i) {
    ASSERT_EQ(list_of(s.n, i), by_brute_force(s, i, side));
    cut += by_brute_force(s, i).size() - by_brute_force(s, i, side).size();
  }
  EXPECT_GT(cut, 1000u);  // the case is there
}

TEST(Neighbours, sorting_keeps_every_particle_whole) {
  const Liquid before = random_cloud(5000, {30, 20, 10}, 3);
  const Searched s = searched(before);
  std::vector<bool> seen(before.particles.size());
  for (std::size_t i = 0; i < s.n.count; ++i) {
    const Index id = s.liquid.particles.id[i];
    EXPECT_FALSE(seen[id]);
    seen[id] = true;
    EXPECT_EQ(s.liquid.particles.position[i].x, before.particles.position[id].x);
    EXPECT_EQ(s.liquid.particles.position[i].z, before.particles.position[id].z);
    EXPECT_EQ(s.n.order[i], id);
  }
  EXPECT_TRUE(std::is_sorted(s.n.cells.begin(), s.n.cells.end(),
                             [](const OccupiedCell& a, const OccupiedCell& b) { return a.key < b.key; }));
}

TEST(Neighbours, memory_follows_occupied_cells_however_large_the_domain) {
  Liquid liquid = random_cloud(500, {5, 5, 5}, 1);
  add_particle(liquid, {1e5, -1e5, 1e5}, {});
  const Searched s = searched(liquid);
  EXPECT_LT(s.n.cells.size(), 40u);
}

TEST(Neighbours, liquid_that_blew_up_is_reported_and_not_sorted) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const Vec3& lost : {Vec3{1e25, 0, 0}, Vec3{0, -1e18, 0}, Vec3{0, 0, static_cast<Real>(nan)}}) {
    Liquid liquid = random_cloud(10, {1, 1, 1}, 3);
    add_particle(liquid, lost, {});
    EXPECT_THROW(searched(std::move(liquid)), NumericalError);
  }
  Liquid spread = random_cloud(10, {1, 1, 1}, 3);  // each place has a number, the box around them has none
  add_particle(spread, {1e8, 1e8, 1e8}, {});
  EXPECT_THROW(searched(std::move(spread)), NumericalError);
}

TEST(Neighbours, lists_have_the_same_bits_for_any_number_of_threads) {
  std::vector<Searched> results;
  for (const int threads : {1, 2, 3}) {
    const ThreadLimit limit(threads);
    results.push_back(searched(random_cloud(20000, {28, 28, 28}, 2)));
  }
  for (std::size_t r = 1; r < results.size(); ++r) {
    ASSERT_EQ(results[r].liquid.particles.id, results[0].liquid.particles.id);
    for (std::size_t i = 0; i < results[0].n.count; i += simd::lanes) {
      const Slice a = results[0].n.slice(i), b = results[r].n.slice(i);
      ASSERT_EQ(a.slots, b.slots);
      ASSERT_TRUE(std::equal(a.index, a.index + a.slots * simd::lanes, b.index));
      ASSERT_TRUE(std::equal(a.slope, a.slope + a.slots * simd::lanes, b.slope));
    }
  }
}

TEST(Neighbours, an_empty_liquid_has_no_lists) {
  const Searched s = searched(Liquid{});
  EXPECT_TRUE(s.n.tiles.empty());
}

}  // namespace
}  // namespace imbibe
