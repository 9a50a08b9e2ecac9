// Liquid that stands against part of a sheet: which nodes, when, and in whose books.
#include "imbibe/coupling/reservoir.h"

#include <gtest/gtest.h>

#include "imbibe/core/error.h"
#include "support/hand_networks.h"

namespace imbibe {
namespace {

using testing::cotton_fibre;
using testing::paper_sheet;
using testing::paper_yarn;

TEST(Reservoir, FeedsTheNodesWhoseCentresLieInIt) {
  const YarnNetwork network = paper_sheet(4, paper_yarn(cotton_fibre()));  // pitch 1 mm, crossings at +-0.5, +-1.5 mm
  ReservoirSpec spec;
  spec.centre = {1.5e-3, 1.5e-3}, spec.size = {0.2e-3, 0.2e-3};
  EXPECT_EQ(make_reservoir(spec, network).nodes.size(), 2u);  // the warp and the weft segment of one crossing
  spec.centre = {0, 0}, spec.size = {2.5e-3, 2.5e-3};
  EXPECT_EQ(make_reservoir(spec, network).nodes.size(), 2u * 4 + 9);
  spec.feeds = ReservoirFeeds::pores;
  EXPECT_EQ(make_reservoir(spec, network).nodes.size(), 9u);
  spec.feeds = ReservoirFeeds::yarns;
  EXPECT_EQ(make_reservoir(spec, network).nodes.size(), 8u);
  spec.size = {0.2e-3, 0.2e-3};
  EXPECT_THROW(make_reservoir(spec, network), InputError);
}

TEST(Reservoir, IsTakenAwayAtItsEndAndBooksWhatItGave) {
  std::vector<Reservoir> reservoirs(2);
  reservoirs[0].nodes = {3, 4}, reservoirs[0].end = 2;
  reservoirs[1].nodes = {5}, reservoirs[1].from_below = true, reservoirs[1].pressure = -7;
  std::vector<FaceSupply> supplies;
  append_supplies(reservoirs, 1, supplies);
  ASSERT_EQ(supplies.size(), 3u);
  EXPECT_EQ(supplies[2].node, 5u);
  EXPECT_TRUE(supplies[2].from_below);
  EXPECT_EQ(supplies[2].pressure, -7);
  EXPECT_EQ(next_change(reservoirs, 1), 2);
  EXPECT_EQ(book_supplied(reservoirs, 1, {9, 1, 2, 4}, 1), 7);
  EXPECT_EQ(reservoirs[0].supplied_kg, 3);
  EXPECT_EQ(reservoirs[1].supplied_kg, 4);
  supplies.clear();
  append_supplies(reservoirs, 2, supplies);
  EXPECT_EQ(supplies.size(), 1u);
  EXPECT_TRUE(std::isinf(next_change(reservoirs, 2)));
}

}  // namespace
}  // namespace imbibe
