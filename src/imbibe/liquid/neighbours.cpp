#include "imbibe/liquid/neighbours.h"

#include <algorithm>
#include <bit>

#include "imbibe/core/error.h"

namespace imbibe {

namespace {

using simd::Floats;
using simd::Ints;
using simd::lanes;

constexpr float far_away = 1e15f;  // its square is still finite in single precision
constexpr std::size_t sort_chunks = 8;  // fixed, so the sort does the same for any number of threads
constexpr int digit_bits = 8;
constexpr std::size_t digits = std::size_t{1} << digit_bits;

struct CellRange {
  std::int64_t low[3], high[3];
};

std::int64_t cell_of(float x, float inverse) { return static_cast<std::int64_t>(std::floor(x * inverse)); }

// Only liquid that blew up lies where cells have no number: beyond 2^50 of them from the origin, or nowhere (NaN).
CellRange cell_range(std::span<const Float4> position, float inverse) {
  const float inf = std::numeric_limits<float>::infinity();
  Float4 low{inf, inf, inf, 0}, high{-inf, -inf, -inf, 0};
  bool numbered = true;
  for (const Float4& p : position) {
    low.x = std::min(low.x, p.x), low.y = std::min(low.y, p.y), low.z = std::min(low.z, p.z);
    high.x = std::max(high.x, p.x), high.y = std::max(high.y, p.y), high.z = std::max(high.z, p.z);
    numbered &= (std::abs(p.x) + std::abs(p.y) + std::abs(p.z)) * inverse < 0x1p50f;
  }
  if (!numbered) throw NumericalError(0, 0, "liquid", "a particle has no place or lies out of reach");
  return {{cell_of(low.x, inverse), cell_of(low.y, inverse), cell_of(low.z, inverse)},
          {cell_of(high.x, inverse), cell_of(high.y, inverse), cell_of(high.z, inverse)}};
}

// One stable counting pass by `digit_bits` bits of the key, in fixed chunks.
void sort_pass(Neighbours& n, int shift) {
  const std::size_t chunk = (n.count + sort_chunks - 1) / sort_chunks;
  n.histogram.assign(sort_chunks * digits, 0);
  parallel_tiles(n.count, [&](std::size_t begin, std::size_t end) {
    std::uint32_t* h = &n.histogram[begin / chunk * digits];
    for (std::size_t i = begin; i < end; ++i) ++h[n.key[i] >> shift & (digits - 1)];
  }, chunk);
  std::uint32_t total = 0;
  for (std::size_t d = 0; d < digits; ++d) {
    for (std::size_t c = 0; c < sort_chunks; ++c) {
      const std::uint32_t here = n.histogram[c * digits + d];
      n.histogram[c * digits + d] = total;
      total += here;
    }
  }
  parallel_tiles(n.count, [&](std::size_t begin, std::size_t end) {
    std::uint32_t* h = &n.histogram[begin / chunk * digits];
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t to = h[n.key[i] >> shift & (digits - 1)]++;
      n.key_swap[to] = n.key[i];
      n.order_swap[to] = n.order[i];
    }
  }, chunk);
  n.key.swap(n.key_swap);
  n.order.swap(n.order_swap);
}

template <class T>
void permute(std::vector<T>& values, std::vector<T>& swap, const std::vector<Index>& order) {
  IMBIBE_ASSERT(values.size() == order.size());
  swap.resize(order.size());
  parallel_for(order.size(), [&](std::size_t i) { swap[i] = values[order[i]]; }, 4096);
  values.swap(swap);
}

std::vector<Float4>& swap_for(Neighbours& n, const std::vector<Float4>&) { return n.record_swap; }
std::vector<float>& swap_for(Neighbours& n, const std::vector<float>&) { return n.scalar_swap; }
std::vector<Index>& swap_for(Neighbours& n, const std::vector<Index>&) { return n.id_swap; }
std::vector<Real>& swap_for(Neighbours& n, const std::vector<Real>&) { return n.real_swap; }
std::vector<ParticleClass>& swap_for(Neighbours& n, const std::vector<ParticleClass>&) { return n.kind_swap; }

void find_keys(Neighbours& n, std::span<const Float4> position) {
  const float inverse = n.kernel.inverse;
  const CellRange range = cell_range(position, inverse);
  Real cells = 1;
  std::uint64_t size[3];
  for (int a = 0; a < 3; ++a) {
    size[a] = static_cast<std::uint64_t>(range.high[a] - range.low[a] + 3);  // one empty cell at either end
    cells *= static_cast<Real>(size[a]);
  }
  if (!(cells < 0x1p62))
    throw NumericalError(0, 0, "liquid", "particles lie too far apart to be sorted: give the scene a domain that they leave");
  n.row = size[0];
  n.layer = size[0] * size[1];
  parallel_for(n.count, [&](std::size_t i) {
    const Float4& p = position[i];
    const auto at = [&](float x, int a) { return static_cast<std::uint64_t>(cell_of(x, inverse) - range.low[a] + 1); };
    n.key[i] = at(p.z, 2) * n.layer + at(p.y, 1) * n.row + at(p.x, 0);
    n.order[i] = static_cast<Index>(i);
  }, 4096);
}

void find_cells(Neighbours& n) {
  n.cells.clear();
  for (std::size_t i = 0; i < n.count; ++i) {
    if (i == 0 || n.key[i] != n.key[i - 1]) n.cells.push_back({n.key[i], static_cast<Index>(i)});
  }
  n.cells.push_back({~std::uint64_t{0}, static_cast<Index>(n.count)});
}

// For each pattern of 8 bits the lanes that are set, first ones first: a compressing shuffle without special
// instructions.
struct CompressTable {
  alignas(32) std::int32_t lane[256][lanes];
  constexpr CompressTable() : lane() {
    for (int pattern = 0; pattern < 256; ++pattern) {
      int k = 0;
      for (int l = 0; l < lanes; ++l) {
        if (pattern >> l & 1) lane[pattern][k++] = l;
      }
    }
  }
};
constexpr CompressTable compress_table;

constexpr Ints first_lanes = {0, 1, 2, 3, 4, 5, 6, 7};

using Candidates = NeighbourTile::Candidates;

// The particles of the 27 cells around a cell, as nine contiguous ranges. The cursors only move forward.
struct RowCursors {
  std::array<std::size_t, 9> at;
  std::array<std::uint64_t, 9> offset;

