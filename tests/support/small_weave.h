// A small plain-woven network made by hand, for tests that need yarns but no fabric builder: sine crimp, both yarn
// systems alike, axes one diameter apart at crossings. Pores and edges stay empty.
#pragma once

#include <cmath>

#include "imbibe/fabric/network.h"

namespace imbibe::testing {

struct SmallWeave {
  int yarns = 10;       // of each family
  Real pitch = 1e-3;    // m
  Real radius = 2e-4;   // m
  int points_per_segment = 8;
};

inline void add_yarn(YarnNetwork& network, Family family, int number, const SmallWeave& spec) {
  const int n = spec.yarns, steps = spec.points_per_segment;
  const Real across = (number - 0.5 * (n - 1)) * spec.pitch, start = -0.5 * n * spec.pitch;
  const auto point_at = [&](int i) {
    const Real along = spec.pitch * i / steps;  // from the yarn's beginning; crossings at (k + 1/2) pitch
    // + sin alternates from crossing to crossing; warp and weft take opposite faces at each.
    const Real sign = (number % 2 == 0 ? 1 : -1) * (family == Family::warp ? 1 : -1);
    const Real z = sign * spec.radius * std::sin(pi * along / spec.pitch);
    return family == Family::warp ? Vec3{across, start + along, z} : Vec3{start + along, across, z};
  };
  const auto yarn = static_cast<Index>(network.yarn_family.size());
  network.yarn_family.push_back(family);
  network.yarn_type.push_back(0);
  for (int i = 0; i <= n * steps; ++i) network.points.push_back(point_at(i));
  for (int k = 0; k < n; ++k) {
    Real length = 0;
    for (int i = k * steps; i < (k + 1) * steps; ++i) length += norm(point_at(i + 1) - point_at(i));
    network.segment_yarn.push_back(yarn);
    network.segment_centre.push_back(point_at(k * steps + steps / 2));
    network.segment_length.push_back(length);
  }
  network.yarn_first_segment.push_back(static_cast<Index>(network.segment_yarn.size()));
  network.yarn_first_point.push_back(static_cast<Index>(network.points.size()));
}

inline YarnNetwork small_weave(const SmallWeave& spec = {}) {
  YarnNetwork network;
  network.size_x = network.size_y = spec.yarns * spec.pitch;
  network.thickness = 4 * spec.radius;
  network.pitch_x = network.pitch_y = spec.pitch;
  network.points_per_segment = spec.points_per_segment;
  YarnType type;
  type.radius = spec.radius;
  network.yarn_types.push_back(type);
  network.yarn_first_segment = {0};
  network.yarn_first_point = {0};
  for (int i = 0; i < spec.yarns; ++i) add_yarn(network, Family::warp, i, spec);
  for (int i = 0; i < spec.yarns; ++i) add_yarn(network, Family::weft, i, spec);
  return network;
}

}  // namespace imbibe::testing
