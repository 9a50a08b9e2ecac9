#include "imbibe/coupling/contact.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "imbibe/core/parallel.h"
#include "imbibe/fabric/tube_mesh.h"
#include "imbibe/geometry/curve.h"
#include "imbibe/geometry/sampling.h"
#include "support/small_weave.h"

namespace imbibe {
namespace {

using testing::small_weave;

constexpr Real reach = 1e-4;  // m, particle radius

struct Flight {
  Vec3 p0, p1;
};

// Up to 50 m/s for up to 5 ms, from anywhere in and around the sheet: paths up to 0.25 m, most of them aimed at it.
Flight random_flight(const YarnNetwork& network, std::uint64_t id) {
  const RandomCounter counter{7, id, 0};
  const Real half = 0.5 * network.size_x;
  Bounds around;
  around.include({-1.2 * half, -1.2 * half, -2e-3});
  around.include({1.2 * half, 1.2 * half, 2e-3});
  const Vec3 p0 = random_in(around, counter);
  const Real length = 50 * uniform(counter, 5) * 5e-3 * uniform(counter, 6);
  return {p0, p0 + length * random_direction(counter, 3)};
}

std::span<const Vec3> centre_line(const YarnNetwork& network, std::size_t yarn) {
  const Index first = network.yarn_first_point[yarn];
  return {network.points.data() + first, network.yarn_first_point[yarn + 1] - first};
}

// Distance from the nearest centre line of all yarns: the brute-force oracle.
Real distance_to_yarns(const YarnNetwork& network, const Vec3& p) {
  Real squared = std::numeric_limits<Real>::infinity();
  for (std::size_t y = 0; y < network.yarn_family.size(); ++y) {
    squared = std::min(squared, closest_on_curve(centre_line(network, y), p).squared_distance);
  }
  return std::sqrt(squared);
}

// The first time at which the path is within `limit` of a straight piece a-b. The distance to a convex body is convex
// along a line: golden ratio for the least distance, then bisection. Knows nothing of the formulas under test.
std::optional<Real> first_time_near(const Flight& f, const Vec3& a, const Vec3& b, Real limit) {
  const auto distance = [&](Real t) {
    const Vec3 p = f.p0 + t * (f.p1 - f.p0);
    return norm(p - closest_on_segment(p, a, b).point);
  };
  Real low = 0, high = 1;
  for (int i = 0; i < 80; ++i) {
    const Real l = low + 0.382 * (high - low), h = low + 0.618 * (high - low);
    if (distance(l) < distance(h)) high = h;
    else low = l;
  }
  const Real nearest = 0.5 * (low + high);
  if (distance(nearest) > limit) return std::nullopt;
  Real out = 0, in = nearest;
  for (int i = 0; i < 60; ++i) {
    const Real middle = 0.5 * (out + in);
    (distance(middle) > limit ? out : in) = middle;
  }
  return in;
}

std::optional<Real> first_time_by_brute_force(const YarnNetwork& network, const Flight& f, Real limit) {
  std::optional<Real> first;
  Bounds path;
  path.include(f.p0), path.include(f.p1);
  path.grow(limit);
  for (std::size_t y = 0; y < network.yarn_family.size(); ++y) {
    const auto points = centre_line(network, y);
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      Bounds piece;
      piece.include(points[i]), piece.include(points[i + 1]);
      if (!path.overlaps(piece)) continue;
      const auto t = first_time_near(f, points[i], points[i + 1], limit);
      if (t && (!first || *t < *first)) first = t;
    }
  }
  return first;
}

struct Sheet {
  YarnNetwork network;
  YarnContactIndex index;
  Real radius = 0;
  explicit Sheet(const testing::SmallWeave& spec = {})
      : network(small_weave(spec)), index(build_contact_index(network)), radius(spec.radius) {}
  std::optional<YarnHit> hit(const Flight& f, const ContactParams& params = {}, ContactCounts* counts = nullptr) const {
    return first_hit(index, network, f.p0, f.p1, reach, params, counts);
  }
};

TEST(Contact, TheSweptHitIsTheFirstTimeThatBruteForceFinds) {
  const Sheet sheet;
  const Real limit = sheet.radius + reach;
  int compared = 0, hits = 0;
  for (std::uint64_t id = 0; compared < 1500; ++id) {
    const Flight f = random_flight(sheet.network, id);
    if (distance_to_yarns(sheet.network, f.p0) < 1.001 * limit) continue;  // touching starts have tests of their own
    ++compared;
    const auto expected = first_time_by_brute_force(sheet.network, f, limit);
    const auto hit = sheet.hit(f);
    ASSERT_EQ(hit.has_value(), expected.has_value()) << "flight " << id;
    if (!hit) continue;
    ++hits;
    const Vec3 at = f.p0 + hit->time_fraction * (f.p1 - f.p0);
    // Bisection of a grazing path ends where the distance, not the time, is exact: both are compared as distances.
    EXPECT_NEAR(distance_to_yarns(sheet.network, at), limit, 1e-10) << "flight " << id;
    EXPECT_LE(hit->time_fraction, *expected + 1e-6) << "flight " << id;
    EXPECT_NEAR(norm(hit->normal), 1, 1e-12);
    EXPECT_NEAR(norm(at - hit->point), reach, 1e-10);
    EXPECT_LE(dot(hit->normal, f.p1 - f.p0), 0);
    EXPECT_FALSE(hit->resting);
  }
  EXPECT_GT(hits, 300);
}

TEST(Contact, DenseSamplingOfThePathFindsNoContactThatTheSweepMissed) {
  const Sheet sheet;
  int samples_inside = 0;
  for (std::uint64_t id = 0; id < 150; ++id) {
    const Flight f = random_flight(sheet.network, id + 1000000);
    if (distance_to_yarns(sheet.network, f.p0) < 1.001 * (sheet.radius + reach)) continue;
    const auto hit = sheet.hit(f);
    const Real free_until = hit ? hit->time_fraction : 1;
    const int samples = 1 + static_cast<int>(norm(f.p1 - f.p0) / 5e-5);
    for (int k = 0; k <= samples; ++k) {
      const Real t = static_cast<Real>(k) / samples;
      if (t >= free_until) break;
      ASSERT_GE(distance_to_yarns(sheet.network, f.p0 + t * (f.p1 - f.p0)), sheet.radius + reach - 1e-12) << id;
      ++samples_inside;
    }
  }
  EXPECT_GT(samples_inside, 10000);
}

// Yarns side by side without a gap: whoever is above before and below afterwards went through a yarn.
class ClosedSheet : public ::testing::TestWithParam<ContactForm> {};

TEST_P(ClosedSheet, LetsNoneOfAMillionFastParticlesThroughUnnoticed) {
  const Sheet sheet({.yarns = 30, .pitch = 4e-4, .radius = 2e-4});
  const ContactParams params{.form = GetParam()};
  // The triangle form costs 20 times as much and is compared with the round one below: fewer particles here.
  const std::uint64_t particles = GetParam() == ContactForm::round ? 1000000 : 30000;
  const Real half = 0.5 * sheet.network.size_x - 2 * sheet.radius, face = 2 * sheet.radius + reach;
  std::vector<std::uint8_t> crossed(particles), noticed(particles);
  parallel_for(particles, [&](std::size_t id) {
    const RandomCounter counter{11, id, 0};
    const Vec3 through{half * (2 * uniform(counter, 0) - 1), half * (2 * uniform(counter, 1) - 1), 0};
    const Real step = 5e-3 * uniform(counter, 2), speed = 50 * uniform(counter, 3);
    const Vec3 path = step * speed * random_direction(counter, 4);
    const Flight f{through - uniform(counter, 6) * path, through + uniform(counter, 7) * path};
    // Inside the sheet's outline all along its way through the slab.
    const Real rise = std::abs(path.z) / norm(path);
    if (std::max(std::abs(through.x), std::abs(through.y)) + face / rise > half) return;
    crossed[id] = (f.p0.z > face && f.p1.z < -face) || (f.p0.z < -face && f.p1.z > face);
    noticed[id] = sheet.hit(f, params).has_value();
  });
  std::size_t through = 0, unnoticed = 0;
  for (std::size_t id = 0; id < particles; ++id) through += crossed[id], unnoticed += crossed[id] && !noticed[id];
  EXPECT_EQ(unnoticed, 0u);
  EXPECT_GT(through, particles / 10);
}

INSTANTIATE_TEST_SUITE_P(BothForms, ClosedSheet, ::testing::Values(ContactForm::round, ContactForm::triangles));

TEST(Contact, TrianglesGiveTheAnswerOfTheRoundYarnWithinTheMeshsDeviation) {
  const Sheet sheet;
  const Real deviation = mesh_deviation(sheet.network), limit = sheet.radius + reach;
  // 16 corners: 1.9 % of the radius, a little more where the centre line bends.
  EXPECT_GT(deviation, 0.019 * sheet.radius);
  EXPECT_LT(deviation, 0.05 * sheet.radius);
  const Real half = 0.5 * sheet.network.size_x;
  int both = 0, only_round = 0;
  for (std::uint64_t id = 0; id < 1500; ++id) {
    const Flight f = random_flight(sheet.network, id);
    if (distance_to_yarns(sheet.network, f.p0) < 1.001 * limit) continue;
    const auto round = sheet.hit(f), mesh = sheet.hit(f, {.form = ContactForm::triangles});
    // The ends of a yarn are half balls in one form and flat in the other: only hits within the sheet are compared.
    if (round && std::max(std::abs(round->point.x), std::abs(round->point.y)) > half - sheet.radius) continue;
    if (!round) {
      EXPECT_FALSE(mesh.has_value()) << "flight " << id;
      continue;
    }
    const Real until = mesh ? mesh->time_fraction : 1;
    // The mesh lies inside: never earlier, and nowhere before its hit deeper in the round shell than the deviation.
    EXPECT_GE(until, round->time_fraction - 1e-9) << "flight " << id;
    for (int k = 0; k <= 20; ++k) {
      const Real t = round->time_fraction + (until - round->time_fraction) * k / 20;
      const Vec3 at = f.p0 + t * (f.p1 - f.p0);
      if (std::max(std::abs(at.x), std::abs(at.y)) > half - sheet.radius) break;
      EXPECT_GE(distance_to_yarns(sheet.network, at), limit - deviation - 1e-10) << "flight " << id;
    }
    mesh ? ++both : ++only_round;
  }
  EXPECT_GT(both, 250);
  EXPECT_LT(only_round, both / 20);  // grazing paths
}

TEST(Contact, TheTrianglesAreThoseOfTheFabricsTubeMesh) {
  const YarnNetwork network = small_weave();
  for (const Index segment : {Index{13}, Index{148}}) {  // a warp's and a weft's, away from the ends
    const TriangleMesh tube = segment_tube(network, segment, {.sides = tube_sides});
    std::size_t t = 0;
    visit_segment_triangles(
        network, network.segment_yarn[segment], segment, [](const Bounds&) { return true; },
        [&](const Vec3& a, const Vec3& b, const Vec3& c) {
          ASSERT_LT(t, tube.triangles.size());
          // Rounding of coordinates of some millimetres.
          EXPECT_LT(norm(a - tube.corner(t, 0)) + norm(b - tube.corner(t, 1)) + norm(c - tube.corner(t, 2)), 1e-17);
          ++t;
        });
    EXPECT_EQ(t, tube.triangles.size());
  }
}

// --- the rules for a particle that touches already -------------------------------------------------------------------

// One straight weft yarn along x.
YarnNetwork straight_yarn() {
  YarnNetwork network = small_weave({.yarns = 1, .pitch = 1e-2});
  for (Vec3& p : network.points) p.y = p.z = 0;
  for (Index i = network.yarn_first_point[0]; i < network.yarn_first_point[1]; ++i) network.points[i].z = -1;  // warp away
  return network;
}

struct TouchCase {
  const char* name;
  ContactForm form;
  Real height;  // of the particle's centre over the surface
};

class TouchingParticle : public ::testing::TestWithParam<TouchCase> {
 protected:
  YarnNetwork network = straight_yarn();
  YarnContactIndex index = build_contact_index(network);
  Real radius = network.yarn_types[0].radius;
  // Over a corner of the tube the mesh is exactly as high as the round yarn.
  Vec3 start{0.3e-3, 0, radius + GetParam().height};
  std::optional<YarnHit> go(const Vec3& path) {
    return first_hit(index, network, start, start + path, reach, {.form = GetParam().form});
  }
};

TEST_P(TouchingParticle, HitsAtOnceWhenItMovesTowardsTheSurface) {
  const auto hit = go({1e-4, 0, -1e-4});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->time_fraction, 0);
  EXPECT_FALSE(hit->resting);
  // Inside the mesh the nearest facet stands half a facet's angle off the corner above the particle.
  const Real lean = GetParam().form == ContactForm::round || GetParam().height > 0 ? 0 : 1 - std::cos(pi / tube_sides);
  EXPECT_NEAR(hit->normal.z, 1, lean + 1e-6);
  EXPECT_NEAR(hit->point.z, radius, lean * radius + 1e-9);
}

