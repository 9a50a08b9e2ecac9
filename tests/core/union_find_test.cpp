// Disjoint sets against sets kept by relabelling.
#include "imbibe/core/union_find.h"

#include <gtest/gtest.h>

#include "imbibe/core/random.h"

namespace imbibe {
namespace {

TEST(UnionFind, RootsAreTheSmallestMembersAsRelabellingFindsThem) {
  constexpr std::size_t count = 200;
  std::vector<Index> parent, label(count);
  separate_all(parent, count);
  std::iota(label.begin(), label.end(), Index{0});
  for (std::uint64_t k = 0; k < 150; ++k) {
    const auto a = static_cast<Index>(count * uniform({1, k, 0}, 0)), b = static_cast<Index>(count * uniform({1, k, 0}, 1));
    const bool apart = label[a] != label[b];
    EXPECT_EQ(unite(parent, a, b), apart);
    const Index low = std::min(label[a], label[b]), high = std::max(label[a], label[b]);
    for (Index& l : label) l = l == high ? low : l;
  }
  for (Index i = 0; i < count; ++i) EXPECT_EQ(root_of(parent, i), label[i]);
}

}  // namespace
}  // namespace imbibe
