// What a textile engineer reads off a wet cloth: wetted area, extent of the stain along warp and weft, saturations.
// Functions of a World; series.csv, reports, the live page and tests of physics all use these.
//
// Saturation of a node is the liquid it holds over what it can hold. A segment without capillary water (monofilament,
// or fibres that reject the liquid) shows its fibres' water instead, counted from what the air alone gives them, so
// that a conditioned dry cloth is dry whatever its regain:
//   s = (W - W_air) / (W_swollen - W_air), at least 0        W kg/kg, regain
//
// All lengths but heights are material: measured in the flat sheet, whatever shape a soft sheet has taken.
// Tested in tests/sim/measures_test.cpp.
#pragma once

#include <vector>

#include "imbibe/core/parameter.h"
#include "imbibe/sim/world.h"

namespace imbibe {

struct MeasureParams {
  Real wet_saturation = 0.05;  // a node with more is wet
};

template <class V>
void describe(V& v, MeasureParams& p) {
  v.value("wet_saturation", p.wet_saturation,
          {.unit = "1", .shown = "%", .min = 0, .max = 1,
           .help = "a yarn segment or pore counts as wet above this saturation (wetted area, extents)"});
}

struct TextileMeasures {
  Real wet_area = 0;         // m2: every segment stands for an equal share of the sheet; the sum over wet ones, of the
                             // layer where it is largest
  Real wet_pore_area = 0;    // m2: cells of wet pores
  Real extent_warp = 0;      // m: greatest distance of wet nodes along the warp direction (sheet y), centre to centre
  Real extent_weft = 0;      // m: along the weft direction (sheet x)
  Real wet_height = 0;       // m: from the lowest wet node to the highest, as the cloth hangs
  Real mean_saturation = 0;  // of the yarns, weighted by their volume
  Real max_saturation = 0;   // of all nodes
  Real pore_saturation = 0;  // of the pores, weighted by their volume
  Real max_regain = 0;       // kg/kg, of the fibre substance
  Real yarn_volume = 0;      // m3, the weight of mean_saturation
};

TextileMeasures measure(const Textile& textile, const Air& air, const MeasureParams& params = {});

// The same of a cloth of cells. Lengths are material; `lowest` is where its lowest node hangs.
struct CellClothMeasures {
  Real wet_area = 0, extent_warp = 0, extent_weft = 0, wet_height = 0;
  Real mean_saturation = 0, max_saturation = 0;  // over-full cells count with more than 1
  Real capacity_volume = 0;                      // m3 of water that it can hold: the weight of mean_saturation
  Real lowest = unlimited;                       // m, z of the lowest node
};
CellClothMeasures measure(const CellCloth& cloth, const MeasureParams& params = {});

// Saturation of every node, as above.
std::vector<Real> node_saturations(const Textile& textile, const Air& air);

// Where the centre lines' points (network.points) and the nodes (segments, then pores) are in the world now, m.
std::vector<Vec3> points_in_world(const Textile& textile);
std::vector<Vec3> nodes_in_world(const Textile& textile);

// Where the liquid that hangs in drops at hems and under leaks is, as the particles that it will be: it belongs to its cloth
// and is no part of the free liquid. For pictures and files.
std::vector<Vec3> hanging_liquid(const World& world);

}  // namespace imbibe
