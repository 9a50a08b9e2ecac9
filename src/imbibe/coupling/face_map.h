// Which yarn segments and pores lie near a point of a sheet: nodes of the network sorted into square bins of the
// sheet's plane, those of the layer on each face (one layer: the same ones). Immutable; built once per textile. Sheet
// coordinates (fabric/network.h).
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "imbibe/core/types.h"
#include "imbibe/fabric/network.h"

namespace imbibe {

struct FaceMap {
  Real reach = 0;       // m, support radius of the face kernel: liquid at a point touches nodes within it
  Real bin = 0;         // m, side of a bin = reach
  Real x0 = 0, y0 = 0;  // m, lower corner of the bins
  int bins_x = 0, bins_y = 0;
  std::vector<Index> first;      // size bins + 1; nodes of all layers that have a free face
  // Nodes bin by bin, with what a search asks of them side by side.
  struct Node {
    Real x = 0, y = 0;  // m, of its centre
    Index index = 0;
    std::uint8_t upper = 0, lower = 0;  // as on_upper, on_lower
  };
  std::vector<Node> nodes;
  std::vector<float> face_area;  // m2 per node: plan area that the node drains
  std::vector<float> cos_advancing;  // per node: cosine of the advancing angle of the yarns there (area mean for pores)
  std::vector<float> cos_receding;
  std::vector<std::uint8_t> on_upper, on_lower;  // per node: liquid on that face touches it

  // Bin numbers of a place; -2 where no bin is within one of it, also for coordinates that are no numbers.
  int column_of(Real x) const { return bin_number(x - x0, bins_x); }
  int row_of(Real y) const { return bin_number(y - y0, bins_y); }

  // Calls visit(const Node&) for the nodes of the upper or lower face in the 3 x 3 bins around (x, y): all within reach and some
  // beyond.
  template <class Visit>
  void near(Real x, Real y, bool upper, Visit&& visit) const {
    const int bx = column_of(x), by = row_of(y);
    for (int j = std::max(by - 1, 0); j <= std::min(by + 1, bins_y - 1); ++j)
      for (int i = std::max(bx - 1, 0); i <= std::min(bx + 1, bins_x - 1); ++i) {
        const std::size_t b = static_cast<std::size_t>(j) * bins_x + i;
        for (Index k = first[b]; k < first[b + 1]; ++k)
          if (upper ? nodes[k].upper : nodes[k].lower) visit(nodes[k]);
      }
  }

 private:
  int bin_number(Real from_corner, int bins) const {
    const Real number = std::floor(from_corner / bin);
    return number >= -1 && number <= bins ? static_cast<int>(number) : -2;
  }
};

// reach = 1.5 max(particle spacing, pitch): smooth over the particles' disorder, and never less than one crossing.
FaceMap build_face_map(const YarnNetwork& network, Real particle_spacing);

// Two-dimensional Wendland C2 kernel of support R: integral 1 over the plane. [1/m2]
inline Real face_kernel(Real distance, Real reach) {
  const Real q = distance / reach;
  if (q >= 1) return 0;
  const Real a = (1 - q) * (1 - q);
  return 7 / (pi * reach * reach) * a * a * (1 + 4 * q);
}

}  // namespace imbibe
