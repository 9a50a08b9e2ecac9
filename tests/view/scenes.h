// Frames made up for the tests of pictures.
#pragma once

#include <cmath>
#include <vector>

#include "imbibe/core/random.h"
#include "imbibe/view/frame.h"

namespace imbibe::test {

// Particles on a shaken cubic lattice inside a ball; shaken so that the lattice's planes are not the surface.
inline std::vector<Vec3f> ball_of_particles(const Vec3& centre, Real radius, Real spacing, Real shake = 0.3) {
  std::vector<Vec3f> particles;
  const int n = static_cast<int>(radius / spacing) + 2;
  std::uint64_t id = 0;
  for (int k = -n; k <= n; ++k)
    for (int j = -n; j <= n; ++j)
      for (int i = -n; i <= n; ++i) {
        Vec3 p = spacing * Vec3{i + 0.37, j + 0.11, k + 0.23};
        ++id;
        if (norm(p) > radius) continue;
        p += shake * spacing * Vec3{uniform({1, id}, 0) - 0.5, uniform({1, id}, 1) - 0.5, uniform({1, id}, 2) - 0.5};
        particles.emplace_back(centre + p);
      }
  return particles;
}

// A plain weave of n x n yarns, 1 mm apart, radius 0.25 mm, wet about its middle.
inline Frame woven_frame(int n, Real wet_radius) {
  Frame frame;
  frame.title = "A test weave";
  const Real pitch = 1e-3, radius = 0.25e-3, half = n * pitch / 2;
  for (int family = 0; family < 2; ++family)
    for (int i = 0; i < n; ++i) {
      std::vector<Vec3f> points;
      std::vector<float> saturation;
      const Real place = -half + (i + 0.5) * pitch, side = ((i % 2) != 0) == (family != 0) ? 1 : -1;
      for (int k = 0; k <= 8 * n; ++k) {
        const Real along = -half + k * pitch / 8, height = side * radius * std::sin(pi * k / 8.0);
        const Vec3 p = family == 0 ? Vec3{place, along, height} : Vec3{along, place, height};
        points.emplace_back(p);
        saturation.push_back(static_cast<float>(std::max(0.0, 1 - std::hypot(p.x, p.y) / wet_radius)));
      }
      add_yarn(frame.yarns, points, saturation, static_cast<float>(radius), {0.8f, 0.75f, 0.65f});
    }
  return frame;
}

inline Frame drop_on_weave(int n = 8) {
  Frame frame = woven_frame(n, 0.35e-3 * n);
  frame.particle_spacing = 0.3e-3;
  frame.particles = ball_of_particles({0, 0, 2e-3}, 1.4e-3, frame.particle_spacing);
  frame.time = 0.125;
  return frame;
}

}  // namespace imbibe::test
