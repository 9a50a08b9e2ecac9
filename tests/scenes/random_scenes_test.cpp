// Random valid scenes, tiny, for 20 steps: whatever a scene may say, the books close, nothing is NaN and no saturation
// leaves its range. And scenes whose numbers are drawn from the whole of their described ranges: they are refused with
// reasons, fail as a numerical failure that says where, or run; nothing else.
// IMBIBE_RANDOM_SCENES sets how many of each (nightly: 1000).
#include <gtest/gtest.h>

#include <cstdlib>

#include <fmt/format.h>

#include "imbibe/core/error.h"
#include "imbibe/core/random.h"
#include "imbibe/sim/measures.h"
#include "scene/described_samples.h"
#include "support/scene_runs.h"

namespace imbibe {
namespace {

int scenes_wanted(int by_default) {
  const char* given = std::getenv("IMBIBE_RANDOM_SCENES");
  return given ? std::atoi(given) : by_default;
}

// Draws of one scene, by its number.
class Draw {
 public:
  explicit Draw(int scene) : scene_(static_cast<std::uint64_t>(scene)) {}
  Real between(Real low, Real high) { return low + (high - low) * uniform({.seed = 11, .id = scene_, .step = next_++}); }
  Real over_decades(Real low, Real high) { return std::exp(between(std::log(low), std::log(high))); }
  bool chance(Real share) { return between(0, 1) < share; }
  template <std::size_t n>
  const char* one_of(const char* const (&words)[n]) {
    return words[static_cast<std::size_t>(between(0, static_cast<Real>(n)))];
  }

