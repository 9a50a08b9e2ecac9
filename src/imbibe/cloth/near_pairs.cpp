// The list of near pairs: broad phase over a hashed grid of triangle boxes.
#include <map>

#include "imbibe/cloth/self_contact.h"
#include "imbibe/core/parallel.h"
#include "imbibe/core/portable.h"
#include "imbibe/geometry/bounds.h"

namespace imbibe {
namespace {

constexpr std::size_t triangle_tile = 1024, node_tile = 4096;
constexpr Real slow_room = 0.2, fast_room = 0.5;  // of the shortest edge

bool shares_node(const std::array<Index, 3>& a, const std::array<Index, 3>& b) {
  for (const Index i : a) {
    for (const Index j : b) {
      if (i == j) return true;
    }
  }
  return false;
}

struct Grid {
  Vec3 origin{};
  Vec3 reach{};  // half the size of the largest boxes
  Real inverse_cell = 0;
  std::uint32_t mask = 0;
  std::uint32_t row = 1, layer = 1;  // cells of a row and a layer: neighbours along x lie side by side in memory
  std::array<std::int32_t, 3> cell_of(const Vec3& p) const {
    const Vec3 c = inverse_cell * (p - origin);
    return {static_cast<std::int32_t>(std::floor(c.x)), static_cast<std::int32_t>(std::floor(c.y)),
            static_cast<std::int32_t>(std::floor(c.z))};
  }
  std::uint32_t bucket_of(const std::array<std::int32_t, 3>& c) const {
    return (static_cast<std::uint32_t>(c[0]) + row * static_cast<std::uint32_t>(c[1]) +
            layer * static_cast<std::uint32_t>(c[2])) & mask;
  }
};

// Where a triangle can come, and half the thickness around it.
Bounds box_of(const Sheet& sheet, std::size_t triangle, Real thickness, const std::vector<Real>& room) {
  Bounds box;
  Real most = 0;
  for (const Index i : sheet.triangles[triangle]) box.include(sheet.position[i]), most = std::max(most, room[i]);
  box.grow(most + 0.5 * thickness);
  return box;
}

// Cells as large as the largest box, so that boxes that overlap lie in neighbouring cells.
Grid make_grid(const Sheet& sheet, Real thickness, SelfContact& c) {
  const std::size_t n = sheet.triangles.size();
  struct Extent {
    Bounds all{};
    Vec3 size{};
    Extent& operator+=(const Extent& o) { return all.include(o.all), grow(o.size), *this; }
    void grow(const Vec3& o) { size = {std::max(size.x, o.x), std::max(size.y, o.y), std::max(size.z, o.z)}; }
  };
  c.normal.resize(n), c.cell.resize(n), c.box.resize(n);
  const Extent extent = parallel_sum(n, [&](std::size_t begin, std::size_t end) {
    Extent e;
    for (std::size_t k = begin; k < end; ++k) {
      const Bounds box = c.box[k] = box_of(sheet, k, thickness, c.room);
      e.all.include(box);
      e.grow(box.size());
      const auto& t = sheet.triangles[k];
      c.normal[k] = normalized(cross(sheet.position[t[1]] - sheet.position[t[0]],
                                     sheet.position[t[2]] - sheet.position[t[0]]));
    }
    return e;
  }, triangle_tile);
  Grid grid{.origin = extent.all.lower, .reach = 0.5 * extent.size,
            .inverse_cell = 1 / std::max({extent.size.x, extent.size.y, extent.size.z})};
  const auto cells = grid.cell_of(extent.all.upper);
  grid.row = static_cast<std::uint32_t>(cells[0] + 1) | 1u;  // odd: rows do not fall on each other in the table
  grid.layer = grid.row * (static_cast<std::uint32_t>(cells[1] + 1) | 1u);
  std::uint32_t buckets = 1;
  while (buckets < 2 * n) buckets *= 2;
  grid.mask = buckets - 1;
  return grid;
}

void fill_grid(const Grid& grid, SelfContact& c) {
  const std::size_t n = c.box.size();
  parallel_for(n, [&](std::size_t k) { c.cell[k] = grid.cell_of(c.box[k].centre()); }, triangle_tile);
  c.bucket_start.assign(grid.mask + 2, 0);
  for (std::size_t k = 0; k < n; ++k) ++c.bucket_start[grid.bucket_of(c.cell[k]) + 1];
  for (std::size_t b = 0; b <= grid.mask; ++b) c.bucket_start[b + 1] += c.bucket_start[b];
  c.bucket_triangle.resize(n);
  std::vector<std::uint32_t>& place = c.zone;  // work space of the same kind
  place.assign(c.bucket_start.begin(), c.bucket_start.end() - 1);
  for (std::size_t k = 0; k < n; ++k) c.bucket_triangle[place[grid.bucket_of(c.cell[k])]++] = static_cast<Index>(k);
}

struct Search {
  const Sheet& sheet;
  const SelfContact& contact;
  Real thickness;
  std::vector<ClosePair>& found;

