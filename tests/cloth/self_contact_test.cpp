#include "imbibe/cloth/self_contact.h"

#include <gtest/gtest.h>

#include <set>

#include "cloth/crossings.h"
#include "imbibe/cloth/cloth_step.h"
#include "imbibe/core/parallel.h"
#include "imbibe/core/random.h"

namespace imbibe {
namespace {

using testing::count_self_crossings;

ClothParams shirt() {
  ClothParams params;
  params.hand = fabric_hand("shirting");
  params.air.density = 0;
  return params;
}

Sheet square(Index nodes, Real side) {
  return make_sheet(GridSheet{.along_u = {1, 0, 0}, .along_v = {0, 1, 0}, .width = side, .height = side,
                              .columns = nodes, .rows = nodes, .areal_mass = 0.12});
}

// A sheet folded about its middle, the upper half thrown on the lower one at 20 m/s; a small turn and a ripple keep pieces
// from meeting face to face only.
Sheet thrown_fold(Real speed) {
  const Index n = 31;
  Sheet sheet = square(n, 0.3);
  const Real radius = 0.015;
  for (std::size_t i = 0; i < sheet.size(); ++i) {
    const Real u = sheet.u[i], v = sheet.v[i], bend = pi * radius, start = 0.15 - 0.5 * bend;
    Vec3& x = sheet.position[i];
    if (u < start) {
      x = {u, v, 0};
    } else if (u < start + bend) {
      const Real angle = (u - start) / radius;
      x = {start + radius * std::sin(angle), v, radius * (1 - std::cos(angle))};
    } else {
      x = {start - (u - start - bend), v + 0.1 * (u - start - bend), 2 * radius};
      sheet.velocity[i] = {0, 0, -speed};
    }
    x.z += 0.001 * std::sin(60 * u) * std::cos(47 * v);
  }
  return sheet;
}

TEST(SelfContact, a_fold_thrown_shut_at_20_metres_per_second_leaves_no_crossing) {
  Sheet sheet = thrown_fold(20);
  ASSERT_EQ(count_self_crossings(sheet), 0u);
  const ClothParams params = shirt();
  ClothScratch scratch;
  std::size_t hits = 0;
  for (int k = 0; k < 12; ++k) {
    const auto report = step_cloth(sheet, params, {.gravity = {}}, 1e-3, scratch);
    hits += report.swept_hits + report.self_contacts;
    EXPECT_EQ(report.unresolved_crossings, 0u);
    ASSERT_EQ(count_self_crossings(sheet), 0u) << "after " << k + 1 << " ms";
  }
  EXPECT_GT(hits, 100u);
}

TEST(SelfContact, the_same_fold_passes_through_itself_when_it_does_not_look) {
  Sheet sheet = thrown_fold(20);
  ClothParams params = shirt();
  params.contact.self = false;
  ClothScratch scratch;
  std::size_t most = 0;
  for (int k = 0; k < 12; ++k) {
    step_cloth(sheet, params, {.gravity = {}}, 1e-3, scratch);
    most = std::max(most, count_self_crossings(sheet));
  }
  EXPECT_GT(most, 0u);
}

TEST(SelfContact, a_crumpled_fall_keeps_momentum_and_leaves_no_crossing) {
  Sheet sheet = square(25, 0.3);
  for (std::size_t i = 0; i < sheet.size(); ++i) {
    const RandomCounter counter{.seed = 3, .id = i};
    sheet.velocity[i] = 8 * Vec3{uniform(counter, 0) - 0.5, uniform(counter, 1) - 0.5, uniform(counter, 2) - 0.5} +
                        Vec3{-20 * (sheet.u[i] - 0.15), -20 * (sheet.v[i] - 0.15), 20 * std::sin(40 * sheet.u[i])};
  }
  const ClothParams params = shirt();
  ClothScratch scratch;
  for (int k = 0; k < 30; ++k) {
    const Vec3 before = momentum(sheet);
    Real scale = 0;
    for (std::size_t i = 0; i < sheet.size(); ++i) scale += sheet.mass(i) * norm(sheet.velocity[i]);
    const auto report = step_cloth(sheet, params, {.gravity = {}}, 1e-3, scratch);
    // Rounding of a few hundred thousand impulses.
    EXPECT_LT(norm(momentum(sheet) - before), 1e-11 * scale);
    ASSERT_EQ(report.unresolved_crossings, 0u);
    if (k % 5 == 4) { ASSERT_EQ(count_self_crossings(sheet), 0u) << "after " << k + 1 << " ms"; }
  }
}

TEST(SelfContact, layers_rest_a_thickness_apart) {
  // A strip folded over lies on a plane.
  Sheet sheet = thrown_fold(0.2);
  ClothParams params = shirt();
  params.air.density = 1.2;
  const std::vector<ClothSolid> floor{{.shape = Plane{{0, 0, -0.004}, {0, 0, 1}}, .friction = 0.5}};
  ClothScratch scratch;
  for (int k = 0; k < 300; ++k) step_cloth(sheet, params, {.solids = floor, .measure = false}, 1e-3, scratch);
  EXPECT_EQ(count_self_crossings(sheet), 0u);
  // Nodes of the upper layer, far from the bend: half a thickness above the floor and one above the lower layer, less a
  // tenth that the passes of impulses leave.
  const Index n = 31;
  for (Index j = 3; j < n - 6; ++j) {
    EXPECT_GT(sheet.position[(n - 4) + n * j].z + 0.004, 1.4 * params.hand.thickness);
  }
}

TEST(SelfContact, the_list_holds_every_pair_that_brute_force_finds) {
  Sheet sheet = square(9, 0.08);
  for (std::size_t i = 0; i < sheet.size(); ++i) {
    const RandomCounter counter{.seed = 5, .id = i};
    // Crumpled so much that most triangles are near others.
    sheet.position[i] = 0.03 * Vec3{uniform(counter, 0), uniform(counter, 1), uniform(counter, 2)};
  }
  SelfContact contact;
  contact.owners = make_owners(sheet);
  const Real thickness = 1e-3, reserve = 1e-3, reach = thickness + 2 * reserve;
  contact.room.assign(sheet.size(), reserve);
  list_near_pairs(sheet, thickness, contact);
  std::set<std::pair<PairKind, std::array<Index, 4>>> listed;
  for (const ClosePair& pair : contact.pairs) listed.emplace(pair.kind, pair.node);
  EXPECT_EQ(listed.size(), contact.pairs.size()) << "a pair is listed twice";
  std::size_t missing = 0, found = 0;
  for (const auto& t : sheet.triangles) {
    const Vec3 n = cross(sheet.position[t[1]] - sheet.position[t[0]], sheet.position[t[2]] - sheet.position[t[0]]);
    for (Index i = 0; i < sheet.size(); ++i) {
      if (i == t[0] || i == t[1] || i == t[2]) continue;
      const std::array<Vec3, 4> x{sheet.position[i], sheet.position[t[0]], sheet.position[t[1]], sheet.position[t[2]]};
      if (gap_of(PairKind::node_triangle, x).distance >= reach || norm(n) == 0) continue;
      ++found;
      if (listed.contains({PairKind::node_triangle, {i, t[0], t[1], t[2]}})) continue;
      // Left out only where all triangles of the node that touch this one are nearly flat with it.
      bool beside = false;
      for (const auto& o : sheet.triangles) {
        const bool has = o[0] == i || o[1] == i || o[2] == i;
        bool shares = false;
        for (const Index a : o) shares = shares || a == t[0] || a == t[1] || a == t[2];
        beside = beside || (has && shares);
      }
      if (!beside) ++missing;
    }
  }
  EXPECT_GT(found, 500u);
  EXPECT_EQ(missing, 0u);
}

TEST(SelfContact, a_pin_that_jumps_is_survived) {
  // A key that starts away from the anchor throws a few nodes across many cells in one substep.
  Sheet sheet = square(21, 0.2);
  pin_nodes(sheet, nodes_of_edge(sheet, "top"), {{{0, {0, 0, 0.05}}}});
  ClothScratch scratch;
  for (int k = 0; k < 5; ++k) step_cloth(sheet, shirt(), {}, 1e-3, scratch);
  EXPECT_EQ(count_self_crossings(sheet), 0u);
}

TEST(SelfContact, the_same_bits_for_any_number_of_threads_and_with_a_new_scratch) {
  const auto run = [](int threads, bool fresh) {
    const ThreadLimit limit(threads);
    Sheet sheet = thrown_fold(5);
    const ClothParams params = shirt();
    ClothScratch scratch;
    for (int k = 0; k < 15; ++k) {
      if (fresh) scratch = ClothScratch();
      step_cloth(sheet, params, {}, 1e-3, scratch);
    }
    return sheet.position;
  };
  const auto one = run(1, false);
  EXPECT_EQ(one, run(2, false));
  EXPECT_EQ(one, run(1, true));
}

TEST(SelfContact, a_push_of_the_liquid_cannot_take_one_layer_through_the_other) {
  // The middle of a fold's upper half is pushed down as far as it lies above the lower one, and as far again.
  Sheet sheet = thrown_fold(0);
  const Real dt = 1e-3, way = 0.06;
  std::vector<Real> inverse_mass(sheet.size());
  std::vector<Vec3> impulse(sheet.size());
  Vec3 given{};
  for (std::size_t i = 0; i < sheet.size(); ++i) {
    inverse_mass[i] = i % 31 == 0 ? 0 : 1 / sheet.mass(i);  // the edge of the lower half is held
    if (sheet.position[i].z > 0.02 && std::abs(sheet.v[i] - 0.15) < 0.05) impulse[i] = {0, 0, -sheet.mass(i) * way / dt};
    given += impulse[i];
  }
  const ClothParams params = shirt();
  ClothParams blind = params;
  blind.contact.self = false;
  ClothScratch scratch, other;
  Sheet through = sheet;
  push_cloth(through, blind, inverse_mass, impulse, dt, other);
  EXPECT_GT(count_self_crossings(through), 0u);  // else the test shows nothing
  const std::vector<Vec3> before = sheet.position;
  const PushReport report = push_cloth(sheet, params, inverse_mass, impulse, dt, scratch);
  EXPECT_GT(report.swept_hits, 0u);
  EXPECT_EQ(report.unresolved_crossings, 0u);
  EXPECT_EQ(count_self_crossings(sheet), 0u);
  EXPECT_LT(norm(momentum(sheet) - given - report.pin_impulse), 1e-12 * norm(given));  // rounding
  for (std::size_t i = 0; i < sheet.size(); ++i)
    EXPECT_LT(norm(sheet.position[i] - before[i] - dt * sheet.velocity[i]), 1e-15);  // it went where the velocity says
}

}  // namespace
}  // namespace imbibe
