// Which places near some surface are free for a new particle. Built from the particles inside a region, when something is to
// be born there; asked and added to in constant time. A hash of cells as large as the clearance: only what lies in the 27
// cells around a place can be too near.
// Tested in tests/liquid/occupancy_test.cpp against all pairs.
#pragma once

#include <span>
#include <vector>

#include "imbibe/core/types.h"
#include "imbibe/geometry/bounds.h"
#include "imbibe/liquid/particles.h"

namespace imbibe {

class Occupancy {
 public:
  // Places of `particles` inside `region`; a place is free when none lies nearer than `clearance` (m, > 0).
  void reset(std::span<const Float4> particles, const Bounds& region, Real clearance);
  bool is_free(const Vec3& place) const;
  void add(const Vec3& place);
  std::size_t size() const { return places_.size(); }

 private:
  struct Place {
    Vec3 at{};
    Index next = no_index;  // of the same bucket
  };
  std::uint32_t bucket_of(long x, long y, long z) const;
  std::vector<Place> places_;
  std::vector<Index> first_;  // per bucket
  Real clearance_ = 1;
};

}  // namespace imbibe
