// Liquid that stands against part of a sheet and never runs out: a dipped end of a strip, the foot of an upright tube,
// a wet sponge under a patch. Its nodes are supplied at a given pressure through the same law as liquid on a face
// (wetting/transport_laws.cpp); what they take is counted as supplied, what they give back is taken off again.
//
// pressure Pa, against the air: 0 is a free level at the sheet, rho g h a level h above it.
// Tested in tests/coupling/reservoir_test.cpp.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <vector>

#include "imbibe/core/parameter.h"
#include "imbibe/core/types.h"
#include "imbibe/fabric/network.h"
#include "imbibe/wetting/contents.h"

namespace imbibe {

enum class ReservoirFeeds { all, yarns, pores };
enum class ReservoirSide { face, back };

struct ReservoirSpec {
  std::array<Real, 2> centre{0, 0};  // m, in the sheet: along weft, along warp
  std::array<Real, 2> size{0, 0};    // m, full lengths
  Real pressure = 0;                 // Pa
  ReservoirFeeds feeds = ReservoirFeeds::all;
  ReservoirSide side = ReservoirSide::face;
  std::optional<Real> end;           // s
};

template <class V>
void describe(V& v, ReservoirSpec& p) {
  v.value("centre", p.centre,
          {.unit = "m", .shown = "mm", .help = "middle of the supplied part, along weft and warp from the sheet's middle"});
  v.value("size", p.size,
          {.unit = "m", .shown = "mm", .min = 0, .above_min = true, .required = true,
           .help = "its full lengths along weft and warp; nodes whose centres lie in it are supplied"});
  v.value("pressure", p.pressure,
          {.unit = "Pa", .min = -1e6, .max = 1e6, .help = "of the liquid there, against the air; negative: suction"});
  v.choice("feeds", p.feeds,
           {{"all", ReservoirFeeds::all}, {"yarns", ReservoirFeeds::yarns}, {"pores", ReservoirFeeds::pores}},
           "which nodes it touches");
  v.choice("side", p.side, {{"face", ReservoirSide::face}, {"back", ReservoirSide::back}},
           "the face it stands at; pores fill from there");
  v.value("end", p.end, {.unit = "s", .min = 0, .help = "when it is taken away; default: never"});
}

// A reservoir of a built textile.
struct Reservoir {
  std::vector<Index> nodes;
  Real pressure = 0;         // Pa
  bool from_below = false;
  Real end = std::numeric_limits<Real>::infinity();  // s
  Real supplied_kg = 0;      // state: given so far, less what came back
};

// Throws InputError when it touches no node.
Reservoir make_reservoir(const ReservoirSpec& spec, const YarnNetwork& network);

// Appends one supply per node of each reservoir that still stands at `time`.
void append_supplies(const std::vector<Reservoir>& reservoirs, Real time, std::vector<FaceSupply>& supplies);

// Takes what the nodes took, in the order of append_supplies; returns the sum, kg.
Real book_supplied(std::vector<Reservoir>& reservoirs, Real time, const std::vector<Real>& taken_kg, std::size_t first);

// The next time at which a reservoir is taken away, s.
Real next_change(const std::vector<Reservoir>& reservoirs, Real time);

}  // namespace imbibe
