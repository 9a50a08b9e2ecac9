// The boxes of a woven sheet for contact queries: textile -> (groups of) yarns -> yarn -> (groups of) segments ->
// segment. A parent's box is made of its children's corners (seed A section 4), so a moved sheet needs one refit from
// the bottom. 27 bytes per segment.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "imbibe/core/types.h"
#include "imbibe/fabric/network.h"
#include "imbibe/geometry/bounds.h"
#include "imbibe/geometry/hierarchy.h"

namespace imbibe {

// A box in single precision, rounded outwards: half the memory, never smaller than what it holds.
struct SmallBox {
  Vec3f lower, upper;
};

struct YarnContactIndex {
  Bounds textile;
  std::array<BoxHierarchy, 2> yarns;          // by Family: groups of neighbouring yarns above the yarns
  std::array<std::vector<Index>, 2> members;  // by Family: the yarns, as numbered in the hierarchy
  // Each yarn's boxes: its segments', then those of 8 segments, of 64, ... up to one for the whole yarn.
  std::vector<std::size_t> yarn_first_box;    // size yarns + 1
  std::vector<SmallBox> boxes;
};

YarnContactIndex build_contact_index(const YarnNetwork& network);

// New boxes after the network's points have moved.
void refit(YarnContactIndex& index, const YarnNetwork& network);

inline Bounds wide(const SmallBox& b) { return {Vec3(b.lower), Vec3(b.upper)}; }
inline Real radius_of_yarn(const YarnNetwork& network, Index yarn) {
  return network.yarn_types[network.yarn_type[yarn]].radius;
}

// The centre-line points of a segment: points_per_segment + 1 of them.
std::span<const Vec3> points_of_segment(const YarnNetwork& network, Index yarn, Index segment);

inline constexpr std::size_t boxes_per_group = 8;

// Calls visit(segment) for the segments of a yarn whose boxes pass; test(box) returns the path's entry time or
// infinity, boxes entered after `latest` are passed over. Earliest boxes first.
template <class Test, class Visit>
void visit_segments(const YarnContactIndex& index, const YarnNetwork& network, Index yarn, const Real& latest,
                    std::uint64_t& tested, Test&& test, Visit&& visit) {
  struct Entry { std::size_t level, place; Real time; };
  std::array<std::size_t, 16> level_begin{}, level_size{};
  std::size_t levels = 0;
  std::size_t begin = index.yarn_first_box[yarn];
  for (std::size_t n = network.yarn_first_segment[yarn + 1] - network.yarn_first_segment[yarn];;) {
    level_begin[levels] = begin, level_size[levels++] = n;
    if (n <= 1) break;
    begin += n;
    n = (n + boxes_per_group - 1) / boxes_per_group;
  }
  std::array<Entry, 16 * boxes_per_group> stack;
  std::size_t depth = 0;
  stack[depth++] = {levels - 1, 0, 0};  // the yarn's own box was tested by the caller
  while (depth > 0) {
    const Entry entry = stack[--depth];
    if (entry.time > latest) continue;
    if (entry.level == 0) {
      visit(static_cast<Index>(network.yarn_first_segment[yarn] + entry.place));
      continue;
    }
    const std::size_t below = entry.level - 1, base = depth;
    const std::size_t end = std::min((entry.place + 1) * boxes_per_group, level_size[below]);
    for (std::size_t child = entry.place * boxes_per_group; child < end; ++child) {
      ++tested;
      const Real time = test(wide(index.boxes[level_begin[below] + child]));
      if (time > latest) continue;
      std::size_t at = depth++;  // insertion: the latest lies deepest in the stack
      for (; at > base && stack[at - 1].time < time; --at) stack[at] = stack[at - 1];
      stack[at] = {below, child, time};
    }
  }
}

}  // namespace imbibe
