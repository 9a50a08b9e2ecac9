// A block of liquid on a body-centred lattice for tests of single stages: all fields ready up to the density.
#pragma once

#include <cmath>

#include "imbibe/core/random.h"
#include "imbibe/liquid/density.h"

namespace imbibe {

inline constexpr float spacing = 1e-4f;

// A block of a body-centred lattice of rest density, `layers` cells high, with fields ready up to the density.
struct Block {
  Liquid liquid;
  LiquidFields f;
  Shape floor = Plane{};
  std::vector<Wall> walls;

  Block(int cells, int layers, Real jitter, bool on_floor, Real gap = 0) {  // gap: to the floor, m
    liquid.particle_mass = liquid.kind.density * std::pow(static_cast<Real>(spacing), 3);
    const Real edge = std::cbrt(2.0) * liquid.spacing();
    Particles& p = liquid.particles;
    for (int k = 0; k < layers; ++k)
      for (int j = 0; j < cells; ++j)
        for (int i = 0; i < cells; ++i)
          for (Real half : {0.25, 0.75}) {
            const std::uint64_t id = p.position.size();
            const auto shake = [&](std::uint64_t s) { return jitter * spacing * (2 * uniform({7, id, 0}, s) - 1); };
            const Vec3 x = Vec3{i + half, j + half, k + half} * edge + Vec3{shake(0), shake(1), gap + shake(2)};
            const auto speed = [&](std::uint64_t s) { return uniform({8, id, 0}, s) - 0.5; };
            add_particle(liquid, x, {speed(0), speed(1), speed(2)});
          }
    if (on_floor) walls.push_back({&floor, {}, {}, false});
    sort_particles(f.neighbours, p, kernel_for(liquid.spacing()));
    begin_fields(f, liquid);
    sample_walls(f.boundary, f.position, f.count, walls, f.neighbours.kernel);
    build_lists(f.neighbours, f.position, f.boundary.side);
    compute_density(f);
  }
  // Particles farther than the support from the sides of the block.
  template <class Body>
  void each_away_from_sides(int cells, Body&& body) const {
    const float edge = std::cbrt(2.0f) * spacing, reach = f.neighbours.kernel.support;
    for (std::size_t i = 0; i < f.count; ++i) {
      const Float4& x = f.position[i];
      const float end = edge * static_cast<float>(cells);
      if (x.x > reach && x.x < end - reach && x.y > reach && x.y < end - reach) body(i);
    }
  }
  Vec3 momentum() const {
    Vec3 sum{};
    for (std::size_t i = 0; i < f.count; ++i) sum += Vec3{f.velocity[i].x, f.velocity[i].y, f.velocity[i].z};
    return sum / static_cast<Real>(f.count);
  }
  Real energy() const {
    Real sum = 0;
    for (std::size_t i = 0; i < f.count; ++i) {
      const Float4& u = f.velocity[i];
      sum += u.x * u.x + u.y * u.y + u.z * u.z;
    }
    return sum / static_cast<Real>(f.count);
  }
};

}  // namespace imbibe
