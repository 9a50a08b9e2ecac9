// A yarn network on a soft sheet in whole runs: books, momentum, bits, rest.
#include <gtest/gtest.h>
#include <unistd.h>

#include <numeric>

#include "imbibe/core/parallel.h"
#include "imbibe/geometry/moving_mesh.h"
#include "imbibe/io/run_folder.h"
#include "imbibe/sim/checkpoint.h"
#include "imbibe/sim/measures.h"
#include "imbibe/sim/state_hash.h"
#include "imbibe/view/frame_from_world.h"
#include "support/scene_runs.h"

namespace imbibe {
namespace {

// 12 x 12 mm of cotton at 10 yarns/cm held at its corners; 14 uL above it, some 290 particles.
World small_hammock(const std::vector<std::string>& overrides = {}) {
  const std::string text = R"(version: 1
title: small hammock
duration: 100 ms
liquid:
  kind: water
  particle_mass: 0.048 mg
  drops:
    - {centre: [0 mm, 0 mm, 2.1 mm], volume: 14 uL, velocity: [0, 0, -0.4 m/s]}
textiles:
  - name: hammock
    size: [12 mm, 12 mm]
    weave: plain
    warp: {fibre: cotton, diameter: 0.4 mm, density: 10 /cm}
    weft: {fibre: cotton, diameter: 0.4 mm, density: 10 /cm}
    sheet:
      soft:
        columns: 9
        rows: 9
        preset: silk
        cloth: {air: {density: 0}, contact: {self: false}}
        pins: [{corner: bottom_left}, {corner: bottom_right}, {corner: top_left}, {corner: top_right}]
    wetting: {network: {evaporation: false}}
domain: {lower: [-40 mm, -40 mm, -80 mm], upper: [40 mm, 40 mm, 40 mm]}
)";
  const auto file = test::scenes_folder() / "small_hammock.yaml";
  return test::build(read_scene_text(text, file.string(), overrides), file);
}

const SoftSheet& sheet_of(const World& world) {
  return world.textiles[0].cloth->soft;
}

Vec3 momentum_of(const World& world) {
  Vec3 sum = momentum(sheet_of(world).sheet);
  for (const Float4& v : world.liquid.particles.velocity) sum += world.liquid.particle_mass * Vec3(v.x, v.y, v.z);
  return sum;
}

Real carried(const World& world) {
  const auto& kg = sheet_of(world).sheet.added_mass;
  return std::accumulate(kg.begin(), kg.end(), Real{0});
}

TEST(NetworkClothRun, AFallingDropMovesTheClothIsTakenUpAndWeighsOnIt) {
  World world = small_hammock();
  Real worst_books = 0, worst_momentum = 0, scale = 0, lowest = 0;
  StepScratch scratch;
  std::size_t absorbed = 0;
  emit_due(world);
  while (world.time < 0.1) {
    const Vec3 before = momentum_of(world), supports = sheet_of(world).support_impulse;
    const Real mass = total_mass(sheet_of(world).sheet) + world.liquid.mass();
    const StepReport report = step(world, {.until = 0.1}, scratch);
    absorbed += report.absorbed;
    const Vec3 change = momentum_of(world) - before - (sheet_of(world).support_impulse - supports);
    worst_momentum = std::max(worst_momentum, norm(change - report.step_s * mass * world.gravity));
    scale = std::max(scale, norm(momentum_of(world)));
    worst_books = std::max(worst_books, mass_balance(world).error());
    for (const Vec3& x : sheet_of(world).sheet.position) lowest = std::min(lowest, x.z);
  }
  EXPECT_LE(worst_books, 1e-10);
  EXPECT_GT(absorbed, 20u);
  EXPECT_LT(lowest, -0.3e-3);  // it gave way
  // Per step and relative to the drop's momentum. The liquid's sums are of single precision.
  EXPECT_LT(worst_momentum, 1e-9 * scale);
  // All that was taken weighs, less what is lent by particles that are still whole.
  const Textile& textile = world.textiles[0];
  const MassBalance b = mass_balance(world);
  const Real taken = b.sorbed + b.yarn + b.pore - b.initial +
                     std::accumulate(textile.exchange.waiting_kg.begin(), textile.exchange.waiting_kg.end(), Real{0});
  EXPECT_NEAR(carried(world), taken - textile.cloth->borrowed_kg, 1e-9 * taken);
  EXPECT_LE(textile.cloth->borrowed_kg, taken);
}

TEST(NetworkClothRun, HasTheSameBitsForAnyThreadsFromACopyAndThroughACheckpoint) {
  std::uint64_t whole = 0;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    World world = small_hammock();
    run(world, {.until = 0.02, .every = 0.01, .max_steps = 0, .step = {}}, {});
    if (threads == 1) whole = state_hash(world);
    EXPECT_EQ(state_hash(world), whole) << threads;
  }
  World half = small_hammock(), resumed = small_hammock();
  run(half, {.until = 0.01, .every = 0.01, .max_steps = 0, .step = {}}, {});
  World copy = half;
  const auto file = std::filesystem::path(testing::TempDir()) / ("network_cloth_" + std::to_string(::getpid()) + ".h5");
  write_checkpoint(file, half);
  read_checkpoint(file, resumed);
  std::filesystem::remove(file);
  EXPECT_EQ(state_hash(resumed), state_hash(half));
  for (World* world : {&copy, &resumed}) {
    run(*world, {.until = 0.02, .every = 0.01, .max_steps = 0, .step = {}}, {});
    EXPECT_EQ(state_hash(*world), whole);
  }
}

