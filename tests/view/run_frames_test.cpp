#include "imbibe/view/run_frames.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "imbibe/core/error.h"
#include "imbibe/io/run_folder.h"
#include "imbibe/scene/builder.h"
#include "imbibe/scene/library.h"
#include "imbibe/scene/scene.h"
#include "imbibe/sim/measures.h"
#include "imbibe/view/frame_from_world.h"

namespace imbibe {
namespace {

namespace fs = std::filesystem;

World small_world() {
  const Scene scene = read_scene_text(R"(
version: 1
title: Frames
duration: 1 s
liquid: {kind: water, particle_mass: 0.03 mg}
textiles:
  - name: a swatch
    size: [6 mm, 5 mm]
    weave: plain
    warp: {fibre: cotton, linear_density: 20 tex, density: 20 /cm}
    weft: {fibre: cotton, linear_density: 30 tex, density: 18 /cm}
solids:
  - {name: ball, shape: {kind: sphere, centre: [0, 0, -5 mm], radius: 2 mm}}
)", "frames.yaml");
  World world = build_world(scene, read_library({fs::path(IMBIBE_SOURCE_DIR)}));
  world.time = 0.25;
  for (std::size_t i = 0; i < world.textiles[0].contents.liquid_kg.size(); i += 3)
    world.textiles[0].contents.liquid_kg[i] = 1e-9 * static_cast<Real>(i % 7);
  for (int i = 0; i < 10; ++i) {
    const float x = 1e-4f * static_cast<float>(i);
    world.liquid.particles.position.push_back({x, 2 * x, 1e-3f, 0});
    world.liquid.particles.velocity.push_back({});
    world.liquid.particles.id.push_back(static_cast<Index>(i));
    world.liquid.particles.kind.push_back(ParticleClass::inside);
    world.liquid.particles.density.push_back(998);
    world.liquid.particles.pressure.push_back(0);
  }
  return world;
}

class RunFramesTest : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::path(testing::TempDir()) / (std::string("imbibe_frames_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }

  void write(const World& world) const {
    const Textile& textile = world.textiles[0];
    write_vtp(folder / "liquid_000000.vtp", liquid_poly_data(world.liquid), {world.time, 0});
    write_pvd(folder / "liquid.pvd", {{world.time, "liquid_000000.vtp"}});
    write_vtp(folder / "textile_a_swatch_000000.vtp", textile_poly_data(textile, node_saturations(textile, world.air)), {world.time, 0});
    write_pvd(folder / "textile_a_swatch.pvd", {{world.time, "textile_a_swatch_000000.vtp"}});
  }
  fs::path folder;
};

TEST_F(RunFramesTest, AFrameFromTheFilesIsTheFrameOfTheWorld) {
  const World world = small_world();
  write(world);
  const RunFrames run = open_run_frames(folder, world, "Frames");
  ASSERT_EQ(run.times, std::vector<Real>{0.25});
  const Frame read = read_frame(run, 0), living = frame_from_world(world, "Frames");
  EXPECT_EQ(read.time, living.time);
  EXPECT_EQ(read.title, living.title);
  EXPECT_EQ(read.yarns.points, living.yarns.points);
  EXPECT_EQ(read.yarns.saturation, living.yarns.saturation);
  EXPECT_EQ(read.yarns.radius, living.yarns.radius);
  EXPECT_EQ(read.particles, living.particles);
  EXPECT_EQ(read.particle_spacing, living.particle_spacing);
  EXPECT_EQ(read.solids.size(), 1u);
  EXPECT_GT(*std::max_element(read.yarns.saturation.begin(), read.yarns.saturation.end()), 0);
}

TEST_F(RunFramesTest, AFolderWithoutOutputIsRefused) {
  EXPECT_THROW(open_run_frames(folder, small_world(), ""), InputError);
}

TEST_F(RunFramesTest, AFileThatLeadsOutOfTheFolderIsNotFollowed) {
  const World world = small_world();
  write(world);
  write_pvd(folder / "liquid.pvd", {{world.time, "../liquid_000000.vtp"}});
  EXPECT_THROW(read_frame(open_run_frames(folder, world, ""), 0), InputError);
}

TEST_F(RunFramesTest, AnotherScenesClothIsRefused) {
  const World world = small_world();
  write(world);
  write_vtp(folder / "textile_a_swatch_000000.vtp", PolyData{}, {});
  EXPECT_THROW(read_frame(open_run_frames(folder, world, ""), 0), InputError);
}

}  // namespace
}  // namespace imbibe
