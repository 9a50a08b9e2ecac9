// What a textile engineer reads off a wet cloth: wetted area, extent of the stain along warp and weft, saturations.
// Functions of a World; series.csv, reports, the live page and tests of physics all use these.
// All lengths are material: measured in the flat sheet, whatever shape a soft sheet has taken.
// Tested in tests/sim/measures_test.cpp.
#pragma once

#include "imbibe/sim/world.h"

namespace imbibe {

struct MeasureParams {
  Real wet_saturation = 0.05;  // a node with more is wet
};

template <class V>
void describe(V& v, MeasureParams& p) {
  v.value("wet_saturation", p.wet_saturation,
          {.unit = "1", .shown = "%", .min = 0, .max = 1,
           .help = "A yarn segment or pore counts as wet above this saturation (wetted area, extents)"});
}

struct TextileMeasures {
  Real wet_area = 0;         // m2: every segment stands for an equal share of the sheet; the sum over wet ones
  Real wet_pore_area = 0;    // m2: cells of wet pores
  Real extent_warp = 0;      // m: greatest distance of wet nodes along the warp direction (sheet y)
  Real extent_weft = 0;      // m: along the weft direction (sheet x)
  Real mean_saturation = 0;  // of the yarns: liquid held over capacity
  Real max_saturation = 0;   // of all nodes
  Real pore_saturation = 0;  // of the pores: liquid held over capacity
  Real max_regain = 0;       // kg/kg, of the fibre substance
};

TextileMeasures measure(const Textile& textile, const MeasureParams& params = {});

// Saturation of every node: liquid held over what the node can hold. Reuses `saturation`.
void node_saturation(const Textile& textile, std::vector<Real>& saturation);

}  // namespace imbibe
