// Disjoint sets of the numbers 0 .. n-1, as a forest: parent[i] is another member of i's set, and i itself at its root.
// Paths are halved on every look-up (Tarjan & van Leeuwen, J. ACM 31 (1984) 245): near constant time without ranks, which
// leaves the caller free to choose who becomes the root.
// Tested in tests/core/union_find_test.cpp.
#pragma once

#include <numeric>
#include <vector>

#include "imbibe/core/types.h"

namespace imbibe {

// Every number a set of its own.
inline void separate_all(std::vector<Index>& parent, std::size_t count) {
  parent.resize(count);
  std::iota(parent.begin(), parent.end(), Index{0});
}

inline Index root_of(std::vector<Index>& parent, Index i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

// Joins the sets of a and b; the smaller root stays one, so a root is the smallest member of its set if all joins are made
// here. False when they were one set already.
inline bool unite(std::vector<Index>& parent, Index a, Index b) {
  a = root_of(parent, a), b = root_of(parent, b);
  if (a == b) return false;
  if (a < b) parent[b] = a;
  else parent[a] = b;
  return true;
}

}  // namespace imbibe
