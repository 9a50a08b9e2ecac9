#include "imbibe/cloth/thread_answer.h"

#include <gtest/gtest.h>

#include <numeric>

#include "imbibe/core/random.h"
#include "imbibe/geometry/sampling.h"

namespace imbibe {
namespace {

// A crumpled grid, one corner held, with its stiffnesses as a step leaves them.
struct Crumpled {
  Sheet sheet;
  ClothParams params;
  ClothScratch scratch;
  std::vector<Real> inverse_mass;
  static constexpr Real dt = 1e-3;

  Crumpled() {
    sheet = make_sheet(GridSheet{.width = 0.05, .height = 0.04, .columns = 6, .rows = 5, .areal_mass = 0.15});
    params.air.density = 0;
    step_cloth(sheet, params, {}, dt, scratch);
    for (Index n = 0; n < sheet.size(); ++n)
      sheet.position[n] += 0.002 * random_direction({.seed = 7, .id = n}), inverse_mass.push_back(n == 0 ? 0 : 1 / sheet.mass(n));
  }
  // Velocities that impulses of all pushed nodes give, as the threads leave them.
  std::vector<Vec3> answer(ThreadAnswer& threads, const std::vector<Index>& pushed, const std::vector<Vec3>& impulse,
                           std::vector<Vec3>* held = nullptr) {
    threads.begin(sheet, params, inverse_mass, pushed, dt, scratch);
    std::vector<Vec3> velocity(sheet.size());
    for (const Index n : pushed) velocity[n] = inverse_mass[n] * impulse[n];
    if (held) held->assign(sheet.size(), {});
    threads.resist(velocity, held ? std::span<Vec3>(*held) : std::span<Vec3>());
    return velocity;
  }
};

std::vector<Vec3> some_impulses(const Crumpled& c, const std::vector<Index>& pushed, std::uint64_t seed) {
  std::vector<Vec3> impulse(c.sheet.size());
  for (const Index n : pushed) impulse[n] = 1e-5 * random_direction({.seed = seed, .id = n});
  return impulse;
}

Real product(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return std::transform_reduce(a.begin(), a.end(), b.begin(), Real{0}, std::plus<>(), [](const Vec3& x, const Vec3& y) { return dot(x, y); });
}

TEST(ThreadAnswer, is_symmetric_and_never_more_than_the_masses_alone_let_it_be) {
  Crumpled c;
  ThreadAnswer threads;
  const std::vector<Index> pushed{7, 8, 9, 14, 15, 21};
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    const std::vector<Vec3> a = some_impulses(c, pushed, seed), b = some_impulses(c, pushed, seed + 100);
    const std::vector<Vec3> sa = c.answer(threads, pushed, a), sb = c.answer(threads, pushed, b);
    EXPECT_NEAR(product(a, sb), product(b, sa), 1e-13 * std::sqrt(product(a, sa) * product(b, sb)));
    Real free = 0;
    for (const Index n : pushed) free += c.inverse_mass[n] * squared_norm(a[n]);
    EXPECT_GT(product(a, sa), 0);
    EXPECT_LT(product(a, sa), free);
  }
}

TEST(ThreadAnswer, keeps_momentum_of_nodes_and_supports_and_turns_nothing) {
  Crumpled c;
  ThreadAnswer threads;
  const std::vector<Index> pushed{1, 2, 7};  // the thread of 1 ends at the held corner
  const std::vector<Vec3> impulse = some_impulses(c, pushed, 3);
  std::vector<Vec3> held;
  const std::vector<Vec3> velocity = c.answer(threads, pushed, impulse, &held);
  Vec3 given{}, kept{}, moment_given{}, moment_kept{};
  for (Index n = 0; n < c.sheet.size(); ++n) {
    const Vec3 p = n == 0 ? held[n] : c.sheet.mass(n) * velocity[n];
    given += impulse[n], kept += p;
    moment_given += cross(c.sheet.position[n], impulse[n]), moment_kept += cross(c.sheet.position[n], p);
  }
  EXPECT_GT(norm(held[0]), 0.01 * norm(given));
  EXPECT_LT(norm(kept - given), 1e-14 * norm(given));
  EXPECT_LT(norm(moment_kept - moment_given), 1e-14 * norm(moment_given));
}

// One weft thread alone: the family by family solution is the exact one, (M + dt (dt + beta) K) w = J on it. With all nodes of one
// row pushed along it every warp thread is turned across, so that only the weft resists.
TEST(ThreadAnswer, of_threads_that_do_not_meet_across_is_backward_euler) {
  Crumpled c;
  for (Index n = 0; n < c.sheet.size(); ++n) c.sheet.position[n] = {0.01 * (n % 6), 0.01 * (n / 6), 0};
  ThreadAnswer threads;
  const std::vector<Index> pushed{12, 13, 14, 15, 16, 17};
  std::vector<Vec3> impulse(c.sheet.size());
  for (const Index n : pushed) impulse[n] = {1e-5 * (n == 14 ? 1 : 0.1 * n), 0, 0};
  const std::vector<Vec3> w = c.answer(threads, pushed, impulse);
  // The same stiffness as the piece has: K area/length^2 = K width/length.
  const Real stiffness = c.params.hand.stretch_weft * 0.01 / 0.01, beta = c.params.damping;
  for (std::size_t k = 0; k < pushed.size(); ++k) {
    const Index n = pushed[k];
    Real force = c.sheet.mass(n) * w[n].x - impulse[n].x;
    const auto pull = [&](Index other) { return Crumpled::dt * (Crumpled::dt + beta) * stiffness * (w[n].x - w[other].x); };
    if (k > 0) force += pull(n - 1);
    if (k + 1 < pushed.size()) force += pull(n + 1);
    EXPECT_NEAR(force, 0, 1e-12 * 1e-5) << n;
  }
}

TEST(ThreadAnswer, leaves_nodes_alone_that_no_pushed_thread_passes) {
  Crumpled c;
  ThreadAnswer threads;
  const std::vector<Index> pushed{14};
  const std::vector<Vec3> velocity = c.answer(threads, pushed, some_impulses(c, pushed, 5));
  EXPECT_EQ(threads.nodes().size(), 6u + 5u - 1u);
  for (Index n = 0; n < c.sheet.size(); ++n) EXPECT_EQ(velocity[n] == Vec3{}, n / 6 != 2 && n % 6 != 2) << n;
}

}  // namespace
}  // namespace imbibe
