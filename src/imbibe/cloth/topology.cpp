#include "imbibe/cloth/topology.h"

#include <algorithm>
#include <bit>
#include <map>

#include "imbibe/core/error.h"
#include "imbibe/core/portable.h"

namespace imbibe {
namespace {

// Greedy colouring in the given order: each piece takes the lowest colour that none of its nodes has.
template <class Piece>
void colour(PieceList<Piece>& list, std::size_t node_count) {
  using Mask = std::uint64_t;
  constexpr std::size_t most = 64;
  std::vector<Mask> taken(node_count);
  std::vector<std::vector<Piece>> by_colour;
  std::vector<Piece> rest = std::move(list.pieces), later;
  list.pieces.clear();
  list.colours.assign(1, 0);
  // 64 colours at a time: a node of a wild mesh may have more pieces than a word has bits.
  while (!rest.empty()) {
    by_colour.assign(most, {});
    for (const Piece& piece : rest) {
      Mask used = 0;
      for (const Index i : piece.node) used |= taken[i];
      if (used == ~Mask{0}) {
        later.push_back(piece);
        continue;
      }
      const auto c = static_cast<std::size_t>(std::countr_one(used));
      for (const Index i : piece.node) taken[i] |= Mask{1} << c;
      by_colour[c].push_back(piece);
    }
    for (const auto& pieces : by_colour) {
      if (pieces.empty()) continue;
      list.pieces.insert(list.pieces.end(), pieces.begin(), pieces.end());
      list.colours.push_back(list.pieces.size());
    }
    rest = std::move(later);
    later.clear();
    std::fill(taken.begin(), taken.end(), 0);
  }
}

// --- grids ----------------------------------------------------------------------------------------------------------

struct Grid {
  Index columns, rows;
  Real du, dv;
  Index at(Index i, Index j) const { return i + columns * j; }
  // The part of a cell's width that a thread on row j (column i) stands for.
  Real row_share(Index j) const { return j == 0 || j + 1 == rows ? 0.5 : 1; }
  Real column_share(Index i) const { return i == 0 || i + 1 == columns ? 0.5 : 1; }
};

void add_threads(const Grid& g, SheetTopology& t) {
  const auto stretch = [&](Index a, Index b, Real length, Real width, bool warp) {
    t.thread_stretch.pieces.push_back({{a, b}, {-1 / length, 1 / length}, length * width, warp});
  };
  const auto bend = [&](Index a, Index b, Index c, Real length, Real width, bool warp) {
    const Real factor = width / (length * length * length);
    t.thread_bend.pieces.push_back({{a, b, c}, {1, -2, 1}, warp ? 0 : factor, warp ? factor : 0, 0});
  };
  for (Index j = 0; j < g.rows; ++j) {
    const Real width = g.dv * g.row_share(j);
    for (Index i = 0; i + 1 < g.columns; ++i) stretch(g.at(i, j), g.at(i + 1, j), g.du, width, false);
    for (Index i = 0; i + 2 < g.columns; ++i) bend(g.at(i, j), g.at(i + 1, j), g.at(i + 2, j), g.du, width, false);
    t.thread_stretch.first.push_back(t.thread_stretch.pieces.size());
    t.thread_bend.first.push_back(t.thread_bend.pieces.size());
  }
  t.thread_stretch.families = t.thread_bend.families = {0, g.rows, std::size_t{g.rows} + g.columns};
  for (Index i = 0; i < g.columns; ++i) {
    const Real width = g.du * g.column_share(i);
    for (Index j = 0; j + 1 < g.rows; ++j) stretch(g.at(i, j), g.at(i, j + 1), g.dv, width, true);
    for (Index j = 0; j + 2 < g.rows; ++j) bend(g.at(i, j), g.at(i, j + 1), g.at(i, j + 2), g.dv, width, true);
    t.thread_stretch.first.push_back(t.thread_stretch.pieces.size());
    t.thread_bend.first.push_back(t.thread_bend.pieces.size());
  }
}

void add_cells(const Grid& g, SheetTopology& t) {
  const Real area = g.du * g.dv, hu = 0.5 / g.du, hv = 0.5 / g.dv;
  for (Index j = 0; j + 1 < g.rows; ++j) {
    for (Index i = 0; i + 1 < g.columns; ++i) {
      const std::array<Index, 4> node{g.at(i, j), g.at(i + 1, j), g.at(i, j + 1), g.at(i + 1, j + 1)};
      t.cell_shear.pieces.push_back({node, {-hu, hu, -hu, hu}, {-hv, -hv, hv, hv}, area});
      // kappa_uv = s/area enters the energy twice, as kappa_uv and kappa_vu.
      t.cell_bend.pieces.push_back({node, {1, -1, -1, 1}, 0, 0, 2 / area});
    }
  }
}

// Springs along lines of nodes, each from its start by steps of (di, dj) to the end of the grid.
struct SpringLines {
  const Grid& g;
  ThreadList<SpringPiece>& list;
  SpringKind kind;
  int di, dj;

