// Which particles are within the support radius of which: rebuilt every step, for sorted particles.
//
// Sparse grid: a cell (edge = support radius) exists only where particles are. Particles are sorted (stable radix sort)
// by the row-major 64-bit key of their cell, so the cells of one row of three are one contiguous range, found by
// cursors that only move forward. Memory follows occupied cells; nothing is hashed.
// Lists: slices of 8 particles, one vector lane per particle, slot-major: slot k of a slice holds the k-th neighbour of
// each of its 8 particles. Lanes with fewer neighbours are padded with a far dummy whose contribution is exactly 0.
// Both-way lists (j in i's and i in j's): every loop gathers, none scatters.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "imbibe/core/parallel.h"
#include "imbibe/core/types.h"
#include "imbibe/liquid/kernel.h"
#include "imbibe/liquid/particles.h"
#include "imbibe/liquid/simd.h"

namespace imbibe {

// Number of records in a padded array of n particles: n rounded up to whole slices, plus the far dummy (the last).
inline std::size_t padded_size(std::size_t n) { return (n + simd::lanes - 1) / simd::lanes * simd::lanes + 1; }

// The neighbours of 8 consecutive particles.
struct Slice {
  std::size_t first = 0;         // particle of lane 0
  std::size_t slots = 0;         // longest list of the 8
  const Index* index = nullptr;  // slot k, lane l: index[8 k + l], an index into padded arrays
  const float* slope = nullptr;  // W'(r)/r of that pair, 0 in padding
};

// The lists of default_tile particles, and the work space to build them.
struct NeighbourTile {
  std::vector<Index> index;
  std::vector<float> slope;
  std::array<std::uint32_t, default_tile / simd::lanes + 1> begin{};  // first slot of each slice

  struct Candidates {
    std::vector<float> x, y, z;
    std::vector<Index> id;
    std::vector<std::uint32_t> side;
  } candidates;
  std::array<std::vector<Index>, simd::lanes> lane_index;
  std::array<std::vector<float>, simd::lanes> lane_square;
};

struct OccupiedCell {
  std::uint64_t key = 0;
  Index first = 0;  // particle
};

struct Neighbours {
  Kernel kernel;
  std::size_t count = 0;              // particles
  std::vector<NeighbourTile> tiles;   // of default_tile particles
  std::vector<OccupiedCell> cells;    // in key order, with one end mark
  std::vector<Index> order;           // order[i] = index before sorting of particle i
  // Coordinates apart, for the search.
  std::vector<float> x, y, z;
  std::uint64_t row = 0, layer = 0;   // key distance of the next row (y) and layer (z) of cells
  // Work space of the sort.
  std::vector<std::uint64_t> key, key_swap;
  std::vector<Index> order_swap;
  std::vector<std::uint32_t> histogram;
  std::vector<Float4> record_swap;
  std::vector<float> scalar_swap;
  std::vector<Real> real_swap;
  std::vector<Index> id_swap;
  std::vector<ParticleClass> kind_swap;

  Slice slice(std::size_t first) const {
    const NeighbourTile& tile = tiles[first / default_tile];
    const std::size_t s = first % default_tile / simd::lanes;
    const std::size_t begin = tile.begin[s];
    return {first, tile.begin[s + 1] - begin, tile.index.data() + begin * simd::lanes,
            tile.slope.data() + begin * simd::lanes};
  }
};

// Sorts particles by cell: fills cells and order, and permutes every array of `particles`.
void sort_particles(Neighbours& n, Particles& particles, const Kernel& kernel);

// Fills the lists of sorted particles. position: padded (see pad_positions). side: empty, or per particle the sides of
// thin sheets it lies on (boundary.h): particles on different sides of a sheet are not neighbours.
void build_lists(Neighbours& n, std::span<const Float4> position, std::span<const std::uint32_t> side);

// Sets the tail lanes and the dummy of a padded position array far away, at different places, so that nothing sees
// them and they do not see each other.
void pad_positions(std::vector<Float4>& position, std::size_t count);

// True when sides a and b lie on different sides of some sheet: low 16 bits "above", high 16 bits "below", a bit a sheet.
inline bool separated(std::uint32_t a, std::uint32_t b) { return (a & (b << 16 | b >> 16)) != 0; }

// Calls body(slice) for every slice, tiles in parallel.
template <class Body>
void for_each_slice(const Neighbours& n, Body&& body) {
  parallel_tiles(n.count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; i += simd::lanes) body(n.slice(i));
  });
}

}  // namespace imbibe
