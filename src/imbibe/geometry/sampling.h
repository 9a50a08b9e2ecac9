// Points laid out evenly, for filling bodies with particles and for tests.
#pragma once

#include <vector>

#include "imbibe/core/portable.h"
#include "imbibe/core/random.h"
#include "imbibe/core/types.h"
#include "imbibe/geometry/bounds.h"

namespace imbibe {

// The points of a cubic lattice of the given spacing inside a box, the lattice centred in it.
inline std::vector<Vec3> lattice_in_box(const Bounds& box, Real spacing) {
  const Vec3 size = box.size(), centre = box.centre();
  const auto along = [&](Real length) { return static_cast<long long>(length / spacing * (1 + 1e-12)); };
  const long long nx = along(size.x), ny = along(size.y), nz = along(size.z);
  std::vector<Vec3> points;
  points.reserve(static_cast<std::size_t>(nx * ny * nz));
  const auto place = [&](long long i, long long n) { return (static_cast<Real>(i) - 0.5 * static_cast<Real>(n - 1)); };
  for (long long k = 0; k < nz; ++k) {
    for (long long j = 0; j < ny; ++j) {
      for (long long i = 0; i < nx; ++i) {
        points.push_back(centre + spacing * Vec3{place(i, nx), place(j, ny), place(k, nz)});
      }
    }
  }
  return points;
}

// The points of a cubic lattice inside a ball, the lattice centred on it.
inline std::vector<Vec3> lattice_in_ball(const Vec3& centre, Real radius, Real spacing) {
  const Vec3 half{radius, radius, radius};
  std::vector<Vec3> points = lattice_in_box({centre - half, centre + half}, spacing);
  std::erase_if(points, [&](const Vec3& p) { return squared_norm(p - centre) > radius * radius; });
  return points;
}

// `count` points spread evenly over the unit sphere: the golden-angle spiral.
inline std::vector<Vec3> directions_on_sphere(std::size_t count) {
  const Real golden_angle = pi * (3 - std::sqrt(5.0));
  std::vector<Vec3> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Real z = 1 - (2 * static_cast<Real>(i) + 1) / static_cast<Real>(count);
    const Real r = std::sqrt(1 - z * z), angle = golden_angle * static_cast<Real>(i);
    points[i] = {r * portable::cos(angle), r * portable::sin(angle), z};
  }
  return points;
}

// A point uniform in the box, from the counter's streams 0, 1, 2 after `stream`.
inline Vec3 random_in(const Bounds& box, const RandomCounter& counter, std::uint64_t stream = 0) {
  const Vec3 size = box.size();
  return box.lower + Vec3{size.x * uniform(counter, stream), size.y * uniform(counter, stream + 1),
                          size.z * uniform(counter, stream + 2)};
}

// A unit vector, every direction alike, from streams `stream` and `stream` + 1.
inline Vec3 random_direction(const RandomCounter& counter, std::uint64_t stream = 0) {
  const Real z = 2 * uniform(counter, stream) - 1, angle = 2 * pi * uniform(counter, stream + 1);
  const Real r = std::sqrt(std::max(0.0, 1 - z * z));
  return {r * portable::cos(angle), r * portable::sin(angle), z};
}

}  // namespace imbibe
