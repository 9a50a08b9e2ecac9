// What each particle sees of the solids, once per step.
//
//   lambda_i = integral of W(|x_i - y|) over the solid   [1]      G_i = grad_i lambda_i  [1/m], points into the solid
//   P_i = r(d) G_i  [1/m]: what the pressure feels of the wall (kernel.h, pressure.h)
//   several walls: lambda = 1 - prod_k (1 - lambda_k),  G = sum_k G_k prod_{l != k} (1 - lambda_l), P alike
// A wall is locally a half-space behind its nearest surface point; balls, cylinders and cones are corrected for their
// curvature (kernel.h). Edges of boxes and cones and mesh details smaller than the support are not resolved.
// A two-sided wall (a thin Box: a textile sheet) is a half-space on the particle's own side.
// Tested in tests/liquid/boundary_test.cpp.
#pragma once

#include <span>
#include <vector>

#include "imbibe/core/types.h"
#include "imbibe/liquid/kernel.h"
#include "imbibe/liquid/particles.h"
#include "imbibe/liquid/sheet_wall.h"
#include "imbibe/liquid/wall.h"

namespace imbibe {

inline constexpr int walls_per_particle = 3;  // the nearest ones; more meet only in rare corners

struct WallSample {
  float distance = 0;           // m, < 0 inside the solid
  Vec3f normal{};               // unit, out of the solid
  float lambda = 0;             // of this wall alone
  Vec3f gradient{};             // this wall's part of G (weighted as above: the samples' gradients add up to G)
  Vec3f push{};                 // this wall's part of P, weighted alike; density.h takes out walls across a gap
  float seen_contact = 1;       // as the particle alone sees it: 1 where liquid reaches this wall, 0 across a gap
  float contact = 1;            // with what the liquid below it sees (density.h)
  float friction = 0;
  Vec3f velocity{};             // of the surface along itself, m/s
  float shear = 0;              // friction * half_space_shear (kernel.h), 1/m2
  Index wall = 0;               // index into the walls of this step
  Index foot = no_index;        // of a soft sheet: index into the tile's feet
};

// Cache of one step; nothing here is state.
struct Boundary {
  // What the last queries of a mesh say about the next particle, which is mostly near the last one: a distance changes
  // by no more than the way between two points.
  struct MeshMemory {
    Vec3 clear_centre{};
    Real clear_squared = -1;  // nearer to clear_centre than its root no point has the surface within the support
  };
  struct Tile {
    std::vector<WallSample> samples;
    std::vector<SheetFoot> feet;         // on soft sheets
    std::vector<MeshMemory> mesh_memory;  // per wall, work space
    std::vector<std::uint16_t> first;  // per particle of the tile, and one end mark
  };
  std::vector<Tile> tiles;             // of default_tile particles
  std::vector<Float4> wall;            // padded, per particle: xyz = G, w = lambda; 0 far from walls
  std::vector<Float4> push;            // padded, per particle: xyz = P
  std::vector<std::uint32_t> side;     // per particle: sides of two-sided walls (neighbours.h); empty without such walls
  std::vector<std::uint8_t> dry;       // per particle: whether one of its walls is across a gap
  std::size_t near_walls = 0;          // particles with at least one sample

  std::span<const WallSample> samples(std::size_t i) const {
    const Tile& t = tiles[i / default_tile_size];
    const std::size_t k = i % default_tile_size;
    return {t.samples.data() + t.first[k], t.samples.data() + t.first[k + 1]};
  }
  std::span<WallSample> samples(std::size_t i) {
    Tile& t = tiles[i / default_tile_size];
    const std::size_t k = i % default_tile_size;
    return {t.samples.data() + t.first[k], t.samples.data() + t.first[k + 1]};
  }
  // Velocity of the wall at a sample of particle i, m/s; and impulse (N s) that the liquid gives it there.
  Vec3f wall_velocity(std::size_t i, const WallSample& s) const {
    return s.foot == no_index ? s.velocity : tiles[i / default_tile_size].feet[s.foot].velocity;
  }
  const SheetFoot& foot(std::size_t i, const WallSample& s) const { return tiles[i / default_tile_size].feet[s.foot]; }
  void give(std::size_t i, const WallSample& s, const Vec3& impulse) {
    if (s.foot != no_index) tiles[i / default_tile_size].feet[s.foot].impulse += impulse;
  }
  static constexpr std::size_t default_tile_size = 512;
};

// The feet on soft sheets of all particles that liquid joins to the sheet, with the pushes that density.h left them.
void collect_feet(Boundary& boundary, std::vector<SheetFoot*>& feet);

// Impulses of all feet to the nodes of their sheets (SheetWall::impulse), in fixed order; wall_impulse of a sheet becomes
// their sum.
void give_feet_impulses(const Boundary& boundary, std::span<const Wall> walls, std::vector<Vec3>& wall_impulse);

// Samples all walls within the support radius of each particle; position: padded, count particles.
void sample_walls(Boundary& boundary, std::span<const Float4> position, std::size_t count, std::span<const Wall> walls,
                  const Kernel& kernel);

// impulse[wall] += scale * sum_i coefficient[i] * P of wall at i, in fixed order. With coefficient = pressure
// acceleration factor k_i (a_i = -k_i P_i) and scale = m dt this is the impulse the liquid gives to each wall.
void add_wall_impulse(const Boundary& boundary, std::span<const float> coefficient, Real scale,
                      std::vector<Vec3>& impulse);

// Positional safety net after the move from `before` to `position`: a particle that ended inside a solid, or beyond the
// sheet it was in front of, is put back on the surface it entered through and loses its velocity into the solid. What
// it lost, per wall, is added to impulse (N s). Returns the number of particles put back.
std::size_t keep_outside(const Boundary& boundary, std::span<const Float4> before, std::span<Float4> position,
                         std::span<Float4> velocity, std::size_t count, std::span<const Wall> walls, Real spacing,
                         Real particle_mass, std::vector<Vec3>& impulse);

}  // namespace imbibe