  RowCursors(const Neighbours& n, std::uint64_t key) {
    for (int r = 0; r < 9; ++r) {
      offset[static_cast<std::size_t>(r)] =
          static_cast<std::uint64_t>(r / 3 - 1) * n.layer + static_cast<std::uint64_t>(r % 3 - 1) * n.row;
      const std::uint64_t first = key + offset[static_cast<std::size_t>(r)] - 1;
      at[static_cast<std::size_t>(r)] = static_cast<std::size_t>(
          std::lower_bound(n.cells.begin(), n.cells.end(), first,
                           [](const OccupiedCell& c, std::uint64_t k) { return c.key < k; }) - n.cells.begin());
    }
  }
};

// Copies the candidates of one cell; returns their number, padded to whole vectors with far ones.
std::size_t gather_candidates(const Neighbours& n, RowCursors& rows, std::uint64_t key,
                              std::span<const std::uint32_t> side, Candidates& out) {
  std::size_t count = 0;
  for (std::size_t r = 0; r < 9; ++r) {
    const std::uint64_t low = key + rows.offset[r] - 1, high = low + 2;
    std::size_t& c = rows.at[r];
    while (n.cells[c].key < low) ++c;
    std::size_t e = c;
    while (n.cells[e].key <= high) ++e;
    const std::size_t begin = n.cells[c].first, size = n.cells[e].first - begin;
    if (size == 0) continue;
    if (out.x.size() < count + size + lanes) {
      const std::size_t room = 2 * (count + size + lanes);
      out.x.resize(room), out.y.resize(room), out.z.resize(room), out.id.resize(room), out.side.resize(room);
    }
    // Whole vectors, past the end of the range too: ranges are short, and what is too much is overwritten.
    for (std::size_t k = 0; k < size; k += lanes) {
      const std::size_t from = begin + k, to = count + k;
      simd::store(&out.x[to], simd::load(&n.x[from]));
      simd::store(&out.y[to], simd::load(&n.y[from]));
      simd::store(&out.z[to], simd::load(&n.z[from]));
      const Ints id = first_lanes + static_cast<std::int32_t>(from);
      std::memcpy(&out.id[to], &id, sizeof id);
    }
    if (!side.empty()) std::copy_n(side.data() + begin, size, out.side.data() + count);
    count += size;
  }
  const std::size_t padded = (count + lanes - 1) / lanes * lanes;
  for (std::size_t k = count; k < padded; ++k) {
    out.x[k] = out.y[k] = out.z[k] = far_away;
    out.id[k] = no_index, out.side[k] = 0;
  }
  return padded;
}

// Appends the neighbours of particle i among the candidates to one lane's list; returns their number.
std::size_t search(const Neighbours& n, std::size_t i, const Candidates& c, std::size_t count,
                   std::span<const std::uint32_t> side, std::vector<Index>& index, std::vector<float>& square) {
  if (index.size() < count + 2 * lanes) index.resize(2 * count + 2 * lanes), square.resize(2 * count + 2 * lanes);
  const Floats x = simd::broadcast(n.x[i]), y = simd::broadcast(n.y[i]), z = simd::broadcast(n.z[i]);
  const Floats limit = simd::broadcast(n.kernel.support * n.kernel.support);
  const Ints self = Ints{} + static_cast<std::int32_t>(i);
  const std::uint32_t own = side.empty() ? 0 : side[i];
  const Ints opposite = Ints{} + static_cast<std::int32_t>(own << 16 | own >> 16);
  std::size_t found = 0;
  for (std::size_t k = 0; k < count; k += lanes) {
    const Floats dx = x - simd::load(&c.x[k]), dy = y - simd::load(&c.y[k]), dz = z - simd::load(&c.z[k]);
    const Floats d2 = dx * dx + dy * dy + dz * dz;
    const Ints id = simd::load_int(&c.id[k]);
    Ints near = (d2 < limit) & (id != self);
    if (own != 0) near &= (simd::load_int(&c.side[k]) & opposite) == 0;
    const unsigned pattern = simd::bits(near);  // nothing found is stored too: half of the vectors, not to be foreseen
    const Ints lane = simd::load_int(compress_table.lane[pattern]);
    const Ints ids = simd::permuted(id, lane);
    std::memcpy(&index[found], &ids, sizeof ids);
    simd::store(&square[found], simd::permuted(d2, lane));
    found += static_cast<std::size_t>(std::popcount(pattern));
  }
  return found;
}

// Turns eight lists into slots, four at a time, and adds W'(r)/r.
void store_slice(const Neighbours& n, NeighbourTile& tile, const std::array<std::size_t, lanes>& found,
                 std::size_t used, std::size_t slots) {
  const auto dummy = static_cast<Index>(padded_size(n.count) - 1);
  const std::size_t rounded = (slots + 3) / 4 * 4;
  if (tile.index.size() < (used + rounded) * lanes) {
    tile.index.resize((used + rounded) * lanes * 5 / 4);
    tile.slope.resize(tile.index.size());
  }
  for (std::size_t l = 0; l < lanes; ++l) {
    if (tile.lane_index[l].size() < rounded) tile.lane_index[l].resize(rounded), tile.lane_square[l].resize(rounded);
    std::fill(tile.lane_index[l].begin() + static_cast<std::ptrdiff_t>(found[l]),
              tile.lane_index[l].begin() + static_cast<std::ptrdiff_t>(rounded), dummy);
    std::fill(tile.lane_square[l].begin() + static_cast<std::ptrdiff_t>(found[l]),
              tile.lane_square[l].begin() + static_cast<std::ptrdiff_t>(rounded), far_away);
  }
  const auto columns = [&](const auto& lists, std::size_t k) {
    const auto row = [&](std::size_t l) {
      simd::Row r;
      std::memcpy(&r, lists[l].data() + k, sizeof r);
      return r;
    };
    return simd::detail::transposed(row(0), row(1), row(2), row(3), row(4), row(5), row(6), row(7));
  };
  const float inverse = n.kernel.inverse, scale = n.kernel.slope_scale;
  for (std::size_t k = 0; k < rounded; k += 4) {
    const simd::Floats4 ids = columns(tile.lane_index, k), squares = columns(tile.lane_square, k);
    const Floats id[4] = {ids.x, ids.y, ids.z, ids.w};
    const Floats square[4] = {squares.x, squares.y, squares.z, squares.w};
    for (std::size_t s = 0; s < 4; ++s) {
      const std::size_t to = (used + k + s) * lanes;
      std::memcpy(&tile.index[to], &id[s], sizeof id[s]);
      const Floats t = simd::max(1 - simd::sqrt(square[s]) * inverse, 0.0f);
      simd::store(&tile.slope[to], scale * t * t * t);
    }
  }
}

void build_tile(Neighbours& n, std::size_t t, std::span<const std::uint32_t> side) {
  NeighbourTile& tile = n.tiles[t];
  const std::size_t begin = t * default_tile, end = std::min(begin + default_tile, n.count);
  const auto after = std::upper_bound(n.cells.begin(), n.cells.end(), begin,
                                      [](std::size_t i, const OccupiedCell& c) { return i < c.first; });
  std::size_t cell = static_cast<std::size_t>(after - n.cells.begin()) - 1;
  RowCursors rows(n, n.cells[cell].key);
  std::size_t candidates = gather_candidates(n, rows, n.cells[cell].key, side, tile.candidates);
  std::size_t used = 0;
  for (std::size_t first = begin; first < end; first += lanes) {
    std::array<std::size_t, lanes> found{};
    std::size_t slots = 0;
    for (std::size_t l = 0; l < lanes && first + l < end; ++l) {
      const std::size_t i = first + l;
      if (i >= n.cells[cell + 1].first) {
        ++cell;
        candidates = gather_candidates(n, rows, n.cells[cell].key, side, tile.candidates);
      }
      found[l] = search(n, i, tile.candidates, candidates, side, tile.lane_index[l], tile.lane_square[l]);
      slots = std::max(slots, found[l]);
    }
    store_slice(n, tile, found, used, slots);
    tile.begin[(first - begin) / lanes] = static_cast<std::uint32_t>(used);
    used += slots;
    tile.begin[(first - begin) / lanes + 1] = static_cast<std::uint32_t>(used);
  }
}

}  // namespace

