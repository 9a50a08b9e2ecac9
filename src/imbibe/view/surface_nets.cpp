#include "imbibe/view/surface_nets.h"

#include <algorithm>
#include <memory>

#include "imbibe/core/parallel.h"

namespace imbibe {

namespace {

constexpr int side = BlockGrid::side;
constexpr int padded = side + 1;
using CellVertices = std::array<Index, BlockGrid::nodes>;

constexpr std::size_t node_index(int i, int j, int k) {
  return static_cast<std::size_t>((k * side + j) * side + i);
}

// Node values of a block and of the first layer of its upper neighbours.
struct PaddedBlock {
  std::array<float, padded * padded * padded> value;
  float at(int i, int j, int k) const { return value[static_cast<std::size_t>((k * padded + j) * padded + i)]; }
};

void fill(PaddedBlock& padded_block, const BlockGrid& grid, std::size_t block) {
  std::size_t n = 0;
  for (int k = 0; k < padded; ++k)
    for (int j = 0; j < padded; ++j)
      for (int i = 0; i < padded; ++i, ++n) {
        const Index from = grid.neighbours[block][neighbour_slot(i / side, j / side, k / side)];
        padded_block.value[n] = from == BlockGrid::missing ? 0 : grid.values[from][node_index(i % side, j % side, k % side)];
      }
}

// Bit c is set when corner c of the cell (x = bit 0, y = bit 1, z = bit 2) is inside.
unsigned inside_corners(const PaddedBlock& block, int i, int j, int k, float iso) {
  unsigned mask = 0;
  for (int c = 0; c < 8; ++c)
    if (block.at(i + (c & 1), j + ((c >> 1) & 1), k + (c >> 2)) > iso) mask |= 1u << c;
  return mask;
}

// Mean of the crossings of the cell's edges, in cells from its lowest corner.
Vec3 cell_vertex(const PaddedBlock& block, int i, int j, int k, unsigned mask, float iso) {
  Vec3 sum{};
  int crossings = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (int c = 0; c < 8; ++c) {
      if (c & (1 << axis)) continue;
      const int d = c | (1 << axis);
      if (((mask >> c) & 1) == ((mask >> d) & 1)) continue;
      const float a = block.at(i + (c & 1), j + ((c >> 1) & 1), k + (c >> 2));
      const float b = block.at(i + (d & 1), j + ((d >> 1) & 1), k + (d >> 2));
      Vec3 p{static_cast<Real>(c & 1), static_cast<Real>((c >> 1) & 1), static_cast<Real>(c >> 2)};
      const Real t = (iso - a) / (b - a);
      (axis == 0 ? p.x : axis == 1 ? p.y : p.z) += t;
      sum += p;
      ++crossings;
    }
  }
  return sum / crossings;
}

// The vertex of a cell given by coordinates -1 .. 7 relative to `block`.
Index vertex_of(const BlockGrid& grid, const std::vector<CellVertices>& cells, std::size_t block, int i, int j, int k) {
  const Index from = grid.neighbours[block][neighbour_slot(i < 0 ? -1 : 0, j < 0 ? -1 : 0, k < 0 ? -1 : 0)];
  if (from == BlockGrid::missing) return no_index;
  return cells[from][node_index((i + side) % side, (j + side) % side, (k + side) % side)];
}

void add_quad(std::vector<std::array<Index, 3>>& triangles, const std::vector<Vec3f>& v, std::array<Index, 4> q,
              bool turn) {
  for (const Index corner : q)
    if (corner == no_index) return;
  if (turn) std::swap(q[1], q[3]);
  // Cut along the shorter diagonal: rounder triangles.
  if (squared_norm(v[q[0]] - v[q[2]]) <= squared_norm(v[q[1]] - v[q[3]])) {
    triangles.push_back({q[0], q[1], q[2]});
    triangles.push_back({q[0], q[2], q[3]});
  } else {
    triangles.push_back({q[1], q[2], q[3]});
    triangles.push_back({q[1], q[3], q[0]});
  }
}

void quads_of_block(const BlockGrid& grid, const std::vector<CellVertices>& cells, const PaddedBlock& values,
                    std::size_t block, float iso, const std::vector<Vec3f>& vertices,
                    std::vector<std::array<Index, 3>>& triangles) {
  for (int k = 0; k < side; ++k)
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        const bool in = values.at(i, j, k) > iso;
        const auto cell = [&](int di, int dj, int dk) { return vertex_of(grid, cells, block, i - di, j - dj, k - dk); };
        if (in != (values.at(i + 1, j, k) > iso))
          add_quad(triangles, vertices, {cell(0, 1, 1), cell(0, 0, 1), cell(0, 0, 0), cell(0, 1, 0)}, !in);
        if (in != (values.at(i, j + 1, k) > iso))
          add_quad(triangles, vertices, {cell(1, 0, 1), cell(1, 0, 0), cell(0, 0, 0), cell(0, 0, 1)}, !in);
        if (in != (values.at(i, j, k + 1) > iso))
          add_quad(triangles, vertices, {cell(1, 1, 0), cell(0, 1, 0), cell(0, 0, 0), cell(1, 0, 0)}, !in);
      }
}

// Vertices that share a mesh edge, as offsets and a flat list.
struct Adjacency {
  std::vector<Index> start, neighbour;
};

Adjacency adjacency_of(const DrawnMesh& mesh) {
  Adjacency a;
  a.start.assign(mesh.vertices.size() + 1, 0);
  // In a closed mesh every edge a-b occurs once in each direction, so the directed edges are the neighbour lists.
  for (const auto& t : mesh.triangles)
    for (const Index v : t) ++a.start[v + 1];
  for (std::size_t v = 1; v < a.start.size(); ++v) a.start[v] += a.start[v - 1];
  a.neighbour.resize(a.start.back());
  std::vector<Index> at(a.start.begin(), a.start.end() - 1);
  for (const auto& t : mesh.triangles)
    for (std::size_t c = 0; c < 3; ++c) a.neighbour[at[t[c]]++] = t[(c + 1) % 3];
  return a;
}

}  // namespace