  void line(Index i, Index j) const {
    const Real rest = portable::hypot(di * g.du, dj * g.dv);
    const auto next = [](Index k, int step) { return static_cast<Index>(static_cast<int>(k) + step); };
    for (Index a = i, b = j;;) {
      const Index c = next(a, di), d = next(b, dj);  // beyond the first column or row it wraps to a large number
      if (c >= g.columns || d >= g.rows) break;
      list.pieces.push_back(make_spring(g.at(a, b), g.at(c, d), rest, kind));
      a = c, b = d;
    }
    if (list.pieces.size() > list.first.back()) list.first.push_back(list.pieces.size());
  }
  void end_family() const { list.families.push_back(list.size()); }
};

void add_grid_springs(const Grid& g, SheetTopology& t) {
  const auto lines = [&](SpringKind kind, int di, int dj) { return SpringLines{g, t.spring_threads, kind, di, dj}; };
  const auto straight = [&](SpringKind kind, int step) {
    const SpringLines weft = lines(kind, step, 0), warp = lines(kind, 0, step);
    const Index starts = static_cast<Index>(step);
    for (Index j = 0; j < g.rows; ++j)
      for (Index i = 0; i < starts; ++i) weft.line(i, j);
    weft.end_family();
    for (Index i = 0; i < g.columns; ++i)
      for (Index j = 0; j < starts; ++j) warp.line(i, j);
    warp.end_family();
  };
  straight(SpringKind::flexion, 2);
  for (const int di : {1, -1}) {
    const SpringLines diagonal = lines(SpringKind::shear, di, 1);
    const Index side = di > 0 ? 0 : g.columns - 1;
    for (Index i = 0; i < g.columns; ++i) diagonal.line(i, 0);
    for (Index j = 1; j < g.rows; ++j) diagonal.line(side, j);
    diagonal.end_family();
  }
  straight(SpringKind::structural, 1);
}

// --- meshes ---------------------------------------------------------------------------------------------------------

struct MaterialPoint {
  Real u, v;
};
Real distance(const MaterialPoint& a, const MaterialPoint& b) { return portable::hypot(b.u - a.u, b.v - a.v); }
// Twice the signed area of a, b, c.
Real doubled_area(const MaterialPoint& a, const MaterialPoint& b, const MaterialPoint& c) {
  return (b.u - a.u) * (c.v - a.v) - (c.u - a.u) * (b.v - a.v);
}
// Cotangent of the angle at a in the triangle a, b, c.
Real cotangent(const MaterialPoint& a, const MaterialPoint& b, const MaterialPoint& c) {
  const Real along = (b.u - a.u) * (c.u - a.u) + (b.v - a.v) * (c.v - a.v);
  return along / std::abs(doubled_area(a, b, c));
}

struct MaterialMap {
  const Sheet& sheet;
  MaterialPoint operator()(Index i) const { return {sheet.u[i], sheet.v[i]}; }
};

// dx/du = sum over corners of x (dN/du), N linear.
void add_triangles(const Sheet& sheet, SheetTopology& t) {
  const MaterialMap at{sheet};
  for (const auto& n : sheet.triangles) {
    const MaterialPoint p[3]{at(n[0]), at(n[1]), at(n[2])};
    const Real doubled = doubled_area(p[0], p[1], p[2]);
    std::array<Real, 3> weft{}, warp{};
    for (std::size_t k = 0; k < 3; ++k) {
      const MaterialPoint &b = p[(k + 1) % 3], &c = p[(k + 2) % 3];
      weft[k] = (b.v - c.v) / doubled;
      warp[k] = (c.u - b.u) / doubled;
    }
    t.triangle_stretch.pieces.push_back({n, weft, 0.5 * doubled, false});
    t.triangle_stretch.pieces.push_back({n, warp, 0.5 * doubled, true});
    t.triangle_shear.pieces.push_back({n, weft, warp, 0.5 * doubled});
  }
}

// The corners opposite to every edge; an outer edge has one.
struct EdgeSides {
  std::array<Index, 2> opposite{no_index, no_index};
};
std::map<std::array<Index, 2>, EdgeSides> edges_of(const Sheet& sheet) {
  std::map<std::array<Index, 2>, EdgeSides> edges;
  for (const auto& n : sheet.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = n[k], b = n[(k + 1) % 3], c = n[(k + 2) % 3];
      EdgeSides& sides = edges[{std::min(a, b), std::max(a, b)}];
      sides.opposite[sides.opposite[0] == no_index ? 0 : 1] = c;
    }
  }
  return edges;
}

// s = sum over neighbours of (cot + cot)/2 (x_j - x_i); Laplacian = s/A, A a third of the triangles around; energy =
// B A |s/A|^2/2.
void add_rings(const Sheet& sheet, SheetTopology& t) {
  const MaterialMap at{sheet};
  std::vector<std::map<Index, Real>> weights(sheet.size());
  std::vector<Real> area(sheet.size());
  std::vector<bool> hem(sheet.size());
  for (const auto& n : sheet.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = n[k], b = n[(k + 1) % 3], c = n[(k + 2) % 3];
      const Real half = 0.5 * cotangent(at(c), at(a), at(b));
      weights[a][b] += half, weights[b][a] += half;
      area[a] += std::abs(doubled_area(at(a), at(b), at(c))) / 6;
    }
  }
  for (const auto& [edge, sides] : edges_of(sheet)) {
    if (sides.opposite[1] == no_index) hem[edge[0]] = hem[edge[1]] = true;
  }
  for (Index i = 0; i < sheet.size(); ++i) {
    if (hem[i] || weights[i].size() >= ring_nodes) continue;
    BendPiece<ring_nodes> piece{.weft = 0.5 / area[i], .warp = 0.5 / area[i]};
    piece.node.fill(i);
    std::size_t k = 0;
    for (const auto& [j, weight] : weights[i]) {
      piece.node[++k] = j;
      piece.weight[k] = weight;
      piece.weight[0] -= weight;
    }
    t.ring_bend.pieces.push_back(piece);
  }
}

