#include "imbibe/fabric/porosity.h"

#include "fabric/support.h"

namespace imbibe {
namespace {

using test::paper_sheet;
using test::shipped_fibres;
using test::shirting;

TEST(Porosity, OfThePaperSheetIs0686WithStraightYarnsAndLessWithTheirArcLength) {
  const FabricNumbers n = build_fabric(paper_sheet(), shipped_fibres()).numbers;
  // 1 - 2 pi r^2 / (p t) = 1 - 0.1 pi
  EXPECT_NEAR(n.porosity_projected, 1 - 0.1 * pi, 1e-12);
  EXPECT_NEAR(n.porosity_projected, 0.686, 5e-4);
  // Peirce, p = 1, h = 0.4, R0 + R1 = 0.8: L = sqrt(0.52), theta = atan2(1, 0.4) - atan2(L, 0.8).
  const Real l = std::sqrt(0.52), theta = std::atan2(1.0, 0.4) - std::atan2(l, 0.8), arc = 0.8 * theta + l;
  EXPECT_NEAR(n.warp.crimp, arc - 1, 1e-12);
  EXPECT_NEAR(n.porosity, 1 - 0.1 * pi * arc, 1e-12);
  EXPECT_LT(n.porosity, 0.98);  // the paper's figure is out of reach at this radius
}

TEST(Porosity, AsPrintedIsTheFormulaOfThePaper) {
  EXPECT_DOUBLE_EQ(porosity_as_printed(1, 0.5, 2, 4), 1 - pi * 0.25 * 2 / (2 * 0.5 * 16));
  const FabricNumbers n = build_fabric(paper_sheet(), shipped_fibres()).numbers;
  EXPECT_NEAR(n.porosity_as_printed, porosity_as_printed(120, 0.2e-3, 0.06, 0.06 * (1 + n.warp.crimp)), 1e-12);
}

TEST(Porosity, IsTheMeanOfThePoresVoids) {
  const Fabric fabric = build_fabric(paper_sheet(), shipped_fibres());
  Real voids = 0, cells = 0;
  for (std::size_t p = 0; p < fabric.network.pores(); ++p) {
    voids += fabric.network.pore_volume[p];
    cells += fabric.network.pore_area[p] * fabric.network.thickness;
  }
  EXPECT_NEAR(voids / cells, fabric.numbers.porosity, 1e-12);
}

TEST(Porosity, FallsWithTheDiameterAsInFigure3) {
  Real before = 1;
  for (Real diameter : {0.2e-3, 0.35e-3, 0.5e-3}) {
    FabricSpec spec = paper_sheet();
    spec.size = {0.02, 0.02};
    spec.warp.diameter = spec.weft.diameter = diameter;
    const Real porosity = build_fabric(spec, shipped_fibres()).numbers.porosity;
    EXPECT_LT(porosity, before);
    before = porosity;
  }
}

TEST(FabricNumbers, OfAShirtingAreThoseOfTheTrade) {
  const FabricNumbers n = build_fabric(shirting(0.03), shipped_fibres()).numbers;
  EXPECT_NEAR(n.warp.mean_radius, 86.4e-6, 0.1e-6);
  EXPECT_NEAR(n.warp.opening, 160e-6, 1e-6);
  EXPECT_NEAR(n.weft.opening, 184e-6, 1e-6);
  EXPECT_NEAR(n.thickness, 0.346e-3, 0.5e-6);
  EXPECT_NEAR(n.throat_radius, 86e-6, 0.5e-6);
  // 116 g/m2 of straight yarn and 13-16 % crimp; a sinusoid of the same height would give 134.
  EXPECT_NEAR(n.areal_mass, 0.1327, 0.0005);
  EXPECT_NEAR(n.warp.cover_factor_tex, 3 * std::sqrt(20.0), 0.01);
  EXPECT_NEAR(n.cover, 1 - (1 - n.warp.cover) * (1 - n.weft.cover), 1e-12);
}

TEST(FabricNumbers, ArealMassIsFibreDensityTimesFibreVolume) {
  const FabricNumbers n = build_fabric(shirting(), shipped_fibres()).numbers;
  EXPECT_NEAR(n.areal_mass, 1550 * 0.55 * (n.warp.volume_per_area + n.weft.volume_per_area), 1e-12);
  // Void of the sheet = pores + inside of the yarns: all that is not fibre.
  EXPECT_NEAR(n.total_porosity, 1 - n.areal_mass / 1550 / n.thickness, 1e-12);
}

TEST(PoreRadius, StorageHoldsTheVolumeAndTheThroatTheCapillarity) {
  // N tubes of radius R_V through a slab hold eps A t.
  EXPECT_NEAR(9 * pi * std::pow(storage_radius(0.4, 2, 9), 2), 0.8, 1e-12);
  EXPECT_EQ(storage_radius(0.4, 2, 0), 0);
  EXPECT_DOUBLE_EQ(throat_radius(2, 2), 1);
  EXPECT_DOUBLE_EQ(throat_radius(1e9, 1), 1 / (1 + 1e-9));  // a slit of width w: P = 2 gamma cos / w
  EXPECT_EQ(throat_radius(0, 1), 0);
  EXPECT_EQ(throat_radius(1, -1), 0);
  const FabricNumbers n = build_fabric(paper_sheet(), shipped_fibres()).numbers;
  EXPECT_NEAR(n.throat_radius, 0.3e-3, 1e-12);
  EXPECT_NEAR(n.pore_volume, pi * n.storage_radius * n.storage_radius * n.thickness, 1e-18);
}

TEST(PoreRadius, AsPrintedIsTheFormulaOfThePaper) {
  EXPECT_DOUBLE_EQ(pore_radius_as_printed(0.5, 4, 2, 6, 11), std::sqrt(0.5 * 4 / (2 * pi * 2 * 5 * 10)));
  EXPECT_EQ(pore_radius_as_printed(0.5, 4, 2, 1, 11), 0);
}

TEST(ThroatCapillarity, IsJurinsForARoundTube) {
  // 74.34 mm for r = 0.2 mm at 0 deg, half at 60 deg, depression above 90 deg.
  const ThroatCapillarity c = throat_capillarity(0.2e-3, 0.0728, 0, 998.2, 9.81);
  EXPECT_NEAR(c.height, 74.34e-3, 0.01e-3);
  EXPECT_NEAR(throat_capillarity(0.2e-3, 0.0728, pi / 3, 998.2, 9.81).height, c.height / 2, 1e-9);
  EXPECT_LT(throat_capillarity(0.2e-3, 0.0728, radians(100), 998.2, 9.81).pressure, 0);
  EXPECT_NEAR(c.bond_number, std::pow(0.2 / 2.727, 2), 1e-5);  // (r / capillary length)^2
}

}  // namespace
}  // namespace imbibe