  std::array<Vec3, 4> places(const std::array<Index, 4>& node) const {
    return {sheet.position[node[0]], sheet.position[node[1]], sheet.position[node[2]], sheet.position[node[3]]};
  }
  // Pieces that are near in the cloth itself keep less than the thickness: what the cloth leaves between them.
  Real kept(const std::array<Index, 4>& node, PairKind kind) const {
    Real squared = std::numeric_limits<Real>::infinity();
    const std::size_t firsts = kind == PairKind::node_triangle ? 1 : 2;
    for (std::size_t i = 0; i < firsts; ++i) {
      for (std::size_t j = firsts; j < 4; ++j) {
        const Real du = sheet.u[node[i]] - sheet.u[node[j]], dv = sheet.v[node[i]] - sheet.v[node[j]];
        squared = std::min(squared, du * du + dv * dv);
      }
    }
    return std::min(thickness, 0.5 * std::sqrt(squared));
  }
  void consider(const std::array<Index, 4>& node, PairKind kind) {
    const std::array<Vec3, 4> x = places(node);
    const std::size_t firsts = kind == PairKind::node_triangle ? 1 : 2;
    Bounds a, b;
    Real room_a = 0, room_b = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      (k < firsts ? a : b).include(x[k]);
      Real& room = k < firsts ? room_a : room_b;
      room = std::max(room, contact.room[node[k]]);
    }
    const Real reach = thickness + room_a + room_b;  // pairs nearer than this are listed
    a.grow(reach);
    if (!a.overlaps(b) || !(gap_of(kind, x).distance < reach)) return;
    found.push_back({node, kind, kept(node, kind)});
  }
  void nodes_of(std::size_t owner, std::size_t other) {
    const auto& t = sheet.triangles[other];
    for (const Index i : contact.owners.of_triangle[owner].node) {
      if (i != no_index && i != t[0] && i != t[1] && i != t[2]) consider({i, t[0], t[1], t[2]}, PairKind::node_triangle);
    }
  }
  bool is_slow(std::size_t triangle) const {
    for (const Index i : sheet.triangles[triangle]) {
      if (contact.room[i] > slow_room * contact.owners.shortest_edge) return false;
    }
    return true;
  }
  void visit(std::size_t ta, std::size_t tb) {
    // Neighbours at a corner that are nearly flat: no pieces of theirs can meet before they have turned, which
    // takes more than the room of slow nodes; fast ones are looked at.
    if (dot(contact.normal[ta], contact.normal[tb]) > 0.5 && shares_node(sheet.triangles[ta], sheet.triangles[tb]) &&
        is_slow(ta) && is_slow(tb)) {
      return;
    }
    nodes_of(ta, tb);
    nodes_of(tb, ta);
    for (const Index e : contact.owners.of_triangle[ta].edge) {
      if (e == no_index) continue;
      for (const Index f : contact.owners.of_triangle[tb].edge) {
        if (f == no_index) continue;
        const auto &p = contact.owners.edges[e], &q = contact.owners.edges[f];
        if (p[0] == q[0] || p[0] == q[1] || p[1] == q[0] || p[1] == q[1]) continue;
        consider({p[0], p[1], q[0], q[1]}, PairKind::edge_edge);
      }
    }
  }
};

// Triangles of higher number whose boxes overlap, rising: the order of the list does not depend on the grid, so
// it does not matter to the bits when the list was made.
void neighbours_of(std::size_t k, const Grid& grid, const SelfContact& c, std::vector<Index>& others) {
  others.clear();
  const Bounds& box = c.box[k];
  // Centres of the boxes that overlap this one lie in these cells.
  const auto lower = grid.cell_of(box.lower - grid.reach), upper = grid.cell_of(box.upper + grid.reach);
  for (std::int32_t z = lower[2]; z <= upper[2]; ++z) {
    for (std::int32_t y = lower[1]; y <= upper[1]; ++y) {
      for (std::int32_t x = lower[0]; x <= upper[0]; ++x) {
        const std::uint32_t bucket = grid.bucket_of({x, y, z});
        for (std::uint32_t e = c.bucket_start[bucket]; e < c.bucket_start[bucket + 1]; ++e) {
          const Index other = c.bucket_triangle[e];
          if (other <= k || !box.overlaps(c.box[other])) continue;
          const auto& place = c.cell[other];
          if (place[0] == x && place[1] == y && place[2] == z) others.push_back(other);
        }
      }
    }
  }
  std::sort(others.begin(), others.end());
}

}  // namespace