void sort_particles(Neighbours& n, Particles& particles, const Kernel& kernel) {
  n.kernel = kernel;
  n.count = particles.size();
  n.key.resize(n.count), n.key_swap.resize(n.count);
  n.order.resize(n.count), n.order_swap.resize(n.count);
  if (n.count > 0) find_keys(n, particles.position);
  std::uint64_t greatest = 0;
  for (const std::uint64_t k : n.key) greatest = std::max(greatest, k);
  for (int shift = 0; shift < 64 && greatest >> shift != 0; shift += digit_bits) sort_pass(n, shift);
  find_cells(n);
  const auto permute_all = [&](auto& array) { permute(array, swap_for(n, array), n.order); };
  visit_arrays(particles, permute_all);
}

void build_lists(Neighbours& n, std::span<const Float4> position, std::span<const std::uint32_t> side) {
  IMBIBE_ASSERT(position.size() >= n.count);
  for (auto* array : {&n.x, &n.y, &n.z}) array->resize(n.count + lanes);  // whole vectors can be read from any particle
  parallel_for(n.count, [&](std::size_t i) {
    n.x[i] = position[i].x, n.y[i] = position[i].y, n.z[i] = position[i].z;
  }, 4096);
  n.tiles.resize((n.count + default_tile - 1) / default_tile);
  parallel_for(n.tiles.size(), [&](std::size_t t) { build_tile(n, t, side); }, 1);
}

void pad_positions(std::vector<Float4>& position, std::size_t count) {
  position.resize(padded_size(count));
  for (std::size_t i = count; i + 1 < position.size(); ++i) {
    position[i] = {-far_away, -far_away, -far_away * (1 + 0.01f * static_cast<float>(i - count)), 0};
  }
  position.back() = {far_away, far_away, far_away, 0};
}

}  // namespace imbibe