TEST_P(TouchingParticle, DoesNotHitWhenItMovesAway) {
  EXPECT_FALSE(go({1e-4, 0, 1e-4}));
  EXPECT_FALSE(go({5e-3, 0, 5e-2}));
}

TEST_P(TouchingParticle, RestsWhenItMovesAlongOrNotAtAll) {
  for (const Vec3& path : {Vec3{1e-4, 0, 0}, Vec3{0, 0, 0}, Vec3{1e-4, 0, 1e-8}}) {
    const auto hit = go(path);
    ASSERT_TRUE(hit);
    EXPECT_TRUE(hit->resting);
    EXPECT_EQ(hit->time_fraction, 0);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Depths, TouchingParticle,
    ::testing::Values(TouchCase{"RoundAtTheThreshold", ContactForm::round, reach},
                      TouchCase{"RoundNear", ContactForm::round, 0.5 * reach},
                      TouchCase{"RoundInside", ContactForm::round, -0.5 * reach},
                      TouchCase{"TrianglesAtTheThreshold", ContactForm::triangles, reach},
                      TouchCase{"TrianglesNear", ContactForm::triangles, 0.5 * reach},
                      TouchCase{"TrianglesInside", ContactForm::triangles, -0.5 * reach}),
    [](const auto& touch) { return touch.param.name; });

TEST(Contact, AParticleThatSlidesOverAConvexBendIsNotCaughtByTheNextPiece) {
  const Sheet sheet;
  // The crest of a yarn: away from it, along it.
  for (const ContactForm form : {ContactForm::round, ContactForm::triangles}) {
    for (Index s = 12; s < 18; ++s) {
      const Vec3 crest = sheet.network.segment_centre[s];
      const Real side = crest.z > 0 ? 1 : -1;
      const Vec3 p0 = crest + Vec3{0, 0, side * (sheet.radius + 0.9 * reach)};
      EXPECT_FALSE(sheet.hit({p0, p0 + Vec3{0, 4e-4, side * 2e-5}}, {.form = form})) << s;
    }
  }
}

TEST(Contact, AParticleThatLeavesOneYarnHitsTheNextOne) {
  const Sheet sheet;
  const Vec3 crest = sheet.network.segment_centre[45];
  const Real side = crest.z > 0 ? 1 : -1;
  // Sideways off the flank of a warp's crest, down to where the crossing weft rises again.
  const Vec3 p0 = crest + Vec3{sheet.radius + reach, 0, 0};
  const auto hit = sheet.hit({p0, p0 + Vec3{1e-5, 0, -side * 3e-4}});
  ASSERT_TRUE(hit);
  EXPECT_NE(sheet.network.segment_yarn[hit->segment], sheet.network.segment_yarn[45]);
}

// --- the hierarchy ----------------------------------------------------------------------------------------------------

TEST(Contact, TheTextilesBoxIsMadeOfItsYarnsAndHoldsTheRoundYarnsExactly) {
  const Sheet sheet;
  const Real end = 5 * 1e-3 + sheet.radius;
  // Float boxes are rounded outwards: never smaller, larger by a few ulp (6e-10 m at 5 mm).
  EXPECT_GE(sheet.index.textile.upper.x, end);
  EXPECT_NEAR(sheet.index.textile.upper.x, end, 2e-9);
  EXPECT_NEAR(sheet.index.textile.lower.z, -2 * sheet.radius, 1e-9);
}

TEST(Contact, CostFollowsTheParticlesNearTheSheetNotTheSheetsSize) {
  ContactCounts small, large, far;
  const Sheet little({.yarns = 16}), big({.yarns = 128});
  for (std::uint64_t id = 0; id < 500; ++id) {
    const RandomCounter counter{3, id, 0};
    const Vec3 p0{6e-3 * (uniform(counter, 0) - 0.5), 6e-3 * (uniform(counter, 1) - 0.5), 6e-4};
    const Flight down{p0, p0 + Vec3{0, 0, -6e-4}};
    little.hit(down, {}, &small);
    big.hit(down, {}, &large);
    big.hit({p0 + Vec3{0, 0, 1}, p0 + Vec3{0, 0, 2}}, {}, &far);
  }
  EXPECT_EQ(far.textile_boxes, 500u);
  EXPECT_EQ(far.yarn_boxes + far.segment_boxes + far.pieces, 0u);
  EXPECT_GT(small.pieces, 500u);
  // 64 times the segments: three more levels of yarns, one of segments.
  EXPECT_LT(large.yarn_boxes + large.segment_boxes, 3 * (small.yarn_boxes + small.segment_boxes));
  EXPECT_NEAR(static_cast<Real>(large.pieces) / static_cast<Real>(small.pieces), 1, 0.2);
}

TEST(Contact, AfterARefitTheMovedSheetIsHitWhereItIsNow) {
  Sheet sheet;
  for (Vec3& p : sheet.network.points) p.z += 0.01;
  refit(sheet.index, sheet.network);
  const YarnContactIndex fresh = build_contact_index(sheet.network);
  EXPECT_EQ(fresh.textile.lower, sheet.index.textile.lower);
  for (std::uint64_t id = 0; id < 300; ++id) {
    Flight f = random_flight(sheet.network, id);
    f.p0.z += 0.01, f.p1.z += 0.01;
    const auto a = sheet.hit(f), b = first_hit(fresh, sheet.network, f.p0, f.p1, reach);
    ASSERT_EQ(a.has_value(), b.has_value());
    if (a) {
      EXPECT_EQ(a->segment, b->segment);
    }
  }
}

TEST(Contact, ABatchGivesTheSameHitsForAnyNumberOfThreadsInWorldCoordinates) {
  const Sheet sheet;
  Placement placement;  // turned about z by 90 degrees and moved
  placement.origin = {0.1, 0.2, 0.3}, placement.u = {0, 1, 0}, placement.v = {-1, 0, 0};
  std::vector<Float4> position, velocity;
  const Real step = 1e-3;
  for (std::uint64_t id = 0; id < 3000; ++id) {
    const Flight f = random_flight(sheet.network, id);
    const Vec3 p = placement.to_world(f.p0), v = (placement.to_world(f.p1) - p) / step;
    position.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z), 0});
    velocity.push_back({static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z), 0});
  }
  std::vector<std::vector<ParticleHit>> results;
  for (const int threads : {1, 2, 3}) {
    const ThreadLimit limit(threads);
    ContactScratch scratch;
    ContactCounts counts;
    find_hits(sheet.index, sheet.network, placement, position, velocity, step, reach, {}, results.emplace_back(), scratch,
              &counts);
    EXPECT_EQ(counts.textile_boxes, 3000u);
  }
  ASSERT_GT(results[0].size(), 500u);
  for (const auto& other : results) {
    ASSERT_EQ(other.size(), results[0].size());
    for (std::size_t k = 0; k < other.size(); ++k) {
      EXPECT_EQ(other[k].particle, results[0][k].particle);
      EXPECT_EQ(other[k].hit.segment, results[0][k].hit.segment);
      EXPECT_EQ(other[k].hit.time_fraction, results[0][k].hit.time_fraction);
    }
  }
  for (const ParticleHit& h : results[0]) {
    // Floats near 0.3 m are 3e-8 m apart, and so is the sheet-side comparison.
    const Vec3 point = placement.to_sheet(h.hit.point);
    EXPECT_NEAR(distance_to_yarns(sheet.network, point), sheet.radius, 1.1 * reach);
    EXPECT_NEAR(norm(h.hit.normal), 1, 1e-6);
  }
}

