#include "imbibe/fabric/fabric.h"

#include <ctime>

#include "fabric/support.h"

namespace imbibe {
namespace {

using test::contains;
using test::paper_sheet;
using test::problem_count;
using test::problems_of;
using test::shipped_fibres;
using test::shirting;

Fabric built(const FabricSpec& spec) { return build_fabric(spec, shipped_fibres(), "textiles[0]"); }
std::string errors(const FabricSpec& spec) { return problems_of([&] { built(spec); }); }

TEST(Fabric, AllProblemsOfASpecAreReportedAtOnce) {
  FabricSpec spec = shirting();
  spec.weave = "satin 6/3";
  spec.warp.fibre = "coton";
  spec.weft.density.reset();
  spec.size = {0, 0.01};
  spec.porosity = 1.2;
  spec.points_per_segment = 7;
  const std::string text = errors(spec);
  for (const char* part : {"textiles[0].weave: satin 6/3", "textiles[0].warp.fibre: there is no fibre 'coton'",
                           "textiles[0].weft.density: is needed", "textiles[0].size[0]", "textiles[0].porosity: 1.2",
                           "textiles[0].points_per_segment: 7"})
    EXPECT_TRUE(contains(text, part)) << part << "\n" << text;
}

TEST(Fabric, ACellSmallerThanItsYarnsIsRefusedWithWhatWouldFit) {
  FabricSpec overlapping = paper_sheet();
  overlapping.warp.density = 2600;
  EXPECT_TRUE(contains(errors(overlapping), "textiles[0].warp: the cell is smaller than its yarns")) << errors(overlapping);
  EXPECT_TRUE(contains(errors(overlapping), "at most 25 per cm")) << errors(overlapping);
  // Gaps are open, but round yarns have no room to bend: pitch below 2 sqrt(3) r = 0.6928 mm.
  FabricSpec jammed = paper_sheet();
  jammed.warp.density = 1500;
  EXPECT_TRUE(contains(errors(jammed), "no room to pass")) << errors(jammed);
  EXPECT_TRUE(contains(errors(jammed), "14.43 per cm")) << errors(jammed);
  jammed.warp.density = 1443;
  EXPECT_EQ(errors(jammed), "");
}

TEST(Fabric, AWeaveThatDoesNotInterlaceIsRefused) {
  FabricSpec spec = shirting();
  for (const char* weave : {"1", "11 11", "00 11", "10 10"}) {
    spec.weave = weave;
    EXPECT_TRUE(contains(errors(spec), "does not interlace")) << weave;
  }
}

TEST(Fabric, EmptyAndRaggedWeavesNameTheirKey) {
  FabricSpec spec = shirting();
  spec.weave = "";
  EXPECT_TRUE(contains(errors(spec), "textiles[0].weave: the weave is empty"));
  spec.weave = "plain";
  spec.weave_rows = {"10", "1"};
  EXPECT_TRUE(contains(errors(spec), "textiles[0].weave_rows: the weave is ragged"));
  spec.weave_rows = {"10", "01"};
  EXPECT_EQ(errors(spec), "");
  spec.weave = "twill 2/1";
  EXPECT_TRUE(contains(errors(spec), "beside weave"));
}

TEST(Fabric, AMissingOrBrokenWifFileIsReportedWithItsOwnName) {
  FabricSpec spec = shirting();
  spec.weave = "none.wif";
  spec.folder = "/nowhere";
  EXPECT_TRUE(contains(errors(spec), "/nowhere/none.wif: error: cannot be opened")) << errors(spec);
}

TEST(Fabric, ASheetTooSmallOrTooLargeIsRefused) {
  FabricSpec spec = shirting();
  spec.size = {1e-5, 1e-5};
  EXPECT_EQ(built(spec).network.pores(), 1u);  // never fewer than two yarns each way
  spec.size = {50, 50};
  EXPECT_TRUE(contains(errors(spec), "cannot be numbered")) << errors(spec);
}

TEST(Fabric, TheSheetIsWithinHalfAPitchOfTheWantedSize) {
  for (Real size : {0.0101, 0.0123, 0.0159}) {
    const YarnNetwork net = built(shirting(size)).network;
    EXPECT_LE(std::abs(net.size_x - size), 0.5 * net.pitch_x + 1e-12);
    EXPECT_LE(std::abs(net.size_y - size), 0.5 * net.pitch_y + 1e-12);
    EXPECT_NEAR(net.pitch_x, 1 / 3000.0, 1e-15);
  }
}

TEST(Fabric, AWantedArealMassIsReachedByThePitch) {
  FabricSpec spec = shirting(0.03);
  for (Real mass : {0.09, 0.12, 0.14}) {
    spec.areal_mass = mass;
    const FabricNumbers n = built(spec).numbers;
    EXPECT_NEAR(n.areal_mass, mass, 1e-9 * mass);  // plain weave of one yarn: every patch is the sheet
    EXPECT_NEAR(n.warp.density / n.weft.density, 30.0 / 28, 1e-9);
  }
  spec.areal_mass = 0.4;
  EXPECT_TRUE(contains(errors(spec), "to reach the wanted areal mass")) << errors(spec);
}

TEST(Fabric, AWantedPorosityIsReachedByThicknessOrByPitch) {
  FabricSpec spec = shirting(0.03);
  spec.porosity = 0.7;
  const FabricNumbers thick = built(spec).numbers;
  EXPECT_NEAR(thick.porosity, 0.7, 1e-12);
  EXPECT_NEAR(thick.warp.density, 3000, 1e-9);
  EXPECT_NEAR(thick.geometric_thickness, 0.3457e-3, 1e-7);
  spec.porosity_by = PorosityBy::pitch;
  const FabricNumbers open = built(spec).numbers;
  EXPECT_NEAR(open.porosity, 0.7, 1e-9);
  EXPECT_NEAR(open.thickness, 0.3457e-3, 1e-7);
  EXPECT_LT(open.warp.density, 3000);
  spec.areal_mass = 0.1;
  EXPECT_TRUE(contains(errors(spec), "leave one out"));
  spec.porosity_by = PorosityBy::thickness;
  const FabricNumbers both = built(spec).numbers;
  EXPECT_NEAR(both.areal_mass, 0.1, 1e-10);
  EXPECT_NEAR(both.porosity, 0.7, 1e-12);
  spec.thickness = 1e-3;
  EXPECT_TRUE(contains(errors(spec), "leave one out"));
}

TEST(Fabric, ASlabFilledByItsYarnsIsRefused) {
  FabricSpec spec = paper_sheet();
  spec.thickness = 0.3e-3;
  EXPECT_TRUE(contains(errors(spec), "thinner than its thickest yarn"));
  spec.warp.density = spec.weft.density = 1440;
  spec.thickness = 0.41e-3;
  EXPECT_TRUE(contains(errors(spec), "filled by its yarns")) << errors(spec);
  spec.porosity = 0.05;
  spec.thickness.reset();
  EXPECT_EQ(errors(spec), "");
}

TEST(Fabric, StripesReplaceTheirYarnsAndRepeat) {
  FabricSpec spec = paper_sheet();
  spec.size = {0.02, 0.01};
  spec.stripes.push_back({.family = Family::warp, .first = 3, .count = 2, .repeat = 6,
                          .yarn = {.fibre = "polyester", .diameter = 0.3e-3}});
  const Fabric fabric = built(spec);
  const YarnNetwork& net = fabric.network;
  for (Index y = 0; y < net.yarn_family.size(); ++y) {
    const bool striped = net.yarn_family[y] == Family::warp && y >= 2 && (y - 2) % 6 < 2;
    EXPECT_EQ(net.yarn_types[net.yarn_type[y]].fibre.name, striped ? "polyester" : "wool") << y;
  }
  // A stripe that repeats does not begin before its first yarn.
  spec.stripes[0].first = 9;
  spec.stripes[0].repeat = 3;
  const YarnNetwork late = built(spec).network;
  for (Index y = 0; y < 20; ++y) EXPECT_EQ(late.yarn_type[y] == 2, y >= 8 && (y - 8) % 3 < 2) << y;
  spec.stripes[0].first = 0;
  spec.stripes[0].repeat = 1;
  spec.stripes[0].yarn.fibre = "poly";
  const std::string text = errors(spec);
  for (const char* part : {"stripes[0].first", "stripes[0].repeat", "stripes[0].yarn.fibre"})
    EXPECT_TRUE(contains(text, part)) << part << "\n" << text;
}

TEST(Fabric, AWifFileBringsWeaveColoursSpacingAndThickness) {
  FabricSpec spec;
  spec.size = {0.03, 0.03};
  spec.weave = "birdseye_twill.wif";
  spec.folder = IMBIBE_SOURCE_DIR "/fabrics";
  spec.warp.fibre = spec.weft.fibre = "wool";
  const Fabric fabric = built(spec);
  EXPECT_EQ(fabric.draft.ends, 6);
  EXPECT_NEAR(fabric.network.pitch_x, 1e-3, 1e-12);
  EXPECT_NEAR(fabric.numbers.warp.mean_radius, 0.18e-3, 1e-12);
  const YarnType& weft = fabric.network.yarn_types[fabric.network.yarn_type.back()];
  EXPECT_GT(weft.colour.z, weft.colour.x);
  // What the scene says wins over the file.
  spec.warp.density = 800;
  spec.warp.linear_density = 60e-6;
  const Fabric own = built(spec);
  EXPECT_NEAR(own.network.pitch_x, 1 / 800.0, 1e-12);
  EXPECT_NEAR(own.numbers.warp.linear_density, 60e-6, 1e-15);
  EXPECT_NEAR(own.network.pitch_y, 1e-3, 1e-12);
}

TEST(Fabric, AWifFileWithoutSpacingNeedsADensity) {
  FabricSpec spec = shirting();
  spec.folder = IMBIBE_SOURCE_DIR "/fabrics";
  spec.weave = "counterbalance_plain.wif";
  EXPECT_EQ(errors(spec), "");
  spec.warp.density.reset();
  EXPECT_TRUE(contains(errors(spec), "textiles[0].warp.density: is needed"));
}

TEST(FabricEstimate, IsTheSizeOfWhatIsBuilt) {
  for (const FabricSpec& spec : {paper_sheet(), shirting(0.0123)}) {
    const FabricEstimate e = estimate_fabric(spec);
    const YarnNetwork net = built(spec).network;
    EXPECT_EQ(e.segments, static_cast<double>(net.segments()));
    EXPECT_EQ(e.pores, static_cast<double>(net.pores()));
    EXPECT_EQ(e.edges, static_cast<double>(net.edges.size()));
    EXPECT_EQ(e.points, static_cast<double>(net.points.size()));
    EXPECT_GE(e.bytes, static_cast<double>(net.points.size() * sizeof(Vec3) + net.edges.size() * sizeof(Edge)));
  }
}

TEST(FabricEstimate, AllocatesNothingHoweverLargeTheSheet) {
  FabricSpec spec = shirting();
  spec.size = {90, 90};
  EXPECT_GT(estimate_fabric(spec).segments, 1e10);
  EXPECT_GT(estimate_fabric(spec).bytes, 1e12);
}

TEST(Fabric, CostGrowsInProportionToItsSegments) {
  // Processor time, not the clock on the wall: other programs may be running.
  const auto seconds = [](Real size) {
    const std::clock_t start = std::clock();
    built(shirting(size));
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  };
  seconds(0.02);
  const double small = std::min({seconds(0.04), seconds(0.04), seconds(0.04)});
  const double large = std::min(seconds(0.12), seconds(0.12));
  // 9 times the segments. A quadratic step would cost 81 times; caches are given a factor of 3.
  EXPECT_LT(large, 27 * small);
}

TEST(DescribeFabric, ListsTheNumbersInTextileUnits) {
  const std::string text = describe_fabric(built(shirting(0.03)));
  for (const char* part : {"warp (along y)", "weft (along x)", "cotton", "per cm", "per inch", "20              20  tex",
                           "132.7  g/m2", "0.3457  mm", "seed A eq. 5 as printed", "seed A eq. 11 as printed", "Bond number",
                           "crimp", "cover factor", "15120 segments"})
    EXPECT_TRUE(contains(text, part)) << part << "\n" << text;
}

}  // namespace
}  // namespace imbibe