SelfOwners make_owners(const Sheet& sheet) {
  SelfOwners owners;
  owners.of_triangle.resize(sheet.triangles.size());
  std::vector<bool> owned(sheet.size());
  std::map<std::array<Index, 2>, Index> seen;
  Real shortest = std::numeric_limits<Real>::infinity();
  for (std::size_t k = 0; k < sheet.triangles.size(); ++k) {
    const auto& t = sheet.triangles[k];
    for (std::size_t c = 0; c < 3; ++c) {
      const Index a = std::min(t[c], t[(c + 1) % 3]), b = std::max(t[c], t[(c + 1) % 3]);
      if (!owned[t[c]]) owned[t[c]] = true, owners.of_triangle[k].node[c] = t[c];
      if (seen.emplace(std::array{a, b}, static_cast<Index>(owners.edges.size())).second) {
        owners.of_triangle[k].edge[c] = static_cast<Index>(owners.edges.size());
        owners.edges.push_back({a, b});
        shortest = std::min(shortest, portable::hypot(sheet.u[a] - sheet.u[b], sheet.v[a] - sheet.v[b]));
      }
    }
  }
  owners.shortest_edge = shortest;
  return owners;
}

void list_near_pairs(const Sheet& sheet, Real thickness, SelfContact& c) {
  const Grid grid = make_grid(sheet, thickness, c);
  fill_grid(grid, c);
  const std::size_t n = sheet.triangles.size(), tiles = (n + triangle_tile - 1) / triangle_tile;
  c.tile_pairs.resize(tiles);
  parallel_tiles(n, [&](std::size_t begin, std::size_t end) {
    auto& found = c.tile_pairs[begin / triangle_tile];
    found.clear();
    Search search{sheet, c, thickness, found};
    std::vector<Index> others;
    for (std::size_t k = begin; k < end; ++k) {
      neighbours_of(k, grid, c, others);
      for (const Index other : others) search.visit(k, other);
    }
  }, triangle_tile);
  c.pairs.clear();
  for (const auto& found : c.tile_pairs) c.pairs.insert(c.pairs.end(), found.begin(), found.end());
  c.thickness = thickness;
  c.moved.assign(sheet.size(), 0);
}

namespace {

Vec3 mean_velocity(const NodeMotion& nodes, std::size_t count) {
  return parallel_sum(count, [&](std::size_t begin, std::size_t end) {
    Vec3 sum;
    for (std::size_t i = begin; i < end; ++i) sum += nodes.velocity[i];
    return sum;
  }, node_tile) / static_cast<Real>(count);
}

}  // namespace

void reserve_near_pairs(const Sheet& sheet, const NodeMotion& nodes, Real thickness, Real h, SelfContact& c) {
  const Vec3 mean = mean_velocity(nodes, sheet.size());
  const auto motion = [&](std::size_t i) { return h * norm(nodes.velocity[i] - mean); };
  if (c.room.size() == sheet.size() && c.thickness == thickness) {
    const Real beyond = parallel_max(sheet.size(), Real{-1}, [&](std::size_t begin, std::size_t end) {
      Real most = -1;
      for (std::size_t i = begin; i < end; ++i) most = std::max(most, c.moved[i] + motion(i) - c.room[i]);
      return most;
    }, node_tile);
    if (beyond <= 0) return;
  }
  c.room.resize(sheet.size());
  // Room for eight substeps where that is little, else for two: more room means more pairs.
  const Real edge = c.owners.shortest_edge;
  for (std::size_t i = 0; i < sheet.size(); ++i) {
    const Real way = motion(i);
    c.room[i] = std::max({slow_room * edge, 2 * way, std::min(8 * way, fast_room * edge)});
  }
  list_near_pairs(sheet, thickness, c);
}

void note_motion(const Sheet& sheet, const NodeMotion& nodes, Real h, SelfContact& c) {
  const Vec3 mean = mean_velocity(nodes, sheet.size());
  parallel_for(sheet.size(), [&](std::size_t i) { c.moved[i] += h * norm(nodes.velocity[i] - mean); }, node_tile);
}

}  // namespace imbibe
