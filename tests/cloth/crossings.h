// Brute force: which edges of a sheet pass through which of its triangles.
#pragma once

#include <set>

#include "imbibe/cloth/sheet.h"
#include "imbibe/geometry/sweep.h"

namespace imbibe::testing {

inline std::size_t count_self_crossings(const Sheet& sheet) {
  std::set<std::array<Index, 2>> edges;
  for (const auto& t : sheet.triangles) {
    for (std::size_t k = 0; k < 3; ++k) edges.insert({std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])});
  }
  std::size_t crossings = 0;
  for (const auto& [a, b] : edges) {
    Bounds box;
    box.include(sheet.position[a]), box.include(sheet.position[b]);
    for (const auto& t : sheet.triangles) {
      if (t[0] == a || t[1] == a || t[2] == a || t[0] == b || t[1] == b || t[2] == b) continue;
      Bounds other;
      for (const Index i : t) other.include(sheet.position[i]);
      if (!box.overlaps(other)) continue;
      if (cross_triangle(sheet.position[a], sheet.position[b], sheet.position[t[0]], sheet.position[t[1]],
                         sheet.position[t[2]])) {
        ++crossings;
      }
    }
  }
  return crossings;
}

}  // namespace imbibe::testing
