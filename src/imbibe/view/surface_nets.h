// The surface of a scalar field on a sparse grid as a smooth triangle mesh.
//
// Naive surface nets (Gibson, "Constrained elastic surface nets", 1998): every cell whose corners lie on both sides of
// the surface gets one vertex, the mean of its edges' crossings; every grid edge that crosses gets the quad of its four
// cells. Then Taubin smoothing (SIGGRAPH 1995), pairs of a shrinking and an inflating Laplacian step (0.5, -0.53),
// which takes out the grid's steps and keeps the volume.
// The grid exists only in blocks of 8 x 8 x 8 nodes; a missing block is outside. Tested in
// tests/view/liquid_surface_test.cpp.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "imbibe/view/frame.h"

namespace imbibe {

struct BlockGrid {
  static constexpr int side = 8;
  static constexpr int nodes = side * side * side;
  static constexpr Index missing = no_index;

  Vec3 origin{};                         // m, of node (0, 0, 0)
  Real cell = 1;                         // m
  std::vector<std::uint64_t> keys;       // of the blocks, sorted
  std::vector<std::array<float, nodes>> values;          // x fastest
  std::vector<std::array<Index, 27>> neighbours;         // of each block; index by neighbour_slot
};

// Block coordinates are 0 .. 2^20; a key sorts by z, then y, then x.
constexpr std::uint64_t block_key(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
  return (z << 42) | (y << 21) | x;
}
constexpr std::array<std::int64_t, 3> block_of_key(std::uint64_t key) {
  return {static_cast<std::int64_t>(key & 0x1fffff), static_cast<std::int64_t>((key >> 21) & 0x1fffff),
          static_cast<std::int64_t>(key >> 42)};
}
constexpr std::size_t neighbour_slot(int dx, int dy, int dz) {
  return static_cast<std::size_t>((dz + 1) * 9 + (dy + 1) * 3 + dx + 1);
}

// A grid over the given blocks (any order, repetitions allowed), all values zero.
BlockGrid block_grid(std::vector<std::uint64_t> keys, const Vec3& origin, Real cell);

DrawnMesh surface_nets(const BlockGrid& grid, float iso);

void relax(DrawnMesh& mesh, int pairs);
// Area-weighted, then averaged over neighbours `rounds` times: highlights show the shape, not the particles.
void compute_normals(DrawnMesh& mesh, int rounds = 0);

}  // namespace imbibe