 private:
  std::uint64_t scene_, next_ = 0;
};

const char* const fibres[] = {"cotton", "cotton_raw", "wool", "wool_shrinkproof", "polyester", "polypropylene", "viscose", "linen", "nylon66", "silk", "acrylic"};
const char* const liquids[] = {"water", "saline_9gl", "ethanol_25", "ethanol_96", "light_oil", "sweat"};
const char* const weaves[] = {"plain", "twill 2/1", "twill 1/3", "satin 5/2", "basket 2/2"};

std::string random_yarn(Draw& draw) {
  const Real per_cm = draw.between(8, 18);
  return fmt::format("{{fibre: {}, diameter: {:.4g} mm, density: {:.4g} /cm{}}}", draw.one_of(fibres),
                     draw.between(0.3, 0.95) * 10 / per_cm / 1.7, per_cm, draw.chance(0.15) ? ", monofilament: true" : "");
}

// A cloth of some 5 x 5 to 12 x 12 yarns under one or two drops, sometimes over a plane or a ball.
std::string random_scene(Draw& draw) {
  const Real size = draw.between(4, 7), volume = draw.between(0.5, 3);  // mm, uL
  const Real radius = std::cbrt(3 * volume / (4 * pi));                  // mm
  std::string text = fmt::format("version: 1\nduration: 1 s\nseed: {}\nair: {{temperature: {:.3g} degC, humidity: {:.3g} %}}\n",
                                 static_cast<int>(draw.between(0, 1e6)), draw.between(5, 45), draw.between(0, 100));
  if (draw.chance(0.2)) text += fmt::format("gravity: [{:.3g}, {:.3g}, {:.3g}]\n", draw.between(-3, 3), draw.between(-3, 3), draw.between(-12, 3));
  text += fmt::format("liquid:\n  kind: {}\n  particle_mass: {:.4g} mg\n  drops:\n", draw.one_of(liquids), volume / draw.between(60, 200));
  text += fmt::format("    - {{centre: [{:.3g} mm, {:.3g} mm, {:.4g} mm], volume: {:.4g} uL, velocity: [{:.3g}, {:.3g}, {:.3g}]}}\n",
                      draw.between(-1, 1), draw.between(-1, 1), radius + draw.between(0.7, 1.2), volume, draw.between(-0.3, 0.3),
                      draw.between(-0.3, 0.3), -draw.over_decades(0.01, 3));
  if (draw.chance(0.3))
    text += fmt::format("    - {{centre: [0, 0, {:.4g} mm], volume: {:.4g} uL, start: {:.3g} ms}}\n", 6 + 2 * radius, volume / 2, draw.between(0, 4));
  text += fmt::format("textiles:\n  - size: [{:.4g} mm, {:.4g} mm]\n    weave: {}\n    warp: {}\n    weft: {}\n", size, draw.between(4, 7),
                      draw.one_of(weaves), random_yarn(draw), random_yarn(draw));
  if (draw.chance(0.3)) text += fmt::format("    contact_angle: {:.3g} deg\n    receding_angle: 0 deg\n", draw.between(0, 150));
  if (draw.chance(0.3))
    text += fmt::format("solids:\n  - {{shape: {{kind: plane, point: [0, 0, {:.3g} mm], normal: [0, 0, 1]}}, contact_angle: {:.3g} deg}}\n",
                        -draw.between(2, 5), draw.between(10, 160));
  return text;
}

const Library& library() {
  static const Library all = read_library({std::filesystem::path(IMBIBE_SOURCE_DIR)});
  return all;
}

// What must hold after every step of whatever scene.
void expect_sound(const World& world) {
  ASSERT_LE(mass_balance(world).error(), 1e-10);  // the bound; sums of a few thousand terms round to 1e-13
  for (const Float4& x : world.liquid.particles.position) ASSERT_TRUE(std::isfinite(x.x + x.y + x.z));
  for (const Float4& u : world.liquid.particles.velocity) ASSERT_TRUE(std::isfinite(u.x + u.y + u.z));
  for (const Textile& textile : world.textiles) {
    for (std::size_t k = 0; k < textile.fabric->network.nodes(); ++k) {
      const Real s = saturation(*textile.model, textile.contents, k);
      ASSERT_GE(s, -1e-30);  // an emptied node keeps the rounding of its last flow
      ASSERT_LE(s, 1 + textile.model->overfill(k) * (1 + 1e-6) + 1e-9);
    }
    for (const Real kg : textile.contents.sorbed_kg) ASSERT_TRUE(std::isfinite(kg) && kg >= 0);
  }
}

TEST(RandomScenes, OfEveryKindKeepTheirBooksAndBoundsForTwentySteps) {
  int ran = 0, took_up = 0, refused = 0;
  for (int k = 0; k < scenes_wanted(100); ++k) {
    Draw draw(k);
    const std::string text = random_scene(draw);
    SCOPED_TRACE(fmt::format("scene {}\n{}", k, text));
    World world;
    try {
      world = build_world(read_scene_text(text, "random.yaml"), library());
    } catch (const InputError& error) {  // such as yarns too thick for their weave: a reason must be given
      ASSERT_FALSE(std::string(error.what()).empty());
      ++refused;
      continue;
    }
    StepScratch scratch;
    // Half of them make all steps alone on the network once the drop has come down.
    for (int i = 0; i < 20; ++i) {
      step(world, {.until = 1}, scratch);
      ASSERT_NO_FATAL_FAILURE(expect_sound(world)) << "step " << i;
    }
    ++ran;
    const MassBalance b = mass_balance(world);
    took_up += b.yarn + b.pore > 0;
  }
  // Most draws are valid, or the test looks at nothing.
  EXPECT_GT(ran, 3 * refused) << refused << " of " << ran + refused << " were refused";
  EXPECT_GT(took_up, 0);
}

// Every described number anywhere in its range, on top of a tiny scene: models, solver, air, measures, limits.
TEST(RandomParameters, WithinTheirDescribedRangesNeverCrash) {
  int ran = 0, refused = 0, failed = 0;
  for (int k = 0; k < scenes_wanted(20); ++k) {
    Scene scene = test::small_drop({"liquid.particle_mass=0.1 mg", "textiles[0].size=[4 mm, 4 mm]"});
    test::RandomFiller filler(static_cast<std::uint64_t>(k));
    // One part at a time, or nearly all draws would be refused for one key of many.
    switch (k % 5) {
      case 0: describe(filler, scene.liquid.solver); break;
      case 1: describe(filler, scene.textiles[0].wetting.network); break;
      case 2: describe(filler, scene.textiles[0].contact); break;
      case 3: describe(filler, scene.air); break;
      default: describe(filler, scene.liquid.kind); break;
    }
    SCOPED_TRACE(fmt::format("parameters {}\n{}", k, write_scene(scene)));
    try {
      World world = build_world(scene, library());
      StepScratch scratch;
      for (int i = 0; i < 20; ++i) {
        step(world, {.until = 0.1}, scratch);
        ASSERT_LE(mass_balance(world).error(), 1e-10);
      }
      ++ran;
    } catch (const InputError& error) {
      ASSERT_FALSE(std::string(error.what()).empty());
      ++refused;
    } catch (const NumericalError& error) {
      ASSERT_FALSE(error.where.empty());
      ++failed;
    }
  }
  EXPECT_GT(ran, 0);
  RecordProperty("ran", ran), RecordProperty("refused", refused), RecordProperty("failed", failed);
}

}  // namespace
}  // namespace imbibe