BlockGrid block_grid(std::vector<std::uint64_t> keys, const Vec3& origin, Real cell) {
  BlockGrid grid;
  grid.origin = origin;
  grid.cell = cell;
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  grid.keys = std::move(keys);
  grid.values.resize(grid.keys.size());
  grid.neighbours.resize(grid.keys.size());
  parallel_for(grid.keys.size(), [&](std::size_t b) {
    const auto at = block_of_key(grid.keys[b]);
    for (int dz = -1; dz <= 1; ++dz)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          const std::uint64_t key = block_key(static_cast<std::uint64_t>(at[0] + dx), static_cast<std::uint64_t>(at[1] + dy),
                                              static_cast<std::uint64_t>(at[2] + dz));
          const auto found = std::lower_bound(grid.keys.begin(), grid.keys.end(), key);
          const bool there = found != grid.keys.end() && *found == key;
          grid.neighbours[b][neighbour_slot(dx, dy, dz)] =
              there ? static_cast<Index>(found - grid.keys.begin()) : BlockGrid::missing;
        }
  }, 64);
  return grid;
}

DrawnMesh surface_nets(const BlockGrid& grid, float iso) {
  const std::size_t blocks = grid.keys.size();
  std::vector<CellVertices> cells(blocks);
  std::vector<std::vector<Vec3f>> block_vertices(blocks);
  parallel_for(blocks, [&](std::size_t b) {
    cells[b].fill(no_index);
    const auto [low, high] = std::minmax_element(grid.values[b].begin(), grid.values[b].end());
    const bool alone_outside = *high <= iso && std::all_of(grid.neighbours[b].begin(), grid.neighbours[b].end(),
                                                           [](Index n) { return n == BlockGrid::missing; });
    if (alone_outside || *low > *high) return;
    PaddedBlock values;
    fill(values, grid, b);
    const auto at = block_of_key(grid.keys[b]);
    for (int k = 0; k < side; ++k)
      for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i) {
          const unsigned mask = inside_corners(values, i, j, k, iso);
          if (mask == 0 || mask == 0xff) continue;
          cells[b][node_index(i, j, k)] = static_cast<Index>(block_vertices[b].size());
          const Vec3 cell_corner{static_cast<Real>(at[0] * side + i), static_cast<Real>(at[1] * side + j),
                                 static_cast<Real>(at[2] * side + k)};
          block_vertices[b].emplace_back(grid.origin + grid.cell * (cell_corner + cell_vertex(values, i, j, k, mask, iso)));
        }
  }, 16);

  DrawnMesh mesh;
  for (std::size_t b = 0; b < blocks; ++b) {
    const Index offset = static_cast<Index>(mesh.vertices.size());
    for (Index& v : cells[b])
      if (v != no_index) v += offset;
    mesh.vertices.insert(mesh.vertices.end(), block_vertices[b].begin(), block_vertices[b].end());
  }
  std::vector<std::vector<std::array<Index, 3>>> block_triangles(blocks);
  parallel_for(blocks, [&](std::size_t b) {
    // Every crossing edge starts at a node of this block and has this block's cell on it.
    if (block_vertices[b].empty()) return;
    PaddedBlock values;
    fill(values, grid, b);
    quads_of_block(grid, cells, values, b, iso, mesh.vertices, block_triangles[b]);
  }, 16);
  for (const auto& triangles : block_triangles)
    mesh.triangles.insert(mesh.triangles.end(), triangles.begin(), triangles.end());
  return mesh;
}

void relax(DrawnMesh& mesh, int pairs) {
  if (pairs <= 0) return;
  const Adjacency adjacency = adjacency_of(mesh);
  std::vector<Vec3f> moved(mesh.vertices.size());
  for (int step = 0; step < 2 * pairs; ++step) {
    const float factor = step % 2 == 0 ? 0.5f : -0.53f;
    parallel_for(mesh.vertices.size(), [&](std::size_t v) {
      const Index first = adjacency.start[v], last = adjacency.start[v + 1];
      Vec3f mean{};
      for (Index n = first; n < last; ++n) mean += mesh.vertices[adjacency.neighbour[n]];
      const Vec3f& here = mesh.vertices[v];
      moved[v] = first == last ? here : here + (mean / static_cast<float>(last - first) - here) * factor;
    });
    mesh.vertices.swap(moved);
  }
}

void compute_normals(DrawnMesh& mesh, int rounds) {
  mesh.normals.assign(mesh.vertices.size(), Vec3f{});
  for (const auto& t : mesh.triangles) {
    const Vec3f &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const Vec3f area = cross(b - a, c - a);
    for (const Index v : t) mesh.normals[v] += area;
  }
  for (Vec3f& n : mesh.normals) n = normalized(n);
  if (rounds <= 0) return;
  const Adjacency adjacency = adjacency_of(mesh);
  std::vector<Vec3f> smoothed(mesh.normals.size());
  for (int round = 0; round < rounds; ++round) {
    parallel_for(mesh.normals.size(), [&](std::size_t v) {
      Vec3f sum = mesh.normals[v];
      for (Index n = adjacency.start[v]; n < adjacency.start[v + 1]; ++n) sum += mesh.normals[adjacency.neighbour[n]];
      smoothed[v] = normalized(sum);
    });
    mesh.normals.swap(smoothed);
  }
}

}  // namespace imbibe
