// The triangles of a yarn's surface, made on demand: rings of corners on the centre line's points, joined into a tube
// and closed by a flat fan at both ends of the yarn. Never stored: a sheet of 10 million segments has 2.5 thousand
// million of them. Used by contact's `triangles` form.
#pragma once

#include <array>

#include "imbibe/coupling/contact_index.h"

namespace imbibe {

inline constexpr int tube_sides = 16;

// How far the triangles of any yarn lie inside the round yarn at most, m.
Real mesh_deviation(const YarnNetwork& network);

// The corners of the ring at centre-line point i of a yarn, counter-clockwise seen against the yarn's direction.
std::array<Vec3, tube_sides> tube_ring(const YarnNetwork& network, Index yarn, Index point);

Vec3 ring_centre(const std::array<Vec3, tube_sides>& ring);

// The triangles between the rings of two neighbouring centre-line points.
template <class Visit>
void visit_tube_triangles(const std::array<Vec3, tube_sides>& ring, const std::array<Vec3, tube_sides>& next,
                          Visit&& visit) {
  for (std::size_t k = 0; k < tube_sides; ++k) {
    const std::size_t l = (k + 1) % tube_sides;
    visit(ring[k], ring[l], next[l]);
    visit(ring[k], next[l], next[k]);
  }
}

// The two ends of a yarn are closed by a fan.
template <class Visit>
void visit_cap(const std::array<Vec3, tube_sides>& ring, bool at_start, Visit&& visit) {
  const Vec3 centre = ring_centre(ring);
  for (std::size_t k = 0; k < tube_sides; ++k) {
    const Vec3 &a = ring[k], &b = ring[(k + 1) % tube_sides];
    at_start ? visit(centre, b, a) : visit(centre, a, b);
  }
}

// Calls visit(a, b, c) for the triangles of the pieces of a segment's tube whose boxes pass.
template <class Test, class Visit>
void visit_segment_triangles(const YarnNetwork& network, Index yarn, Index segment, Test&& test, Visit&& visit) {
  const Real radius = radius_of_yarn(network, yarn);
  const Index first = network.yarn_first_point[yarn], last = network.yarn_first_point[yarn + 1] - 1;
  const auto points = points_of_segment(network, yarn, segment);
  const Index begin = static_cast<Index>(points.data() - network.points.data());
  std::array<Vec3, tube_sides> ring, next;
  bool have_ring = false;
  for (Index i = begin; i + 1 < begin + points.size(); ++i) {
    Bounds bounds;
    bounds.include(network.points[i]);
    bounds.include(network.points[i + 1]);
    bounds.grow(radius);
    if (!test(bounds)) {
      have_ring = false;
      continue;
    }
    if (!have_ring) ring = tube_ring(network, yarn, i);
    next = tube_ring(network, yarn, i + 1);
    if (i == first) visit_cap(ring, true, visit);
    visit_tube_triangles(ring, next, visit);
    if (i + 1 == last) visit_cap(next, false, visit);
    ring = next, have_ring = true;
  }
}

}  // namespace imbibe
