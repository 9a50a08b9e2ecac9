// The impulse of one elastic piece over a substep, backward in time.
//
//   energy k C(x)^2 / 2,  force -k (C + beta dC/dt) grad C
//   J = -[dt k (C~ + beta C') + J_0] / (1 + dt k (dt + beta) S),   S = sum over nodes of |grad C|^2 / m
//
// J: what the piece gives to its nodes along grad C, J_0 what it gave in passes before this one; C~: C where the velocities would carry the nodes in dt; C' = grad C .
// v; beta damping time s; m nodal mass (infinite when pinned). With one piece this is the backward Euler step of a damped
// oscillator: bounded for every k and dt, energy falls. Pieces are solved one after the other, once per substep: extended
// position-based dynamics (Macklin, Mueller & Chentanez, MIG 2016, eq. 18) with small steps (Macklin et al., SCA 2019),
// written for velocities so that momentum is kept to rounding.
// Pieces that are solved later undo a part of what an earlier one did. Passes with J_0 close that gap; what a pass still
// changes says how far the substep is from backward Euler (cloth_step.cpp).
// Carrying J over from substep to substep instead was looked at: with more than half of J carried, long waves gain energy.
// Tested in tests/cloth/threads_test.cpp against the closed form of the oscillator.
#pragma once

#include <algorithm>

#include "imbibe/cloth/topology.h"

namespace imbibe {

// The pure equation; `value` = C~, `rate` = C', `mobility` = S, `given` = J_0. Any unit of C.
template <class T>
T elastic_impulse(const T& value, const T& rate, Real stiffness, Real damping, Real mobility, Real dt, const T& given = {}) {
  const Real soft = dt * stiffness;
  return ((value + rate * damping) * soft + given) * (-1 / (1 + soft * (dt + damping) * mobility));
}

// Nodes as the pieces see them. A pinned node has mobility 0; what is given to it is summed in `held`.
struct NodeMotion {
  const Vec3* position = nullptr;
  Vec3* velocity = nullptr;
  const Real* inverse_mass = nullptr;
  Vec3* held = nullptr;  // N s

  void give(Index node, const Vec3& impulse) const {
    const Real w = inverse_mass[node];
    if (w > 0) {
      velocity[node] += w * impulse;
    } else {
      held[node] += impulse;
    }
  }
};

// sum weight x; the weights add up to zero, so differences are taken and nothing cancels.
template <std::size_t N>
Vec3 linear_form(const Vec3* x, const std::array<Index, N>& node, const std::array<Real, N>& weight) {
  Vec3 sum;
  const Vec3 first = x[node[0]];
  for (std::size_t k = 1; k < N; ++k) sum += weight[k] * (x[node[k]] - first);
  return sum;
}
// Of the positions and of the velocities.
struct LinearForm {
  Vec3 value{}, rate{};
};
template <std::size_t N>
LinearForm linear_form(const NodeMotion& nodes, const std::array<Index, N>& node, const std::array<Real, N>& weight) {
  return {linear_form(nodes.position, node, weight), linear_form<N>(nodes.velocity, node, weight)};
}
template <std::size_t N>
Real mobility_of(const NodeMotion& nodes, const std::array<Index, N>& node, const std::array<Real, N>& weight) {
  Real sum = 0;
  for (std::size_t k = 0; k < N; ++k) sum += weight[k] * weight[k] * nodes.inverse_mass[node[k]];
  return sum;
}

// What a pass over pieces changed. Pieces solved one by one: the strains by which their impulses alone moved them, dt |J| S;
// whole threads: the strains that others had left in them.
struct PassOutcome {
  Real turn = 0;                      // threads.h
  Real greatest = 0;                  // change of strain
  Real squares = 0, area = 0;         // of the changes, over the cloth
  std::size_t solved = 0;             // pieces
  bool tightened = false;             // threads.h

  // Where a sheet hangs by a point the tension grows without bound as the mesh gets finer, and so does its error, over
  // an area that shrinks: one piece may be wrong by ten times what the sheet may be on average.
  Real change() const { return area > 0 ? std::max(std::sqrt(squares / area), 0.1 * greatest) : 0; }
  void add(Real changed, Real piece_area) {
    greatest = std::max(greatest, changed);
    squares += piece_area * changed * changed, area += piece_area;
  }
  PassOutcome& operator+=(const PassOutcome& o) {
    turn = std::max(turn, o.turn), greatest = std::max(greatest, o.greatest);
    squares += o.squares, area += o.area, solved += o.solved;
    tightened = tightened || o.tightened;
    return *this;
  }
};

// Which pieces a pass solves: all, or those that the pass before still changed by more than `settled` (in threads, or in
// groups of neighbours). Where cloth hangs by a point a few threads need many passes and the rest of the sheet one.
struct PassScope {
  bool everywhere = true;
  Real settled = 0;
  bool skips(const PassOutcome& before) const { return !everywhere && before.change() < settled; }
};

// Solves one piece of stretch (or a spring), adds to `given` what it gave, and returns the change of strain.
template <class Piece>
Real solve_stretch(const Piece& piece, const NodeMotion& nodes, Real stiffness, Real damping, Real dt, Real& given) {
  const LinearForm form = linear_form(nodes, piece.node, piece.weight);
  const Real mobility = mobility_of(nodes, piece.node, piece.weight);
  const Vec3 ahead = form.value + dt * form.rate;
  const Real length = norm(ahead);
  if (!(length > 0)) return 0;  // no direction: the piece is folded to a point
  const Vec3 along = ahead / length;
  const Real impulse = elastic_impulse(length - 1, dot(along, form.rate), stiffness, damping, mobility, dt, given);
  for (std::size_t k = 0; k < piece.node.size(); ++k) nodes.give(piece.node[k], (piece.weight[k] * impulse) * along);
  given += impulse;
  return std::abs(impulse) * mobility * dt;
}

// Provot's correction: a piece longer than (1 + limit) of its rest length is brought back to it, by an impulse shared by
// mass, so that momentum is kept and the nodes lose the speed at which they parted.
template <class Piece>
void correct_stretch(const Piece& piece, const NodeMotion& nodes, Real limit, Real dt) {
  const LinearForm form = linear_form(nodes, piece.node, piece.weight);
  const Vec3 ahead = form.value + dt * form.rate;
  const Real squared = squared_norm(ahead);
  if (squared <= (1 + limit) * (1 + limit)) return;
  const Real mobility = mobility_of(nodes, piece.node, piece.weight);
  if (!(mobility > 0)) return;
  const Real length = std::sqrt(squared);
  const Vec3 impulse = ((1 + limit - length) / (dt * mobility * length)) * ahead;
  for (std::size_t k = 0; k < piece.node.size(); ++k) nodes.give(piece.node[k], piece.weight[k] * impulse);
}

template <std::size_t N>
void solve_bend(const BendPiece<N>& piece, const NodeMotion& nodes, Real stiffness, Real damping, Real dt) {
  const LinearForm form = linear_form(nodes, piece.node, piece.weight);
  const Vec3 impulse = elastic_impulse(form.value + dt * form.rate, form.rate, stiffness, damping,
                                       mobility_of(nodes, piece.node, piece.weight), dt);
  for (std::size_t k = 0; k < N; ++k) nodes.give(piece.node[k], piece.weight[k] * impulse);
}

}  // namespace imbibe
