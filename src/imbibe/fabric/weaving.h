// From draft and yarns to the network: lays the yarns, bends them round each other, cuts them into half loops and
// finds the pores between them.
//
// Heights: where warp (radius r_w) and weft (radius r_f) cross they touch, r_w + r_f apart. By default the warp lies
// r_f above or below the mid-plane and the weft r_w on the other side: then both are flush with both faces, and the
// sheet is 2 (r_w + r_f) thick. `warp_crimp_share` divides the distance otherwise.
// Half loops: segment k of a yarn is centred on its crossing k and reaches from the middle of one gap to the middle of
// the next; so a yarn has as many segments as it crosses yarns. The ends reach half a gap beyond the last crossing.
// Pores: one between every four crossings, (ends - 1)(picks - 1) of them. It is bounded by the eight half segments of
// those crossings, four of each family. The rim of half a pitch outside the outermost yarns is open to the side and
// holds no pore. Tested in tests/fabric/weaving_test.cpp.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "imbibe/core/error.h"
#include "imbibe/fabric/network.h"
#include "imbibe/fabric/weave.h"

namespace imbibe {

// Everything a weaver decides: places and kinds of the yarns.
struct Layout {
  WeaveDraft draft;
  std::vector<YarnType> types;
  std::vector<Real> end_place, pick_place;   // m, x of the warp yarns and y of the weft yarns, rising
  std::vector<Index> end_type, pick_type;    // into types
  Real size_x = 0, size_y = 0;               // m
  std::optional<Real> thickness;             // m; default from the yarns
  std::optional<Real> warp_crimp_share;
  int points_per_segment = 8;                // even
};

// Heights of the two axes where `end` crosses `pick`, m.
struct CrossingHeights {
  Real warp = 0, weft = 0;
};
CrossingHeights crossing_heights(const Layout& layout, std::size_t pick, std::size_t end);

// What must hold before a layout can be woven: open gaps, room to bend, finite numbers. Only the worst place of each
// kind is reported.
std::vector<Problem> check_layout(const Layout& layout, const std::string& key);

// Arc lengths of one yarn: from the edge to the first crossing, between crossings, and to the other edge.
std::vector<Real> yarn_arcs(const Layout& layout, Family family, std::size_t yarn);

// Distance of the outermost points of the yarns, m.
Real layout_thickness(const Layout& layout);

// Yarn volume and mass per area of the whole sheet, without building the network.
struct LayoutSums {
  Real volume_per_area = 0;  // m
  Real mass_per_area = 0;    // kg/m2
};
LayoutSums layout_sums(const Layout& layout);

// check_layout(...) must be empty. Throws InputError where the yarns fill a pore completely.
YarnNetwork weave_network(const Layout& layout, const std::string& key = "");

}  // namespace imbibe
