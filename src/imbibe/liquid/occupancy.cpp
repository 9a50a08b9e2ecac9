#include "imbibe/liquid/occupancy.h"

namespace imbibe {
namespace {

long cell_of(Real x, Real edge) { return static_cast<long>(std::floor(x / edge)); }

constexpr std::size_t least_buckets = 64;

}  // namespace

std::uint32_t Occupancy::bucket_of(long x, long y, long z) const {
  const auto hash = static_cast<std::uint32_t>(x) * 73856093u ^ static_cast<std::uint32_t>(y) * 19349663u ^
                    static_cast<std::uint32_t>(z) * 83492791u;
  return hash & static_cast<std::uint32_t>(first_.size() - 1);
}

void Occupancy::reset(std::span<const Float4> particles, const Bounds& region, Real clearance) {
  clearance_ = clearance;
  places_.clear();
  for (const Float4& x : particles)
    if (const Vec3 p{x.x, x.y, x.z}; region.contains(p)) places_.push_back({p, no_index});
  std::size_t buckets = least_buckets;
  while (buckets < 2 * places_.size()) buckets *= 2;
  first_.assign(buckets, no_index);
  for (Index i = 0; i < places_.size(); ++i) {
    const Vec3& p = places_[i].at;
    Index& first = first_[bucket_of(cell_of(p.x, clearance_), cell_of(p.y, clearance_), cell_of(p.z, clearance_))];
    places_[i].next = first;
    first = i;
  }
}

bool Occupancy::is_free(const Vec3& place) const {
  const long x = cell_of(place.x, clearance_), y = cell_of(place.y, clearance_), z = cell_of(place.z, clearance_);
  for (long k = z - 1; k <= z + 1; ++k)
    for (long j = y - 1; j <= y + 1; ++j)
      for (long i = x - 1; i <= x + 1; ++i)
        for (Index p = first_[bucket_of(i, j, k)]; p != no_index; p = places_[p].next)
          if (squared_norm(places_[p].at - place) < clearance_ * clearance_) return false;
  return true;
}

void Occupancy::add(const Vec3& place) {
  Index& first =
      first_[bucket_of(cell_of(place.x, clearance_), cell_of(place.y, clearance_), cell_of(place.z, clearance_))];
  places_.push_back({place, first});
  first = static_cast<Index>(places_.size() - 1);
}

}  // namespace imbibe
