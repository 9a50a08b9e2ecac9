#include "imbibe/sim/measures.h"

#include <gtest/gtest.h>

#include "io/small_world.h"

namespace imbibe {
namespace {

constexpr Real pitch = 1e-3;  // m, of the small fabric: 10 ends along x, 8 picks along y

// The segment of a family whose centre is nearest to a point of the sheet.
std::size_t segment_at(const YarnNetwork& network, Family family, Real x, Real y) {
  std::size_t best = 0;
  Real nearest = 1e9;
  for (std::size_t s = 0; s < network.segments(); ++s) {
    const Vec3 d = network.segment_centre[s] - Vec3{x, y, network.segment_centre[s].z};
    if (network.family_of_segment(s) == family && norm(d) < nearest) nearest = norm(d), best = s;
  }
  return best;
}

// Fills a node to the saturation.
void fill(Textile& textile, std::size_t node, Real saturation_wanted) {
  textile.contents.liquid_kg[node] =
      saturation_wanted * current_volume(*textile.model, textile.contents, node) * textile.model->liquid.density;
}

TEST(Measures, of_a_conditioned_cloth_say_dry_whatever_the_fibre) {
  const Air air;
  for (const char* fibre : {"cotton", "wool", "polyester"}) {
    for (const bool monofilament : {false, true}) {
      const Textile textile = testing::small_textile("t", testing::small_fabric(fibre, monofilament), air);
      const TextileMeasures m = measure(textile, air);
      EXPECT_EQ(m.wet_area, 0) << fibre << monofilament;
      EXPECT_EQ(m.wet_pore_area, 0);
      EXPECT_EQ(m.extent_warp, 0);
      EXPECT_EQ(m.mean_saturation, 0) << fibre << monofilament;
      EXPECT_EQ(m.max_saturation, 0);
      EXPECT_GT(m.max_regain, 0);
    }
  }
}

TEST(Measures, of_a_stain_are_its_extents_in_pitches_and_its_share_of_the_sheet) {
  const Air air;
  Textile textile = testing::small_textile("t", testing::small_fabric(), air);
  const YarnNetwork& network = textile.fabric->network;
  ASSERT_EQ(network.segments(), 160u);
  // Three pitches apart along x (the weft direction), two along y (the warp direction).
  const std::size_t first = segment_at(network, Family::weft, 0.5 * pitch, 0.5 * pitch);
  const std::size_t second = segment_at(network, Family::weft, 3.5 * pitch, 0.5 * pitch);
  const std::size_t third = segment_at(network, Family::warp, 0.5 * pitch, -1.5 * pitch);
  fill(textile, first, 0.5);
  fill(textile, second, 1.0);
  fill(textile, third, 0.051);
  TextileMeasures m = measure(textile, air);
  // Centres are exact multiples of the pitch; what is left is rounding.
  EXPECT_NEAR(m.extent_weft, 3 * pitch, 1e-12);
  EXPECT_NEAR(m.extent_warp, 2 * pitch, 1e-12);
  EXPECT_NEAR(m.wet_area, 0.01 * 0.008 * 3 / 160, 1e-15);
  EXPECT_NEAR(m.max_saturation, 1, 1e-12);
  EXPECT_NEAR(m.mean_saturation, 1.551 / 160, 1e-5);  // segments of both families differ a little in volume

  // Below the threshold a node is not wet, and the threshold is the caller's.
  fill(textile, third, 0.049);
  m = measure(textile, air);
  EXPECT_EQ(m.extent_warp, 0);
  EXPECT_NEAR(m.wet_area, 0.01 * 0.008 * 2 / 160, 1e-15);
  EXPECT_NEAR(measure(textile, air, {.wet_saturation = 0.01}).extent_warp, 2 * pitch, 1e-12);
}

TEST(Measures, of_height_are_those_of_the_cloth_as_it_hangs) {
  const Air air;
  Textile textile = testing::small_textile("t", testing::small_fabric(), air);
  const YarnNetwork& network = textile.fabric->network;
  fill(textile, segment_at(network, Family::weft, 0.5 * pitch, 0.5 * pitch), 0.5);
  fill(textile, segment_at(network, Family::weft, 3.5 * pitch, -1.5 * pitch), 0.5);
  EXPECT_LT(measure(textile, air).wet_height, network.thickness);
  textile.placement.v = {0, 0, 1}, textile.placement.n = {0, -1, 0};  // upright
  EXPECT_NEAR(measure(textile, air).wet_height, 2 * pitch, 1e-12);
}

TEST(Measures, count_wet_pores_by_their_cells) {
  const Air air;
  Textile textile = testing::small_textile("t", testing::small_fabric(), air);
  const YarnNetwork& network = textile.fabric->network;
  for (std::size_t p = 0; p < network.pores(); ++p) fill(textile, network.segments() + p, 1);
  const TextileMeasures m = measure(textile, air);
  Real cells = 0;
  for (const Real area : network.pore_area) cells += area;
  EXPECT_NEAR(m.wet_pore_area, cells, 1e-15);
  EXPECT_NEAR(m.pore_saturation, 1, 1e-12);
  EXPECT_EQ(m.wet_area, 0);
}

TEST(Measures, of_monofilaments_count_the_water_in_the_fibre_beyond_what_air_gives) {
  const Air air;
  Textile textile = testing::small_textile("t", testing::small_fabric("wool", true), air);
  const WettingModel& model = *textile.model;
  const std::size_t s = 7;
  const Real in_air = node_regain(model, textile.contents, s);
  const Real full = model.yarns[model.segment_type[s]].swelling_regain;
  textile.contents.sorbed_kg[s] *= (in_air + 0.25 * (full - in_air)) / in_air;
  EXPECT_NEAR(node_saturations(textile, air)[s], 0.25, 1e-12);
  // Drier air than the cloth was conditioned in makes it "wetter than air", never negative the other way round.
  Air damp = air;
  damp.humidity = 0.9;
  for (const Real x : node_saturations(textile, damp)) EXPECT_GE(x, 0);
}

}  // namespace
}  // namespace imbibe
