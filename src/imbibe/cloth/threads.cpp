#include "imbibe/cloth/threads.h"

#include <algorithm>
#include <type_traits>

#include "imbibe/cloth/elastic.h"
#include "imbibe/core/parallel.h"

namespace imbibe {
namespace {

// A fifth of the turn at which directions of the pass before are no longer stable.
constexpr Real tense_turn = 0.2;

// By how much a pass changed the strain of an edge, all impulses of it together, from the equation that it solved.
Real moved_strain(Real found, Real change, const PieceMaterial& m, Real dt) {
  return dt / (dt + m.damping) * std::abs(found + change / (dt * m.stiffness));
}

// An edge as it will be at the end of the step if nothing acts on it.
struct EdgeAhead {
  Real b, wi, wj;  // 1/m, its weight at the second node; inverse masses of its nodes, 1/kg
  Vec3 rate, ahead;
  Real length;     // of ahead, 1 at rest
};

template <class Piece>
EdgeAhead edge_ahead(const Piece& piece, const NodeMotion& nodes, Real dt) {
  const auto [i, j] = piece.node;
  const Real b = piece.weight[1];
  const Vec3 rate = b * (nodes.velocity[j] - nodes.velocity[i]);
  const Vec3 ahead = b * (nodes.position[j] - nodes.position[i]) + dt * rate;
  return {b, nodes.inverse_mass[i], nodes.inverse_mass[j], rate, ahead, norm(ahead)};
}

// Up to four threads of one family. Lanes without a thread, and those whose thread has ended, compute what nobody reads.
template <class Piece>
struct ThreadGroup {
  std::array<std::size_t, lanes> thread{}, first{}, length{};
  std::size_t count = 0, longest = 0;  // lane
  void add(const ThreadList<Piece>& threads, std::size_t t) {
    thread[count] = t, first[count] = threads.first[t], length[count] = threads.first[t + 1] - threads.first[t];
    if (length[count] > length[longest]) longest = count;
    ++count;
  }
  bool has(std::size_t l, std::size_t k) const { return k < length[l]; }
  // The piece of lane l; the last one of a thread that has ended, the first lane's where there is none.
  std::size_t edge(std::size_t l, std::size_t k) const {
    return l < count ? first[l] + std::min(k, length[l] - 1) : first[0] + std::min(k, length[0] - 1);
  }
};

Reals gather(auto&& value) { return Reals{value(0), value(1), value(2), value(3)}; }
Reals3 gather3(auto&& value) {
  const Vec3 a = value(0), b = value(1), c = value(2), d = value(3);
  return {Reals{a.x, b.x, c.x, d.x}, Reals{a.y, b.y, c.y, d.y}, Reals{a.z, b.z, c.z, d.z}};
}

// The same, of four.
Reals moved_strain(const EdgeLanes& edge, auto&& material, Real dt) {
  const Reals damping = gather([&](std::size_t l) { return material(l).damping; });
  const Reals soft = gather([&](std::size_t l) { return material(l).stiffness; }) * dt;
  return dt / (dt + damping) * size_of(edge.strain + edge.change / soft);
}

// Down: directions, and elimination of the lower diagonal.
template <class Piece>
void eliminate(const ThreadList<Piece>& threads, const ThreadGroup<Piece>& group, const std::vector<PieceMaterial>& materials,
               const NodeMotion& nodes, Real dt, const std::vector<Real>& impulse, EdgeLanes* edges) {
  const auto pieces = [&](std::size_t k) {
    return [&, k](std::size_t l) -> const Piece& { return threads.pieces[group.edge(l, k)]; };
  };
  const auto start = pieces(0);
  Reals3 xi = gather3([&](std::size_t l) { return nodes.position[start(l).node[0]]; });
  Reals3 vi = gather3([&](std::size_t l) { return nodes.velocity[start(l).node[0]]; });
  Reals wi = gather([&](std::size_t l) { return nodes.inverse_mass[start(l).node[0]]; });
  const Reals none{};
  Reals b_before{}, change_before{}, reach_before{};  // of the edge before; reach_before over its diagonal
  Reals3 direction_before{none, none, none};
  for (std::size_t k = 0; k < group.length[group.longest]; ++k) {
    const auto piece = pieces(k);
    const auto material = [&](std::size_t l) -> const PieceMaterial& { return materials[group.edge(l, k)]; };
    const Reals3 xj = gather3([&](std::size_t l) { return nodes.position[piece(l).node[1]]; });
    const Reals3 vj = gather3([&](std::size_t l) { return nodes.velocity[piece(l).node[1]]; });
    const Reals wj = gather([&](std::size_t l) { return nodes.inverse_mass[piece(l).node[1]]; });
    const Reals b = gather([&](std::size_t l) { return piece(l).weight[1]; });
    const Reals damping = gather([&](std::size_t l) { return material(l).damping; });
    const Reals soft = gather([&](std::size_t l) { return material(l).stiffness; }) * dt;
    const Reals before = gather([&](std::size_t l) { return impulse[group.edge(l, k)]; });
    const Reals3 rate = b * (vj - vi), ahead = b * (xj - xi) + (none + dt) * rate;
    const Reals length = root(squared_norm(ahead));
    const auto has_direction = length > 0;  // else it is folded to a point
    const Reals inverse_length = has_direction ? 1 / length : none;
    EdgeLanes& edge = edges[k];
    Reals3& d = edge.direction;
    d.x = has_direction ? ahead.x * inverse_length : direction_before.x;
    d.y = has_direction ? ahead.y * inverse_length : direction_before.y;
    d.z = has_direction ? ahead.z * inverse_length : direction_before.z;
    const Reals reach = damping + dt, softness = 1 / soft;
    const Reals beside = -b * b_before * wi * dot(d, direction_before);
    const Reals lower = reach * beside, upper_before = reach_before * beside;
    if (k > 0) edges[k - 1].upper = upper_before;
    const Reals inverse = 1 / (softness + reach * b * b * (wi + wj) - lower * upper_before);
    edge.strain = length - 1 + damping * dot(d, rate) + before * softness;
    edge.change = change_before = (-edge.strain - lower * change_before) * inverse;
    reach_before = reach * inverse;
    b_before = b, direction_before = d;
    xi = xj, vi = vj, wi = wj;
  }
}

// One pass over the edges of up to four threads: the changes of their impulses, given to the nodes.
template <class Piece>
void solve_stretch(const ThreadList<Piece>& threads, const ThreadGroup<Piece>& group, const std::vector<PieceMaterial>& materials,
                   const NodeMotion& nodes, Real dt, ThreadSolve& work) {
  EdgeLanes* const edges = work.edges.data() + group.first[group.longest];
  eliminate(threads, group, materials, nodes, dt, work.impulse, edges);
  constexpr bool is_spring = std::is_same_v<Piece, SpringPiece>;
  const auto material_of = [&](std::size_t k) {
    return [&, k](std::size_t l) -> const PieceMaterial& { return materials[group.edge(l, k)]; };
  };
  struct {
    Reals turn{}, greatest{}, squares{}, area{};
  } outcome;
  const Reals none{};
  Reals after{};                    // change of the edge after
  Reals3 v{none, none, none};       // of the second node of the edge, with what the edge after gave
  Reals wj{};
  for (std::size_t k = group.length[group.longest]; k-- > 0;) {
    EdgeLanes& edge = edges[k];
    for (std::size_t l = 0; l < group.count; ++l) {
      if (k + 1 == group.length[l]) {
        const Index last = threads.pieces[group.edge(l, k)].node[1];
        set_lane(v, l, nodes.velocity[last]);
        wj[l] = nodes.inverse_mass[last], edge.upper[l] = 0;
      } else if (!group.has(l, k)) {
        edge.change[l] = edge.upper[l] = edge.strain[l] = 0;
      }
    }
    const auto piece = [&](std::size_t l) -> const Piece& { return threads.pieces[group.edge(l, k)]; };
    const Reals b = gather([&](std::size_t l) { return piece(l).weight[1]; });
    const Reals wi = gather([&](std::size_t l) { return nodes.inverse_mass[piece(l).node[0]]; });
    const Reals3 vi = gather3([&](std::size_t l) { return nodes.velocity[piece(l).node[0]]; });
    const Reals change = edge.change - edge.upper * after;
    after = edge.change = change;
    const Reals3 given = (b * change) * edge.direction;
    v += wj * given;
    const Reals turn = dt * b * b * (wi + wj);
    Reals all{};
    for (std::size_t l = 0; l < group.count; ++l) {
      if (!group.has(l, k)) continue;
      const auto [i, j] = piece(l).node;
      if (wj[l] > 0) nodes.velocity[j] = lane_of(v, l);
      else nodes.held[j] += lane_of(given, l);
      if (!(wi[l] > 0)) nodes.held[i] -= lane_of(given, l);
      all[l] = work.impulse[group.first[l] + k] += change[l];
    }
    outcome.turn = greater(outcome.turn, size_of(all) * turn);
    // Lines of springs cross each other far more closely than threads: what they change counts, as in relaxation.
    const Reals changed = is_spring ? size_of(change) * turn : moved_strain(edge, material_of(k), dt);
    const Reals area = gather([&](std::size_t l) { return group.has(l, k) ? area_of(piece(l)) : 0; });
    outcome.greatest = greater(outcome.greatest, changed);
    outcome.squares += area * changed * changed, outcome.area += area;
    v = vi - wi * given;
    wj = wi;
  }
  for (std::size_t l = 0; l < group.count; ++l) {
    if (wj[l] > 0) nodes.velocity[threads.pieces[group.first[l]].node[0]] = lane_of(v, l);
    work.outcome[group.thread[l]] = {.turn = outcome.turn[l], .greatest = outcome.greatest[l], .squares = outcome.squares[l],
                                     .area = outcome.area[l], .solved = group.length[l]};
  }
}

Vec3 product(const Vec3 (&row)[3], const Vec3& v) { return {dot(row[0], v), dot(row[1], v), dot(row[2], v)}; }

// N = (1/E + S)^-1 with S = s - part * before and E = across + along d d^T, and side = N / E right. With K = 1 + across S,
// which is never near singular, and p = d / K:  N = across / K + along p p / (1 + along d.S p): exact for threads of any stiffness.
void eliminate(const Vec3& d, Real along, Real across, Real s, Real part, const Vec3& right, const Vec3 (&before)[3],
               ThreadSolve::Block& block) {
  const Vec3 left[3]{Vec3{s, 0, 0} - part * before[0], Vec3{0, s, 0} - part * before[1], Vec3{0, 0, s} - part * before[2]};
  const Vec3 k0 = Vec3{1, 0, 0} + across * left[0], k1 = Vec3{0, 1, 0} + across * left[1],
             k2 = Vec3{0, 0, 1} + across * left[2];
  Vec3 inverse[3]{cross(k1, k2), cross(k2, k0), cross(k0, k1)};  // of a symmetric matrix
  const Real determinant = dot(k0, inverse[0]);
  for (Vec3& row : inverse) row = row / determinant;
  const Vec3 p = product(inverse, d), seen = product(left, p);
  const Real stiff = 1 + along * dot(d, seen), share = along / stiff;
  block.row[0] = across * inverse[0] + (share * p.x) * p;
  block.row[1] = across * inverse[1] + (share * p.y) * p;
  block.row[2] = across * inverse[2] + (share * p.z) * p;
  const Real right_along = dot(right, d);
  const Vec3 right_across = right - right_along * d;
  block.side = product(inverse, right_across) + (right_along / stiff - share * dot(seen, right_across)) * p;
}

// The same for a tense thread, with vectors.
template <class Piece>
PassOutcome solve_tense_stretch(const ThreadList<Piece>& threads, std::size_t first, std::size_t end,
                                const std::vector<PieceMaterial>& materials, const NodeMotion& nodes, Real dt,
                                ThreadSolve& work) {
  static constexpr ThreadSolve::Block none{};
  const ThreadSolve::Block* before = &none;
  Real b_before = 0;
  for (std::size_t e = first; e < end; ++e) {
    const auto [b, wi, wj, rate, ahead, length] = edge_ahead(threads.pieces[e], nodes, dt);
    const Vec3 direction = length > 0 ? ahead / length : work.direction[e];
    const PieceMaterial& m = materials[e];
    const Real soft = dt * m.stiffness, strain = length - 1 + m.damping * dot(direction, rate);
    const Real tension = std::max(Real{0}, -dot(direction, work.given[e]));
    const Real across = length > 0 ? dt * tension / length : 0;
    const Real beside = wi * b * b_before;
    const Vec3 right = -(soft * strain) * direction - work.given[e];
    eliminate(direction, soft * (dt + m.damping) - across, across, b * b * (wi + wj), beside * beside, right, before->row,
              work.block[e]);
    work.block[e].side += beside * product(work.block[e].row, before->side);
    work.direction[e] = direction;
    work.strain[e] = strain + dot(direction, work.given[e]) / soft;
    before = &work.block[e], b_before = b;
  }
  PassOutcome outcome;
  Vec3 after;
  Real b_after = 0;
  for (std::size_t e = end; e-- > first;) {
    const Piece& piece = threads.pieces[e];
    const Real b = piece.weight[1];
    after = work.block[e].side + (nodes.inverse_mass[piece.node[1]] * b * b_after) * product(work.block[e].row, after);
    b_after = b;
    nodes.give(piece.node[0], -b * after);
    nodes.give(piece.node[1], b * after);
    work.given[e] += after;
    work.impulse[e] = dot(work.given[e], work.direction[e]);
    outcome.add(moved_strain(work.strain[e], dot(after, work.direction[e]), materials[e], dt), area_of(piece));
  }
  outcome.solved = end - first;
  return outcome;
}

// From numbers to vectors, after the first pass; the threads of a group that turn too much.
template <class Piece>
void tighten(const ThreadGroup<Piece>& group, ThreadSolve& work) {
  const EdgeLanes* const edges = work.edges.data() + group.first[group.longest];
  for (std::size_t l = 0; l < group.count; ++l) {
    PassOutcome& outcome = work.outcome[group.thread[l]];
    if (outcome.turn > tense_turn) {
      for (std::size_t k = 0; k < group.length[l]; ++k) {
        const std::size_t e = group.first[l] + k;
        work.direction[e] = lane_of(edges[k].direction, l);
        work.given[e] = work.impulse[e] * work.direction[e];
      }
      work.tense[group.thread[l]] = 1, outcome.tightened = true;
    }
    outcome.turn = 0;
  }
}

// The nodes [first, end) of one thread, without its ends. Rows are divided by dt + beta, which makes the matrix symmetric.
void solve_bend(const ThreadList<BendPiece<3>>& threads, std::size_t first, std::size_t end,
                const std::vector<PieceMaterial>& materials, const NodeMotion& nodes, Real dt,
                std::vector<ThreadSolve::BendRow>& rows) {
  using Row = ThreadSolve::BendRow;
  Row one, two;  // the rows one and two before
  one.diagonal = two.diagonal = 1;
  Real beside = 0, beyond = 0, beyond_next = 0;  // (c, c-1), (c, c-2), and (c+1, c-1)
  for (std::size_t c = first; c < end; ++c) {
    const auto& node = threads.pieces[c].node;
    const Real w0 = nodes.inverse_mass[node[0]], w1 = nodes.inverse_mass[node[1]], w2 = nodes.inverse_mass[node[2]];
    const PieceMaterial& m = materials[c];
    const Real reach = dt + m.damping;
    const Vec3 value = (nodes.position[node[0]] - nodes.position[node[1]]) + (nodes.position[node[2]] - nodes.position[node[1]]);
    const Vec3 rate = (nodes.velocity[node[0]] - nodes.velocity[node[1]]) + (nodes.velocity[node[2]] - nodes.velocity[node[1]]);
    Row row;
    row.lower2 = beyond / two.diagonal;
    row.lower1 = (beside - row.lower2 * two.diagonal * one.lower1) / one.diagonal;
    row.diagonal = 1 / (dt * m.stiffness * reach) + w0 + 4 * w1 + w2 - row.lower1 * row.lower1 * one.diagonal -
                   row.lower2 * row.lower2 * two.diagonal;
    row.side = (-1 / reach) * value - rate - row.lower1 * one.side - row.lower2 * two.side;
    rows[c] = row;
    two = one, one = row;
    beside = -2 * (w1 + w2), beyond = beyond_next, beyond_next = w2;
  }
  one = two = {};
  for (std::size_t c = end; c-- > first;) {
    Row& row = rows[c];
    row.side = row.side / row.diagonal - one.lower1 * one.side - two.lower2 * two.side;
    two = one, one = row;
    const auto& node = threads.pieces[c].node;
    nodes.give(node[0], row.side);
    nodes.give(node[1], -2.0 * row.side);
    nodes.give(node[2], row.side);
  }
}

// Calls solve(first thread, end) for tiles of all threads, family by family.
template <class Piece, class Solve>
void for_tiles(const ThreadList<Piece>& threads, Solve&& solve) {
  for (std::size_t f = 0; f + 1 < threads.families.size(); ++f) {
    const std::size_t begin = threads.families[f], end = threads.families[f + 1];
    if (begin == end) continue;
    const std::size_t length = std::max<std::size_t>(1, threads.first[begin + 1] - threads.first[begin]);
    const std::size_t tile = std::max<std::size_t>(1, 1024 / length);
    parallel_tiles(end - begin, [&](std::size_t a, std::size_t b) { solve(begin + a, begin + b); },
                   (tile + lanes - 1) / lanes * lanes);
  }
}

}  // namespace

template <class Piece>
void begin_thread_stretch(const ThreadList<Piece>& threads, ThreadSolve& work) {
  const std::size_t n = threads.pieces.size();
  work.edges.resize(n);
  if (!std::is_same_v<Piece, SpringPiece>) work.direction.resize(n), work.strain.resize(n), work.given.resize(n), work.block.resize(n);
  work.impulse.assign(n, 0);
  work.outcome.resize(threads.size());
  work.tense.assign(threads.size(), 0);
}

template <class Piece>
PassOutcome solve_thread_stretch(const ThreadList<Piece>& threads, const std::vector<PieceMaterial>& materials,
                                 const NodeMotion& nodes, Real dt, ThreadSolve& work, const PassScope& scope) {
  for_tiles(threads, [&](std::size_t begin, std::size_t end) {
    ThreadGroup<Piece> group;
    const auto solve_group = [&] {
      if (group.count == 0) return;
      solve_stretch(threads, group, materials, nodes, dt, work);
      if (!std::is_same_v<Piece, SpringPiece>) tighten(group, work);
      group = {};
    };
    for (std::size_t t = begin; t < end; ++t) {
      PassOutcome& outcome = work.outcome[t];
      if (scope.skips(outcome)) {
        outcome.solved = 0;
      } else if (work.tense[t]) {
        outcome = solve_tense_stretch(threads, threads.first[t], threads.first[t + 1], materials, nodes, dt, work);
      } else {
        group.add(threads, t);
        if (group.count == lanes) solve_group();
      }
    }
    solve_group();
  });
  PassOutcome all;
  for (PassOutcome& outcome : work.outcome) all += outcome, outcome.tightened = false;
  return all;
}

template void begin_thread_stretch(const ThreadList<StretchPiece<2>>&, ThreadSolve&);
template void begin_thread_stretch(const ThreadList<SpringPiece>&, ThreadSolve&);
template PassOutcome solve_thread_stretch(const ThreadList<StretchPiece<2>>&, const std::vector<PieceMaterial>&,
                                          const NodeMotion&, Real, ThreadSolve&, const PassScope&);
template PassOutcome solve_thread_stretch(const ThreadList<SpringPiece>&, const std::vector<PieceMaterial>&,
                                          const NodeMotion&, Real, ThreadSolve&, const PassScope&);

void correct_threads(const ThreadList<SpringPiece>& threads, const NodeMotion& nodes, Real limit, Real dt,
                     const ThreadSolve& work) {
  for_tiles(threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const std::size_t first = threads.first[t];
      if (work.outcome[t].solved == 0 || threads.pieces[first].kind == SpringKind::flexion) continue;
      for (std::size_t k = first; k < threads.first[t + 1]; ++k) correct_stretch(threads.pieces[k], nodes, limit, dt);
    }
  });
}

void solve_thread_bend(const ThreadList<BendPiece<3>>& threads, const std::vector<PieceMaterial>& materials,
                       const NodeMotion& nodes, Real dt, ThreadSolve& work) {
  work.bend.resize(threads.pieces.size());
  for_tiles(threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t)
      solve_bend(threads, threads.first[t], threads.first[t + 1], materials, nodes, dt, work.bend);
  });
}

}  // namespace imbibe