// --- bounce -----------------------------------------------------------------------------------------------------------

TEST(Bounce, ASpecularBounceKeepsTheSpeedAndMirrorsTheNormalPart) {
  for (std::uint64_t id = 0; id < 100; ++id) {
    const RandomCounter counter{5, id, 0};
    const Vec3 n = random_direction(counter), v = 10 * uniform(counter, 2) * random_direction(counter, 3);
    const Bounce b = bounce(v, n, 2e-7);
    EXPECT_NEAR(norm(b.velocity), norm(v), 1e-13);
    EXPECT_NEAR(dot(b.velocity, n), std::abs(dot(v, n)), 1e-13);
    // Rounding of 2e-7 kg times 10 m/s.
    EXPECT_NEAR(norm(2e-7 * v - (2e-7 * b.velocity + b.impulse_on_textile)), 0, 1e-20);
  }
}

TEST(Bounce, AParticleThatMovesAwayIsLeftAlone) {
  const Bounce b = bounce({1, 2, 3}, {0, 0, 1}, 1e-6);
  EXPECT_EQ(b.velocity, (Vec3{1, 2, 3}));
  EXPECT_EQ(b.impulse_on_textile, Vec3{});
}

TEST(Bounce, FrictionTakesItsShareOfTheSlipAndNeverTurnsItRound) {
  // (1 + e)|v.n| = 1.5: mu = 0.1 takes 0.15 m/s of the slip of 5 m/s.
  const Bounce slips = bounce({3, 4, -1}, {0, 0, 1}, 1, 0.5, 0.1);
  EXPECT_NEAR(slips.velocity.x, 3 * (1 - 0.15 / 5), 1e-14);
  EXPECT_NEAR(slips.velocity.y, 4 * (1 - 0.15 / 5), 1e-14);
  EXPECT_NEAR(slips.velocity.z, 0.5, 1e-14);
  const Bounce sticks = bounce({3, 4, -1}, {0, 0, 1}, 1, 0.5, 100);
  EXPECT_NEAR(std::hypot(sticks.velocity.x, sticks.velocity.y), 0, 1e-14);
}

TEST(Bounce, RestingGivesAllMomentumToTheTextile) {
  const Bounce b = rest({1, 2, 3}, 2);
  EXPECT_EQ(b.velocity, Vec3{});
  EXPECT_EQ(b.impulse_on_textile, (Vec3{2, 4, 6}));
}

}  // namespace
}  // namespace imbibe
