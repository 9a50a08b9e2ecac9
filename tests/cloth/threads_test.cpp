#include "imbibe/cloth/threads.h"

#include <gtest/gtest.h>

#include "imbibe/cloth/elastic.h"
#include "imbibe/core/random.h"
#include "imbibe/geometry/sampling.h"

namespace imbibe {
namespace {

// One thread of a few nodes in a crooked line, and what is needed to solve it.
struct OneThread {
  std::vector<Vec3> position, velocity, held;
  std::vector<Real> inverse_mass;
  ThreadList<StretchPiece<2>> stretch;
  ThreadList<BendPiece<3>> bend;
  std::vector<PieceMaterial> stretch_material, bend_material;

  NodeMotion nodes() { return {position.data(), velocity.data(), inverse_mass.data(), held.data()}; }
};

OneThread crooked_thread(Index count) {
  OneThread t;
  for (Index i = 0; i < count; ++i) {
    const RandomCounter counter{.seed = 2, .id = i};
    t.position.push_back(Vec3{0.01 * i, 0, 0} + 0.003 * random_direction(counter));
    t.velocity.push_back(2.0 * random_direction(counter, 2));
    t.inverse_mass.push_back(i == 3 ? 0 : 1e4 * (0.5 + uniform(counter, 5)));
    if (i > 0) {
      t.stretch.pieces.push_back({{i - 1, i}, {-100, 100}, 1e-4, false});
      t.stretch_material.push_back({1e-4 * 5000 * (1 + uniform(counter, 6)), 1e-4});
    }
    if (i > 1) {
      t.bend.pieces.push_back({{i - 2, i - 1, i}, {1, -2, 1}, 1, 0, 0});
      t.bend_material.push_back({0.5 * (1 + uniform(counter, 7)), 3e-4 * uniform(counter, 8)});
    }
  }
  t.held.assign(count, {});
  t.stretch.first.push_back(t.stretch.pieces.size()), t.bend.first.push_back(t.bend.pieces.size());
  t.stretch.families = t.bend.families = {0, 1};
  return t;
}

// The solved impulses satisfy J = -dt k (C at the end + beta C' at the end), with the velocities after the step: the
// backward Euler equation itself, linear in the velocities for frozen directions.
TEST(Threads, stretch_satisfies_the_backward_euler_equation_of_every_edge) {
  const Real dt = 3e-4;
  OneThread t = crooked_thread(12);
  const std::vector<Vec3> before = t.velocity;
  ThreadSolve work;
  begin_thread_stretch(t.stretch, work);
  solve_thread_stretch(t.stretch, t.stretch_material, t.nodes(), dt, work);
  for (std::size_t e = 0; e < t.stretch.pieces.size(); ++e) {
    const auto& piece = t.stretch.pieces[e];
    const PieceMaterial& m = t.stretch_material[e];
    const Vec3 value = linear_form(t.position.data(), piece.node, piece.weight);
    const Vec3 old_rate = linear_form(before.data(), piece.node, piece.weight);
    const Vec3 new_rate = linear_form(t.velocity.data(), piece.node, piece.weight);
    const Vec3 ahead = value + dt * old_rate, along = ahead / norm(ahead);
    const Real strain = norm(ahead) - 1 + dt * dot(along, new_rate - old_rate);
    const Real expected = -dt * m.stiffness * (strain + m.damping * dot(along, new_rate));
    EXPECT_NEAR(work.impulse[e], expected, 1e-9 * std::abs(dt * m.stiffness)) << e;
  }
}

TEST(Threads, bending_satisfies_the_backward_euler_equation_of_every_node) {
  const Real dt = 3e-4;
  OneThread t = crooked_thread(12);
  ThreadSolve work;
  solve_thread_bend(t.bend, t.bend_material, t.nodes(), dt, work);
  for (std::size_t c = 0; c < t.bend.pieces.size(); ++c) {
    const auto& piece = t.bend.pieces[c];
    const PieceMaterial& m = t.bend_material[c];
    const Vec3 value = linear_form(t.position.data(), piece.node, piece.weight);
    const Vec3 rate = linear_form(t.velocity.data(), piece.node, piece.weight);
    const Vec3 expected = -dt * m.stiffness * (value + (dt + m.damping) * rate);
    EXPECT_LT(norm(work.bend[c].side - expected), 1e-9 * norm(expected) + 1e-15) << c;
  }
}

TEST(Threads, both_keep_momentum_with_what_the_pinned_node_was_given) {
  OneThread t = crooked_thread(12);
  const auto sum = [&] {
    Vec3 p;
    for (std::size_t i = 0; i < t.velocity.size(); ++i) {
      if (t.inverse_mass[i] > 0) p += t.velocity[i] / t.inverse_mass[i];
      p += t.held[i];
    }
    return p;
  };
  const Vec3 before = sum();
  ThreadSolve work;
  begin_thread_stretch(t.stretch, work);
  solve_thread_stretch(t.stretch, t.stretch_material, t.nodes(), 1e-3, work);
  solve_thread_bend(t.bend, t.bend_material, t.nodes(), 1e-3, work);
  EXPECT_LT(norm(sum() - before), 1e-13 * 12 * 2e-4);
  EXPECT_GT(norm(t.held[3]), 0);
}

// Threads of lengths that differ, one after the other in one list; each has a pinned node.
OneThread crooked_threads(const std::vector<Index>& counts) {
  OneThread all;
  for (const Index count : counts) {
    const OneThread t = crooked_thread(count);
    const auto offset = static_cast<Index>(all.position.size());
    all.position.insert(all.position.end(), t.position.begin(), t.position.end());
    all.velocity.insert(all.velocity.end(), t.velocity.begin(), t.velocity.end());
    all.inverse_mass.insert(all.inverse_mass.end(), t.inverse_mass.begin(), t.inverse_mass.end());
    all.held.resize(all.position.size());
    for (auto piece : t.stretch.pieces) {
      for (Index& node : piece.node) node += offset;
      all.stretch.pieces.push_back(piece);
    }
    all.stretch_material.insert(all.stretch_material.end(), t.stretch_material.begin(), t.stretch_material.end());
    all.stretch.first.push_back(all.stretch.pieces.size());
  }
  all.stretch.families = {0, counts.size()};
  return all;
}

TEST(Threads, solved_side_by_side_have_the_bits_of_threads_solved_alone) {
  const std::vector<Index> counts{12, 5, 30, 8, 6, 17, 9};
  const Real dt = 3e-4;
  OneThread all = crooked_threads(counts);
  ThreadSolve work;
  begin_thread_stretch(all.stretch, work);
  for (int pass = 0; pass < 3; ++pass) solve_thread_stretch(all.stretch, all.stretch_material, all.nodes(), dt, work);
  std::size_t node = 0;
  for (std::size_t k = 0; k < counts.size(); ++k) {
    OneThread one = crooked_thread(counts[k]);
    ThreadSolve alone;
    begin_thread_stretch(one.stretch, alone);
    for (int pass = 0; pass < 3; ++pass) solve_thread_stretch(one.stretch, one.stretch_material, one.nodes(), dt, alone);
    for (std::size_t e = 0; e < alone.impulse.size(); ++e) EXPECT_EQ(work.impulse[all.stretch.first[k] + e], alone.impulse[e]) << k;
    for (std::size_t i = 0; i < one.position.size(); ++i, ++node) {
      EXPECT_EQ(all.velocity[node], one.velocity[i]) << "thread " << k << " node " << i;
      EXPECT_EQ(all.held[node], one.held[i]) << "thread " << k << " node " << i;
    }
    EXPECT_EQ(work.outcome[k].greatest, alone.outcome[0].greatest);
    EXPECT_EQ(work.outcome[k].squares, alone.outcome[0].squares);
    EXPECT_EQ(work.outcome[k].solved, counts[k] - 1);
  }
}

// Passes converge to the equation with the directions at the end of the substep.
TEST(Threads, further_passes_satisfy_the_equation_with_the_new_directions) {
  const Real dt = 3e-4;
  OneThread t = crooked_thread(12);
  ThreadSolve work;
  begin_thread_stretch(t.stretch, work);
  PassOutcome outcome;
  for (int pass = 0; pass < 12; ++pass) {
    outcome = solve_thread_stretch(t.stretch, t.stretch_material, t.nodes(), dt, work);
  }
  EXPECT_LT(outcome.greatest, 1e-9);
  for (std::size_t e = 0; e < t.stretch.pieces.size(); ++e) {
    const auto& piece = t.stretch.pieces[e];
    const PieceMaterial& m = t.stretch_material[e];
    const Vec3 rate = linear_form(t.velocity.data(), piece.node, piece.weight);
    const Vec3 ahead = linear_form(t.position.data(), piece.node, piece.weight) + dt * rate;
    const Real expected = -dt * m.stiffness * (norm(ahead) - 1 + m.damping * dot(normalized(ahead), rate));
    EXPECT_NEAR(work.impulse[e], expected, 1e-7 * std::abs(dt * m.stiffness)) << e;
  }
}

// One piece between a fixed and a free node is the damped oscillator: x'' = -w^2 x - 2 z w x', backward Euler closed form
// v' = (v - dt w^2 x)/(1 + 2 z w dt + w^2 dt^2).
TEST(Threads, a_single_piece_is_the_backward_euler_oscillator) {
  const Real k = 50, beta = 2e-3, w = 400, dt = 1e-3, x = 0.02, v = 0.3, length = 0.1;
  const std::vector<Vec3> position{{0, 0, 0}, {length + x, 0, 0}};
  std::vector<Vec3> velocity{{}, {v, 0, 0}}, held(2);
  const std::vector<Real> inverse_mass{0, w};
  const StretchPiece<2> piece{{0, 1}, {-1 / length, 1 / length}, 1, false};
  Real given = 0;
  solve_stretch(piece, {position.data(), velocity.data(), inverse_mass.data(), held.data()}, k * length * length, beta, dt,
                given);
  EXPECT_NEAR(velocity[1].x, (v - dt * w * k * x) / (1 + w * k * dt * (dt + beta)), 1e-13);
  EXPECT_NEAR(held[0].x, -(velocity[1].x - v) / w, 1e-16);
}

}  // namespace
}  // namespace imbibe