void add_mesh_springs(const Sheet& sheet, SheetTopology& t) {
  const MaterialMap at{sheet};
  for (const auto& [edge, sides] : edges_of(sheet)) {
    t.springs.pieces.push_back(make_spring(edge[0], edge[1], distance(at(edge[0]), at(edge[1])), SpringKind::structural));
    const auto [c, d] = sides.opposite;
    if (d != no_index) t.springs.pieces.push_back(make_spring(c, d, distance(at(c), at(d)), SpringKind::flexion));
  }
}

Real shortest_edge(const Sheet& sheet) {
  const MaterialMap at{sheet};
  Real shortest = std::numeric_limits<Real>::infinity();
  for (const auto& n : sheet.triangles) {
    for (std::size_t k = 0; k < 3; ++k) shortest = std::min(shortest, distance(at(n[k]), at(n[(k + 1) % 3])));
  }
  return shortest;
}

}  // namespace

SpringPiece make_spring(Index a, Index b, Real rest, SpringKind kind) {
  return {{a, b}, {-1 / rest, 1 / rest}, rest, kind};
}

SheetTopology make_topology(const Sheet& sheet) {
  SheetTopology t;
  if (sheet.is_grid()) {
    IMBIBE_ASSERT(sheet.size() == std::size_t{sheet.columns} * sheet.rows);
    const Grid grid{sheet.columns, sheet.rows, sheet.u[1] - sheet.u[0], sheet.v[sheet.columns] - sheet.v[0]};
    add_threads(grid, t);
    add_cells(grid, t);
    add_grid_springs(grid, t);
  } else {
    add_triangles(sheet, t);
    add_rings(sheet, t);
    add_mesh_springs(sheet, t);
  }
  t.shortest_edge = shortest_edge(sheet);
  const std::size_t n = sheet.size();
  colour(t.triangle_stretch, n);
  colour(t.cell_shear, n), colour(t.triangle_shear, n);
  colour(t.cell_bend, n), colour(t.ring_bend, n);
  colour(t.springs, n);
  return t;
}

}  // namespace imbibe
