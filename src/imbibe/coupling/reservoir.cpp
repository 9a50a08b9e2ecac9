#include "imbibe/coupling/reservoir.h"

#include <algorithm>
#include <cmath>

#include "imbibe/core/error.h"

namespace imbibe {
namespace {

// More than any cloth holds; finite, because the supply law takes the smaller of law and stock.
constexpr Real plenty = 1e6;  // kg

bool stands(const Reservoir& r, Real time) { return time < r.end * (1 - 1e-12); }

}  // namespace

Reservoir make_reservoir(const ReservoirSpec& spec, const YarnNetwork& network) {
  Reservoir r;
  r.pressure = spec.pressure;
  r.from_below = spec.side == ReservoirSide::back;
  if (spec.end) r.end = *spec.end;
  for (std::size_t node = 0; node < network.nodes(); ++node) {
    if (spec.feeds == ReservoirFeeds::yarns && network.is_pore(node)) continue;
    if (spec.feeds == ReservoirFeeds::pores && !network.is_pore(node)) continue;
    const Vec3& x = network.node_centre(node);
    if (std::abs(x.x - spec.centre[0]) <= 0.5 * spec.size[0] && std::abs(x.y - spec.centre[1]) <= 0.5 * spec.size[1])
      r.nodes.push_back(static_cast<Index>(node));
  }
  if (r.nodes.empty()) throw InputError("no yarn segment or pore has its centre in this part of the sheet");
  return r;
}

void append_supplies(const std::vector<Reservoir>& reservoirs, Real time, std::vector<FaceSupply>& supplies) {
  for (const Reservoir& r : reservoirs) {
    if (!stands(r, time)) continue;
    for (const Index node : r.nodes) {
      supplies.push_back({.node = node, .wetted_share = 1, .pressure = r.pressure, .available_kg = plenty,
                          .from_below = r.from_below});
    }
  }
}

Real book_supplied(std::vector<Reservoir>& reservoirs, Real time, const std::vector<Real>& taken_kg, std::size_t first) {
  Real total = 0;
  for (Reservoir& r : reservoirs) {
    if (!stands(r, time)) continue;
    Real sum = 0;
    for (std::size_t i = 0; i < r.nodes.size(); ++i) sum += taken_kg[first++];
    r.supplied_kg += sum;
    total += sum;
  }
  return total;
}

Real next_change(const std::vector<Reservoir>& reservoirs, Real time) {
  Real next = std::numeric_limits<Real>::infinity();
  for (const Reservoir& r : reservoirs) {
    if (stands(r, time)) next = std::min(next, r.end);
  }
  return next;
}

}  // namespace imbibe
