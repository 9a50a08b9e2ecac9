#include "imbibe/scene/live_change.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "imbibe/core/error.h"
#include "imbibe/scene/builder.h"
#include "imbibe/sim/run.h"
#include "imbibe/sim/state_hash.h"

namespace imbibe {
namespace {

const char* const small_scene =
    "version: 1\n"
    "duration: 40 ms\n"
    "liquid:\n"
    "  particle_mass: 0.03 mg\n"
    "  drops: [{centre: [0 mm, 0 mm, 1.2 mm], volume: 3 uL, velocity: [0, 0, -0.1 m/s]}]\n"
    "  droppers: [{centre: [3 mm, 0 mm, 3 mm], volume: 0.4 uL, interval: 20 ms, count: 100, start: 1 ms}]\n"
    "textiles:\n"
    "  - name: swatch\n"
    "    size: [9 mm, 9 mm]\n"
    "    warp: {fibre: cotton, linear_density: 20 tex, density: 30 /cm}\n"
    "    weft: {fibre: cotton, linear_density: 20 tex, density: 28 /cm}\n";

const Library& library() {
  static const Library read = read_library({IMBIBE_SOURCE_DIR});
  return read;
}

struct Running {
  Scene scene;
  World world;
};

void run_to(World& world, Real until, const RunHooks& hooks = {}) {
  RunPlan plan;
  plan.until = until, plan.every = 1e-3;
  run(world, plan, hooks);
}

// The small scene with `changes`, run to `until` or to the change that ends it.
Running run_with(std::vector<LoggedChange> changes, Real until = 40e-3) {
  Running r{read_scene_text(small_scene, "small"), {}};
  r.world = build_world(r.scene, library());
  ChangeReplay replay(std::move(changes));
  RunHooks hooks;
  hooks.before_step = [&](World& world, Real& end) { return replay.apply_due(r.scene, world, library(), end); };
  hooks.stop_requested = [&] { return replay.ended(); };
  run_to(r.world, until, hooks);
  return r;
}

std::string refusal(const std::string& assignment) {
  Running r = run_with({}, 2e-3);
  const std::uint64_t before = state_hash(r.world);
  try {
    apply_change(r.scene, r.world, library(), {assignment});
  } catch (const InputError& error) {
    EXPECT_EQ(state_hash(r.world), before) << "a refused change must leave the world alone";
    return error.what();
  }
  return "";
}

TEST(LiveChange, ContactAngleTakesEffectAndKeepsTheMass) {
  Running r = run_with({}, 10e-3);
  const MassBalance before = mass_balance(r.world);
  apply_change(r.scene, r.world, library(), {"textiles[0].contact_angle=75 deg"});
  const MassBalance after = mass_balance(r.world);
  EXPECT_NEAR(r.world.textiles[0].model->fibres[0].advancing_angle, radians(75), 1e-12);
  EXPECT_EQ(after.free, before.free);
  EXPECT_EQ(after.yarn, before.yarn);
  EXPECT_EQ(after.sorbed, before.sorbed);
  EXPECT_EQ(r.world.step, run_with({}, 10e-3).world.step);
}

TEST(LiveChange, WarpAndWeftMayHaveAnglesOfTheirOwn) {
  for (const char* layers : {"", "    layers: [{}, {}]\n"}) {  // layers share yarn types that are alike
    SCOPED_TRACE(layers);
    Running r{read_scene_text(std::string(small_scene) + layers, "small",
                              {"textiles[0].weft.density=30 /cm", "liquid.drops[0].centre=[0 mm, 0 mm, 1.5 mm]"}), {}};
    r.world = build_world(r.scene, library());
    run_to(r.world, 5e-3);
    const Real own = r.world.textiles[0].model->fibres[0].advancing_angle;
    apply_change(r.scene, r.world, library(), {"textiles[0].weft_contact_angle=110 deg"});
    const Textile& textile = r.world.textiles[0];
    for (std::size_t s = 0; s < textile.model->segments; ++s) {
      const bool weft = textile.fabric->network.family_of_segment(s) == Family::weft;
      EXPECT_NEAR(textile.model->fibres[textile.model->segment_type[s]].advancing_angle, weft ? radians(110) : own, 1e-12);
    }
    run_to(r.world, 20e-3);
    Real in_weft = 0, in_warp = 0;
    for (std::size_t s = 0; s < textile.model->segments; ++s)
      (textile.fabric->network.family_of_segment(s) == Family::weft ? in_weft : in_warp) += r.world.textiles[0].contents.liquid_kg[s];
    EXPECT_EQ(in_weft, 0);
    EXPECT_GT(in_warp, 1e-8);
    EXPECT_LT(mass_balance(r.world).error(), 1e-10);
  }
}

TEST(LiveChange, ChangeToTheValueThatIsThereLeavesEveryBitOfTheLiquid) {
  Running r = run_with({}, 10e-3);
  World before = r.world;
  apply_change(r.scene, r.world, library(), {"air.humidity=65 %"});
  // Only the pace is made short again.
  before.pace.resting = r.world.pace.resting, before.pace.calm_since = r.world.pace.calm_since;
  before.pace.wetting_interval = r.world.pace.wetting_interval;
  EXPECT_EQ(state_hash(r.world), state_hash(before));
}

TEST(LiveChange, AirGravityAndLiquidPropertiesChange) {
  Running r = run_with({}, 5e-3);
  apply_change(r.scene, r.world, library(),
               {"air.humidity=20 %", "gravity=[0, 0, -1.6 m/s2]", "liquid.kind.surface_tension=30 mN/m"});
  EXPECT_DOUBLE_EQ(r.world.air.humidity, 0.2);
  EXPECT_DOUBLE_EQ(r.world.gravity.z, -1.6);
  EXPECT_DOUBLE_EQ(r.world.liquid.kind.surface_tension, 0.03);
  EXPECT_DOUBLE_EQ(r.world.textiles[0].model->liquid.surface_tension, 0.03);
}

// A soft cloth that hangs by its corners, with a drop on it: of cells, or of a network of yarns.
std::string soft_scene(bool cells) {
  return std::string("version: 1\nduration: 1 s\n"
                     "liquid:\n  particle_mass: 0.5 mg\n"
                     "  drops: [{centre: [0 mm, 0 mm, 2.6 mm], volume: 15 uL, velocity: [0, 0, -0.3 m/s]}]\n"
                     "  droppers: [{centre: [3 mm, 0 mm, 6 mm], volume: 2 uL, interval: 20 ms, count: 100, start: 1 ms}]\n"
                     "textiles:\n  - name: cloth\n    size: [16 mm, 16 mm]\n"
                     "    sheet: {soft: {columns: 5, rows: 5, preset: jersey, pins: [{corner: bottom_left}, "
                     "{corner: bottom_right}, {corner: top_left}, {corner: top_right}]}}\n") +
         (cells ? "    areal_mass: 150 g/m2\n    wetting: {cells: {resistance: 100}}\n"
                : "    warp: {fibre: cotton, diameter: 0.4 mm, density: 10 /cm}\n"
                  "    weft: {fibre: cotton, diameter: 0.4 mm, density: 10 /cm}\n    wetting: network\n");
}

const SoftSheet& soft_sheet(const World& world) {
  return world.cell_cloths.empty() ? world.textiles[0].cloth->soft : world.cell_cloths[0].soft;
}

TEST(LiveChange, SoftClothWithLiquidInItGoesOnWithOtherWindStiffnessAndSwitches) {
  for (const bool cells : {true, false}) {
    SCOPED_TRACE(cells ? "cells" : "network");
    Running r{read_scene_text(soft_scene(cells), "soft"), {}};
    r.world = build_world(r.scene, library());
    run_to(r.world, 30e-3);
    const MassBalance before = mass_balance(r.world);
    EXPECT_GT(before.cell + before.yarn + before.pore, 1e-7) << "the cloth is to hold some liquid";
    const std::vector<Vec3> place = soft_sheet(r.world).sheet.position;
    std::vector<std::string> changes{"textiles[0].sheet.soft.cloth.air.wind=[3 m/s, 0 m/s, 0 m/s]",
                                     "textiles[0].sheet.soft.cloth.hand.stretch_weft=2000 N/m",
                                     "liquid.droppers[0].volume=3 uL"};
    if (cells) changes.push_back("textiles[0].wetting.cells.absorb=false");
    apply_change(r.scene, r.world, library(), changes);
    const MassBalance after = mass_balance(r.world);
    EXPECT_EQ(after.cell, before.cell);
    EXPECT_EQ(after.yarn, before.yarn);
    EXPECT_EQ(after.free, before.free);
    for (std::size_t i = 0; i < place.size(); ++i) EXPECT_EQ(soft_sheet(r.world).sheet.position[i].z, place[i].z) << i;
    EXPECT_EQ(soft_sheet(r.world).cloth.air.wind.x, 3);
    run_to(r.world, 40e-3);
    EXPECT_LT(mass_balance(r.world).error(), 1e-10);
  }
}

TEST(LiveChange, AddedDropFalls) {
  const auto drop = "liquid.drops[1]={centre: [-3 mm, 2 mm, 3 mm], volume: 0.5 uL, start: 5 ms}";
  const Running with = run_with({{.step = 20, .assignments = {drop}}}), without = run_with({});
  EXPECT_NEAR(with.world.ledger.supplied_kg - without.world.ledger.supplied_kg, 0.5e-9 * 998.2,
              0.51 * with.world.liquid.particle_mass);  // half a particle is carried
  EXPECT_LT(mass_balance(with.world).error(), 1e-10);
}

TEST(LiveChange, DropMayFallWhereABentClothNoLongerIs) {
  Running r{read_scene_text(soft_scene(false), "soft"), {}};
  r.world = build_world(r.scene, library());
  Sheet& sheet = r.world.textiles[0].cloth->soft.sheet;
  for (Vec3& x : sheet.position) x.z -= 5e-3;
  const auto drop = [&](const char* z) {
    return fmt::format("liquid.drops[1]={{centre: [5 mm, 5 mm, {}], volume: 1 uL, start: 1 ms}}", z);
  };
  EXPECT_THROW(apply_change(r.scene, r.world, library(), {drop("-5 mm")}), InputError) << "the cloth is there now";
  apply_change(r.scene, r.world, library(), {drop("0 mm")});
  EXPECT_EQ(r.scene.liquid.drops.size(), 2u);
}

TEST(LiveChange, YarnsThatNoLongerWetExpelWhatTheyHeld) {
  Running r = run_with({}, 30e-3);
  const MassBalance before = mass_balance(r.world);
  ASSERT_GT(before.yarn, 1e-7);
  apply_change(r.scene, r.world, library(), {"textiles[0].contact_angle=120 deg"});
  const MassBalance after = mass_balance(r.world);
  EXPECT_EQ(after.yarn, 0);
  EXPECT_LT(after.error(), 1e-12);  // rounding of sums of 1e3 terms
  run_to(r.world, 40e-3);
  EXPECT_LT(mass_balance(r.world).error(), 1e-10);
}

TEST(LiveChange, ShorterIntervalOfADropperMakesNoBurst) {
  Running r = run_with({}, 25e-3);  // drops at 1 and 21 ms
  const Real supplied = r.world.ledger.supplied_kg;
  apply_change(r.scene, r.world, library(), {"liquid.droppers[0].interval=2 ms"});
  EXPECT_NEAR(next_emission(r.world.sources.back()), 27e-3, 1e-9);
  run_to(r.world, 26e-3);
  EXPECT_EQ(r.world.ledger.supplied_kg, supplied);
}

std::string pipe_scene() {
  return "version: 1\nduration: 200 ms\nliquid:\n  particle_mass: 1 mg\n  pipes:\n"
         "    - {radius: 3 mm, length: 10 mm, particle_rate: 1000, speed: 0.5 m/s, stop: 120 ms,\n"
         "       transform: {rotation: [180 deg, 0 deg, 0 deg], translation: [0 mm, 0 mm, 30 mm]}}\n"
         "solids: [{name: floor, shape: {kind: plane, point: [0, 0, 0], normal: [0, 0, 1]}}]\n"
         "domain: {lower: [-60 mm, -60 mm, -10 mm], upper: [60 mm, 60 mm, 60 mm]}\n";
}

TEST(LiveChange, PipeGoesOnWhereItWasWhateverIsChanged) {
  Running r{read_scene_text(pipe_scene(), "pipe"), {}};
  r.world = build_world(r.scene, library());
  run_to(r.world, 50e-3);
  const int emitted = r.world.sources[0].emitted;
  EXPECT_NEAR(emitted, 50, 4);  // batches of 4 ms
  apply_change(r.scene, r.world, library(), {"air.humidity=30 %"});
  EXPECT_EQ(r.world.sources[0].emitted, emitted);
  EXPECT_EQ(r.world.sources[0].count, build_world(r.scene, library()).sources[0].count);
  run_to(r.world, 60e-3);
  EXPECT_NEAR(r.world.sources[0].emitted, 60, 4);
}

TEST(LiveChange, PipeOfAnotherRateEndsWhenItIsToEnd) {
  for (const Real rate : {250.0, 4000.0}) {
    Running r{read_scene_text(pipe_scene(), "pipe"), {}};
    r.world = build_world(r.scene, library());
    run_to(r.world, 50e-3);
    apply_change(r.scene, r.world, library(), {fmt::format("liquid.pipes[0].particle_rate={}", rate)});
    run_to(r.world, 200e-3);
    EXPECT_NEAR(r.world.sources[0].emitted, 50 + 70e-3 * rate, 4 + 1e-3 * 4 * rate) << rate;
    EXPECT_EQ(r.world.sources[0].emitted, r.world.sources[0].count) << rate;
    EXPECT_LT(mass_balance(r.world).error(), 1e-10);
  }
}

// Fibres that hold no liquid are conditioned; what the others hold stays; the air's account has the difference.
TEST(LiveChange, RegainConditionsTheFibresThatAreDry) {
  Running r = run_with({}, 20e-3);
  const Contents before = r.world.textiles[0].contents;
  const MassBalance was = mass_balance(r.world);
  for (const Real regain : {0.15, 0.0, 0.03}) {
    SCOPED_TRACE(regain);
    apply_change(r.scene, r.world, library(), {fmt::format("textiles[0].regain={} %", 100 * regain)});
    const Textile& textile = r.world.textiles[0];
    std::size_t dry = 0, wet = 0;
    for (std::size_t s = 0; s < textile.model->segments; ++s) {
      const bool holds = before.liquid_kg[s] > 0;
      ++(holds ? wet : dry);
      EXPECT_NEAR(textile.contents.sorbed_kg[s], holds ? before.sorbed_kg[s] : regain * textile.model->dry_mass(s), 1e-20);
    }
    EXPECT_GT(dry, 100u);
    EXPECT_GT(wet, 100u);
    const MassBalance is = mass_balance(r.world);
    EXPECT_EQ(is.free, was.free);
    EXPECT_EQ(is.yarn, was.yarn);
    EXPECT_EQ(is.supplied, was.supplied);
    EXPECT_NEAR(is.sorbed - was.sorbed, was.evaporated - is.evaporated, 1e-13 * is.initial);  // sums of 1e3 terms
    EXPECT_LT(is.error(), 1e-13);
  }
  run_to(r.world, 40e-3);
  EXPECT_LT(mass_balance(r.world).error(), 1e-10);
}

TEST(LiveChange, FibresConditionedDrySorbMoreOfTheLiquidThanDampOnes) {
  Real taken[2];
  for (const bool damp : {false, true}) {
    Running r = run_with({}, 10e-3);
    apply_change(r.scene, r.world, library(), {damp ? "textiles[0].regain=18 %" : "textiles[0].regain=0 %"});
    const Real before = mass_balance(r.world).sorbed;
    run_to(r.world, 40e-3);
    taken[damp] = mass_balance(r.world).sorbed - before;
  }
  EXPECT_GT(taken[0], 0);
  EXPECT_GT(taken[0], 1.5 * taken[1]);
}

TEST(LiveChange, RegainThatTheFibresCannotTakeFromTheAirIsRefused) {
  const std::string why = refusal("textiles[0].regain=60 %");
  EXPECT_NE(why.find("textiles[0].regain"), std::string::npos) << why;
  EXPECT_NE(why.find("saturated air"), std::string::npos) << why;
}

TEST(LiveChange, RegainSaidInTheSceneIsWhatTheFibresStartWith) {
  Scene scene = read_scene_text(small_scene, "small", {"textiles[0].regain=12 %", "textiles[0].weft.fibre=wool"});
  const World world = build_world(scene, library());
  const Textile& textile = world.textiles[0];
  Real dry = 0, water = 0;
  for (std::size_t s = 0; s < textile.model->segments; ++s)
    dry += textile.model->dry_mass(s), water += textile.contents.sorbed_kg[s];
  EXPECT_NEAR(water / dry, 0.12, 1e-13);
  EXPECT_DOUBLE_EQ(world.ledger.initial_kg, water);
  scene.textiles[0].regain = 0.6;
  EXPECT_THROW(build_world(scene, library()), InputError);
}

TEST(LiveChange, WhatAChangeLeavesAloneIsShared) {
  Running r = run_with({}, 5e-3);
  const Textile before = r.world.textiles[0];
  apply_change(r.scene, r.world, library(), {"air.humidity=20 %", "gravity=[0, 0, -5 m/s2]"});
  EXPECT_EQ(r.world.textiles[0].fabric, before.fabric);
  EXPECT_EQ(r.world.textiles[0].model, before.model);
  EXPECT_EQ(r.world.textiles[0].faces, before.faces);
  EXPECT_EQ(r.world.textiles[0].yarn_boxes, before.yarn_boxes);
  apply_change(r.scene, r.world, library(), {"textiles[0].contact_angle=40 deg"});
  EXPECT_NE(r.world.textiles[0].model, before.model);
  EXPECT_EQ(r.world.textiles[0].yarn_boxes, before.yarn_boxes);
}

TEST(LiveChange, WhatIsSharedEqualsWhatWouldBeBuiltAnew) {
  Running r = run_with({}, 10e-3);
  for (const std::vector<std::string>& changes :
       {std::vector<std::string>{"textiles[0].contact_angle=10 deg"}, {"textiles[0].contact_angle=80 deg"},
        {"textiles[0].receding_angle=5 deg"}, {"textiles[0].wetting.network.crossing_factor=1"},
        {"liquid.kind.viscosity=3 mPa.s"}, {"air.temperature=35 degC"}, {"textiles[0].warp.tortuosity_squared=6"}}) {
    SCOPED_TRACE(changes[0]);
    apply_change(r.scene, r.world, library(), changes);
    const World anew = build_world(r.scene, library());
    const WettingModel &model = *r.world.textiles[0].model, &built = *anew.textiles[0].model;
    EXPECT_TRUE(model.kinds == built.kinds && model.kind == built.kind);
    EXPECT_TRUE(model.links == built.links && model.row_start == built.row_start && model.row_other == built.row_other &&
                model.row_link == built.row_link && model.by_place == built.by_place);
    EXPECT_EQ(model.fibres[0].advancing_angle, built.fibres[0].advancing_angle);
    EXPECT_EQ(model.fibres[0].receding_angle, built.fibres[0].receding_angle);
    EXPECT_EQ(model.params.crossing_factor, built.params.crossing_factor);
    EXPECT_EQ(model.liquid.viscosity, built.liquid.viscosity);
    EXPECT_EQ(r.world.textiles[0].faces->cos_advancing, anew.textiles[0].faces->cos_advancing);
    EXPECT_EQ(r.world.textiles[0].faces->cos_receding, anew.textiles[0].faces->cos_receding);
  }
}

TEST(LiveChange, ReplayOfTheLogEndsInTheSameBits) {
  const std::vector<LoggedChange> changes{
      {.step = 10, .assignments = {"textiles[0].contact_angle=30 deg"}},
      {.step = 25, .assignments = {"air.humidity=10 %", "liquid.drops[1]={centre: [-3 mm, 2 mm, 1.2 mm], volume: 0.5 uL}"}},
      {.step = 40, .assignments = {"textiles[0].regain=14 %"}},
      {.step = 60, .assignments = {"duration=60 ms", "textiles[0].warp.fibre=wool"}},
      {.step = 110, .assignments = {}, .end = true}};
  const auto file = std::filesystem::temp_directory_path() / ("imbibe_changes_" + std::to_string(getpid()) + ".jsonl");
  std::ofstream out(file);
  for (const LoggedChange& change : changes) out << change_line(change);
  out.close();
  const World direct = run_with(changes).world, replayed = run_with(read_changes(file)).world;
  EXPECT_EQ(direct.step, 110u);
  EXPECT_EQ(state_hash(direct), state_hash(replayed));
  EXPECT_NE(state_hash(direct), state_hash(run_with({changes[0], changes[1], changes[2], changes[4]}).world));
  EXPECT_NE(state_hash(direct), state_hash(run_with({changes[0], changes[1], changes[3], changes[4]}).world));
  std::filesystem::remove(file);
}

TEST(LiveChange, LongerDurationGoesOnWhereTheRunEnded) {
  const World whole = run_with({}, 40e-3).world;
  const World longer = run_with({{.step = whole.step, .assignments = {"duration=50 ms"}}}).world;
  EXPECT_EQ(longer.time, 50e-3);
}

TEST(LiveChange, FibreWhoseYarnsDoNotFitTheWeaveIsRefused) {  // polypropylene is light: yarns of 20 tex are too thick
  EXPECT_NE(refusal("textiles[0].warp.fibre=polypropylene").find("density"), std::string::npos);
}

TEST(LiveChange, GeometryWaitsForARestart) {
  EXPECT_NE(refusal("textiles[0].size=[10 mm, 10 mm]").find("restart"), std::string::npos);
  EXPECT_NE(refusal("textiles[0].warp.density=20 /cm").find("restart"), std::string::npos);
  EXPECT_NE(refusal("liquid.particle_mass=0.1 mg").find("restart"), std::string::npos);
  EXPECT_NE(refusal("liquid.drops[0].volume=9 uL").find("restart"), std::string::npos);
  EXPECT_NE(refusal("textiles[0].wetting.network.sorption=shells").find("restart"), std::string::npos);
  EXPECT_NE(refusal("textiles[0].weave=/etc/passwd.wif").find("restart"), std::string::npos);
  EXPECT_NE(refusal("output.every=1 s").find("files"), std::string::npos);
}

TEST(LiveChange, AMapAroundSuchAKeyWaitsToo) {
  EXPECT_NE(refusal("liquid={kind: oil}").find("restart"), std::string::npos);
  EXPECT_NE(refusal("textiles=[]").find("restart"), std::string::npos);
  EXPECT_NE(refusal("textiles[0].warp={fibre: wool, density: 10 /cm, linear_density: 20 tex}").find("restart"),
            std::string::npos);
}

TEST(LiveChange, WrongValuesAreRefusedWithTheirRange) {
  EXPECT_NE(refusal("textiles[0].contact_angle=200 deg").find("180"), std::string::npos);
  EXPECT_NE(refusal("air.humidty=30 %").find("humidity"), std::string::npos);
  EXPECT_NE(refusal("textiles[0].warp.fibre=woll").find("wool"), std::string::npos);
  EXPECT_NE(refusal("liquid.drops[7]={centre: [0, 0, 1 cm], volume: 1 uL}").find("[7]"), std::string::npos);
  EXPECT_NE(refusal("rubbish"), "");
}

TEST(ReadChanges, SaysWhichLineIsWrong) {
  const auto file = std::filesystem::temp_directory_path() / ("imbibe_changes_bad_" + std::to_string(getpid()) + ".jsonl");
  std::ofstream(file) << "{\"step\": 5, \"set\": [\"air.humidity=30 %\"]}\nnonsense\n{\"step\": 4, \"set\": [\"a=1\"]}\n";
  try {
    read_changes(file);
    FAIL();
  } catch (const InputError& error) {
    ASSERT_EQ(error.problems().size(), 2u) << error.what();
    EXPECT_EQ(error.problems()[0].line, 2);
    EXPECT_EQ(error.problems()[1].line, 3);
  }
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace imbibe
