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

// One pass over the edges [first, end) of one thread: the changes of their impulses.
template <class Piece>
PassOutcome solve_stretch(const ThreadList<Piece>& threads, std::size_t first, std::size_t end,
                          const std::vector<PieceMaterial>& materials, const NodeMotion& nodes, Real dt, ThreadSolve& work) {
  // Down: directions, and elimination of the lower diagonal.
  Real upper_before = 0, change_before = 0;  // of the edge before
  Real b_before = 0;
  Vec3 direction_before;
  for (std::size_t e = first; e < end; ++e) {
    const auto [b, wi, wj, rate, ahead, length] = edge_ahead(threads.pieces[e], nodes, dt);
    const Vec3 direction = length > 0 ? ahead / length : direction_before;
    const PieceMaterial& m = materials[e];
    const Real reach = dt + m.damping;
    const Real lower = -reach * b * b_before * wi * dot(direction, direction_before);
    const Real diagonal = 1 / (dt * m.stiffness) + reach * b * b * (wi + wj) - lower * upper_before;
    const Real strain = length - 1 + m.damping * dot(direction, rate) + work.impulse[e] / (dt * m.stiffness);
    const Real side = -strain - lower * change_before;
    work.strain[e] = strain;
    const Real inverse = 1 / diagonal;
    work.direction[e] = direction;
    change_before = work.change[e] = side * inverse;
    if (e + 1 < end) {
      const Piece& next = threads.pieces[e + 1];
      const Real b_next = next.weight[1];
      const Vec3 next_ahead = b_next * (nodes.position[next.node[1]] - nodes.position[next.node[0]]) +
                              (dt * b_next) * (nodes.velocity[next.node[1]] - nodes.velocity[next.node[0]]);
      const Real next_length = norm(next_ahead);
      const Real aligned = next_length > 0 ? dot(direction, next_ahead) / next_length : squared_norm(direction);
      upper_before = work.upper[e] = -reach * b * b_next * wj * aligned * inverse;
    }
    b_before = b;
    direction_before = direction;
  }
  // Up: the impulses, given to the nodes.
  PassOutcome outcome;
  Real after = 0;
  for (std::size_t e = end; e-- > first;) {
    const Piece& piece = threads.pieces[e];
    const Real change = after = work.change[e] - (e + 1 < end ? work.upper[e] * after : 0);
    const Real b = piece.weight[1];
    const Vec3 given = (b * change) * work.direction[e];
    nodes.give(piece.node[0], -given);
    nodes.give(piece.node[1], given);
    const Real all = work.impulse[e] += change;
    const Real reach = dt * b * b * (nodes.inverse_mass[piece.node[0]] + nodes.inverse_mass[piece.node[1]]);
    outcome.turn = std::max(outcome.turn, std::abs(all) * reach);
    // Lines of springs cross each other far more closely than threads: what they change counts, as in relaxation.
    outcome.add(std::is_same_v<Piece, SpringPiece> ? std::abs(change) * reach : moved_strain(work.strain[e], change, materials[e], dt),
                area_of(piece));
  }
  outcome.solved = end - first;
  return outcome;
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

// From numbers to vectors, after the first pass.
void tighten(std::size_t first, std::size_t end, ThreadSolve& work) {
  for (std::size_t e = first; e < end; ++e) work.given[e] = work.impulse[e] * work.direction[e];
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

// Calls solve(thread) for all threads, family by family.
template <class Piece, class Solve>
void for_threads(const ThreadList<Piece>& threads, Solve&& solve) {
  const auto family = [&](std::size_t begin, std::size_t end) {
    if (begin == end) return;
    const std::size_t length = std::max<std::size_t>(1, threads.first[begin + 1] - threads.first[begin]);
    parallel_for(end - begin, [&](std::size_t k) { solve(begin + k); }, std::max<std::size_t>(1, 1024 / length));
  };
  for (std::size_t f = 0; f + 1 < threads.families.size(); ++f) family(threads.families[f], threads.families[f + 1]);
}

}  // namespace

template <class Piece>
void begin_thread_stretch(const ThreadList<Piece>& threads, ThreadSolve& work) {
  const std::size_t n = threads.pieces.size();
  work.direction.resize(n), work.upper.resize(n), work.change.resize(n);
  work.strain.resize(n), work.given.resize(n), work.block.resize(n);
  work.impulse.assign(n, 0);
  work.outcome.resize(threads.size());
  work.tense.assign(threads.size(), 0);
}

template <class Piece>
PassOutcome solve_thread_stretch(const ThreadList<Piece>& threads, const std::vector<PieceMaterial>& materials,
                                 const NodeMotion& nodes, Real dt, ThreadSolve& work, const PassScope& scope) {
  for_threads(threads, [&](std::size_t t) {
    PassOutcome& outcome = work.outcome[t];
    const std::size_t first = threads.first[t], end = threads.first[t + 1];
    if (scope.skips(outcome)) {
      outcome.solved = 0;
      return;
    }
    if (work.tense[t]) {
      outcome = solve_tense_stretch(threads, first, end, materials, nodes, dt, work);
      return;
    }
    outcome = solve_stretch(threads, first, end, materials, nodes, dt, work);
    if (std::is_same_v<Piece, SpringPiece>) return;
    if (outcome.turn > tense_turn) {
      tighten(first, end, work);
      work.tense[t] = 1, outcome.tightened = true;
    }
    outcome.turn = 0;
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

void correct_threads(const ThreadList<SpringPiece>& threads, const NodeMotion& nodes, Real limit, Real dt) {
  for_threads(threads, [&](std::size_t t) {
    for (std::size_t k = threads.first[t]; k < threads.first[t + 1]; ++k)
      if (threads.pieces[k].kind != SpringKind::flexion) correct_stretch(threads.pieces[k], nodes, limit, dt);
  });
}

void solve_thread_bend(const ThreadList<BendPiece<3>>& threads, const std::vector<PieceMaterial>& materials,
                       const NodeMotion& nodes, Real dt, ThreadSolve& work) {
  work.bend.resize(threads.pieces.size());
  for_threads(threads, [&](std::size_t t) {
    solve_bend(threads, threads.first[t], threads.first[t + 1], materials, nodes, dt, work.bend);
  });
}

}  // namespace imbibe