TEST(NetworkClothRun, AHangingStripDrainsDownByItsTrueHeightAndHangsStill) {
  // Coarse yarns of coarse fibres hold little height: what stands in the pores runs to the lower half.
  World world = small_hammock({"liquid.drops=[]", "textiles[0].warp_direction=[0, 0, 1]",
                               "textiles[0].sheet.soft.pins=[{edge: top}]", "textiles[0].start.yarns=0.8",
                               "textiles[0].start.pores=0.3"});
  const Real start = carried(world);
  EXPECT_GT(start, 0);
  test::run_until(world, 20);
  const auto& sheet = sheet_of(world).sheet;
  Real upper = 0, lower = 0;
  for (std::size_t n = 0; n < sheet.size(); ++n) (sheet.v[n] > 6e-3 ? upper : lower) += sheet.added_mass[n];
  EXPECT_GT(lower, 1.05 * upper);
  EXPECT_TRUE(sheet_of(world).at_rest);
  EXPECT_NEAR(carried(world), start, 1e-9 * start);
  EXPECT_LE(mass_balance(world).error(), 1e-10);
}

TEST(NetworkClothRun, DriesBackToItsPlaceAndWeight) {
  World world = small_hammock({"liquid.drops=[]", "textiles[0].wetting={network: {}}", "air.humidity=20 %",
                               "air.mass_transfer=50 mm/s", "air.temperature=40 degC"});
  test::run_until(world, 4);  // at rest
  Real dry = 0, wet = 0, again = 0;
  const auto lowest = [&] {
    Real z = 0;
    for (const Vec3& x : sheet_of(world).sheet.position) z = std::min(z, x.z);
    return z;
  };
  dry = lowest();
  Textile& textile = world.textiles[0];
  Real added = 0;
  for (std::size_t s = 0; s < textile.fabric->network.segments(); ++s) {
    const Real more = 0.9 * textile.model->liquid.density * current_volume(*textile.model, textile.contents, s);
    textile.contents.liquid_kg[s] += more, added += more;
  }
  world.ledger.supplied_kg += added;
  test::run_until(world, 4.01);  // the sheet learns of it at the end of a step
  test::run_until(world, 7);
  wet = lowest();
  test::run_until(world, 1800);
  again = lowest();
  EXPECT_LT(wet, 1.05 * dry);  // heavier: lower
  EXPECT_NEAR(again, dry, 0.02 * std::abs(dry));
  EXPECT_LT(std::abs(carried(world)), 1e-3 * added);  // back in balance with the air, where it weighs nothing more
  EXPECT_LE(mass_balance(world).error(), 1e-10);
}

TEST(NetworkClothRun, FilesAndPicturesShowTheYarnsWhereTheClothIs) {
  World world = small_hammock({"liquid.drops=[]", "textiles[0].start.yarns=0.9"});
  test::run_until(world, 0.3);
  const Textile& textile = world.textiles[0];
  const Sheet& sheet = sheet_of(world).sheet;
  MovingMesh surface;
  set_step(surface, sheet.position, sheet.position, sheet.triangles);
  const PolyData yarns = textile_poly_data(textile, node_saturations(textile, world.air));
  const Frame frame = frame_from_world(world, "");
  ASSERT_EQ(yarns.points.size(), textile.fabric->network.points.size());
  EXPECT_EQ(frame.yarns.points, yarns.points);
  Real lowest = 0;
  for (const Vec3f& p : yarns.points) {
    lowest = std::min(lowest, static_cast<Real>(p.z));
    // A yarn's centre line is at most its crimp off the middle of the cloth.
    EXPECT_LT(nearest_on(surface, Vec3(p)).distance, 0.51 * textile.fabric->network.thickness);
  }
  EXPECT_LT(lowest, -0.3e-3);
}

TEST(NetworkClothRun, AWetClothTouchesABallInMorePlacesThanADryOne) {
  const auto on_ball = [](const std::string& yarns) {
    World world =
        small_hammock({"liquid.drops=[]", "textiles[0].size=[36 mm, 36 mm]", "textiles[0].centre=[0 mm, 0 mm, 13 mm]",
                       "textiles[0].sheet.soft.pins=[]", "textiles[0].sheet.soft.columns=21",
                       "textiles[0].sheet.soft.rows=21", "textiles[0].start.yarns=" + yarns,
                       "solids=[{name: ball, shape: {kind: sphere, centre: [0 mm, 0 mm, 0 mm], radius: 12 mm}, "
                       "contact_angle: 40 deg}]"});
    test::run_until(world, 0.25);
    std::size_t near = 0;
    const Real reach = 12e-3 + 0.5 * sheet_of(world).cloth.hand.thickness + 0.2e-3;  // where bridges hold
    for (const Vec3& x : sheet_of(world).sheet.position) near += norm(x) < reach;
    return near;
  };
  EXPECT_GT(4 * on_ball("0.8"), 5 * on_ball("0"));  // 45 nodes against 30 touch
}

}  // namespace
}  // namespace imbibe
