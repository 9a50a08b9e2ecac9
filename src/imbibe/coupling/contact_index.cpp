#include "imbibe/coupling/contact_index.h"

#include <cmath>

#include "imbibe/core/error.h"
#include "imbibe/core/parallel.h"

namespace imbibe {
namespace {

std::size_t boxes_above(std::size_t segments) {
  std::size_t total = segments;
  for (std::size_t level = segments; level > 1;) total += level = (level + boxes_per_group - 1) / boxes_per_group;
  return total;
}

SmallBox outward(const Bounds& b) {
  const auto down = [](Real v) { return std::nextafterf(static_cast<float>(v), -std::numeric_limits<float>::infinity()); };
  const auto up = [](Real v) { return std::nextafterf(static_cast<float>(v), std::numeric_limits<float>::infinity()); };
  return {{down(b.lower.x), down(b.lower.y), down(b.lower.z)}, {up(b.upper.x), up(b.upper.y), up(b.upper.z)}};
}

SmallBox joined(std::span<const SmallBox> boxes) {
  SmallBox all = boxes[0];
  for (const SmallBox& b : boxes.subspan(1)) {
    all.lower = {std::min(all.lower.x, b.lower.x), std::min(all.lower.y, b.lower.y), std::min(all.lower.z, b.lower.z)};
    all.upper = {std::max(all.upper.x, b.upper.x), std::max(all.upper.y, b.upper.y), std::max(all.upper.z, b.upper.z)};
  }
  return all;
}

void fit_yarn(YarnContactIndex& index, const YarnNetwork& network, Index yarn) {
  const Index first = network.yarn_first_segment[yarn], last = network.yarn_first_segment[yarn + 1];
  const Real radius = radius_of_yarn(network, yarn);
  SmallBox* box = index.boxes.data() + index.yarn_first_box[yarn];
  for (Index s = first; s < last; ++s) {
    Bounds bounds;
    for (const Vec3& p : points_of_segment(network, yarn, s)) bounds.include(p);
    bounds.grow(radius);
    *box++ = outward(bounds);
  }
  for (std::size_t count = last - first; count > 1;) {
    const SmallBox* below = box - count;
    const std::size_t parents = (count + boxes_per_group - 1) / boxes_per_group;
    for (std::size_t p = 0; p < parents; ++p) {
      *box++ = joined({below + p * boxes_per_group, std::min(boxes_per_group, count - p * boxes_per_group)});
    }
    count = parents;
  }
}

}  // namespace

std::span<const Vec3> points_of_segment(const YarnNetwork& network, Index yarn, Index segment) {
  const auto steps = static_cast<std::size_t>(network.points_per_segment);
  const std::size_t first = network.yarn_first_point[yarn] + steps * (segment - network.yarn_first_segment[yarn]);
  return {network.points.data() + first, steps + 1};
}

YarnContactIndex build_contact_index(const YarnNetwork& network) {
  YarnContactIndex index;
  const std::size_t yarns = network.yarn_family.size();
  index.yarn_first_box.resize(yarns + 1);
  for (Index y = 0; y < yarns; ++y) {
    const std::size_t segments = network.yarn_first_segment[y + 1] - network.yarn_first_segment[y];
    IMBIBE_ASSERT(segments > 0);
    index.yarn_first_box[y + 1] = index.yarn_first_box[y] + boxes_above(segments);
    index.members[static_cast<std::size_t>(network.yarn_family[y])].push_back(y);
  }
  index.boxes.resize(index.yarn_first_box[yarns]);
  refit(index, network);
  return index;
}

void refit(YarnContactIndex& index, const YarnNetwork& network) {
  const std::size_t yarns = network.yarn_family.size();
  parallel_for(yarns, [&](std::size_t y) { fit_yarn(index, network, static_cast<Index>(y)); }, 16);
  index.textile = {};
  for (std::size_t f = 0; f < 2; ++f) {
    std::vector<Bounds> boxes;
    for (const Index y : index.members[f]) boxes.push_back(wide(index.boxes[index.yarn_first_box[y + 1] - 1]));
    if (index.yarns[f].order.size() == boxes.size()) refit(index.yarns[f], boxes);
    else index.yarns[f] = build_hierarchy(boxes, 1);
    if (!boxes.empty()) index.textile.include(index.yarns[f].nodes[0].bounds);
  }
}

}  // namespace imbibe
