#include "imbibe/sim/checkpoint.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <limits>

#include "imbibe/core/error.h"
#include "imbibe/core/output_file.h"
#include "imbibe/core/random.h"
#include "imbibe/sim/state_fields.h"
#include "imbibe/sim/state_hash.h"
#include "io/limited_file_size.h"
#include "io/temporary_folder.h"

namespace imbibe {
namespace {

using testing::TemporaryFolder;
using testing::text_of;

// Gives every field of the state a value of its own, arrays `length` long unless they have a length already.
class FillVisitor {
 public:
  explicit FillVisitor(std::size_t length) : length_(length) {}
  void group(const std::string&) {}
  template <class T>
  void value(const char*, T& x) {
    fill(x);
  }
  template <class T>
  void array(const char*, std::vector<T>& x) {
    if (x.empty()) x.resize(length_);
    for (T& item : x) fill(item);
  }

 private:
  Real next() { return uniform({.seed = 5, .id = counter_++}); }
  template <class T>
    requires std::is_arithmetic_v<T>
  void fill(T& x) {
    if constexpr (std::is_same_v<T, bool>) {
      x = true;
      return;
    }
    x = std::is_integral_v<T> ? static_cast<T>(1 + counter_++) : static_cast<T>(next());
  }
  void fill(ParticleClass& x) { x = static_cast<ParticleClass>(counter_++ % 3); }
  void fill(Vec3& p) { p = {next(), next(), next()}; }
  void fill(Float4& p) {
    p = {static_cast<float>(next()), static_cast<float>(next()), static_cast<float>(next()),
         static_cast<float>(next())};
  }

  std::size_t length_;
  std::uint64_t counter_ = 0;
};

// Two textiles of different size, one source; nothing in it is zero.
World built_world() {
  World world;
  world.sources.resize(1);
  world.textiles.resize(2);
  world.textiles[0].name = "swatch/upper";
  world.textiles[1].name = "lower";
  for (std::size_t i = 0; i < 2; ++i) {
    Contents& contents = world.textiles[i].contents;
    contents.sorbed_kg.resize(20 + i);
    contents.liquid_kg.resize(30 + i);
  }
  world.textiles[1].contents.shell_regain.resize(21 * 12);
  world.textiles[0].contents.reached_saturation.resize(30);
  for (std::size_t i = 0; i < 2; ++i) {
    world.textiles[i].exchange.waiting_kg.resize(30 + i);
  }
  world.liquid.particle_mass = 2.05e-7;
  return world;
}

World filled_world(std::size_t particles = 1000) {
  World world = built_world();
  // Arrays that stay empty in this world must not be filled.
  FillVisitor fill(particles);
  const auto shells = world.textiles[0].contents.shell_regain;
  const auto reached = world.textiles[1].contents.reached_saturation;
  const Real mass = world.liquid.particle_mass;
  visit_state(fill, world);
  world.textiles[0].contents.shell_regain = shells;
  world.textiles[1].contents.reached_saturation = reached;
  world.liquid.particle_mass = mass;
  world.sources[0].carried = 1e-13;  // m3, less than a particle
  world.air.temperature = 301;
  return world;
}

// A structure of the state that grew: visit its new field in state_fields.h, then correct the size here. (The sizes hold
// for the platform the program is for.)
static_assert(sizeof(Air) == 3 * 8 && sizeof(Ledger) == 4 * 8 && sizeof(Pace) == 14 * 8);
static_assert(sizeof(Particles) == 9 * sizeof(std::vector<int>) && sizeof(Contents) == 4 * sizeof(std::vector<int>));
static_assert(sizeof(ExchangeState) == 1 * sizeof(std::vector<int>) + 8 * 8);

// Makes the smallest change to one field of the state, by its number.
class PokeVisitor {
 public:
  explicit PokeVisitor(int target) : target_(target) {}
  void group(const std::string& name) { group_ = name; }
  template <class T>
  void value(const char* name, T& x) {
    if (counter_++ == target_) poke(name, x);
  }
  template <class T>
  void array(const char* name, std::vector<T>& x) {
    if (counter_++ == target_) {
      if (x.empty()) {
        x.resize(1);
        poked = group_ + "/" + name;
      } else {
        poke(name, x.back());
      }
    }
  }
  std::string poked;

 private:
  template <class T>
  void poke(const char* name, T& x) {
    reinterpret_cast<unsigned char*>(&x)[0] ^= 1;  // the smallest change of the first component
    poked = group_ + "/" + name;
  }
  std::string group_;
  int target_, counter_ = 0;
};

TEST(StateHash, changes_with_the_smallest_change_of_any_field) {
  const World world = filled_world();
  const std::uint64_t hash = state_hash(world);
  EXPECT_EQ(state_hash(World(world)), hash);
  int fields = 0;
  for (;; ++fields) {
    World changed = world;
    PokeVisitor poke(fields);
    visit_state(poke, changed);
    if (poke.poked.empty()) break;
    EXPECT_NE(state_hash(changed), hash) << poke.poked;
  }
  EXPECT_GT(fields, 40);
}

TEST(StateHash, does_not_depend_on_the_scratch_of_particle_records) {
  World world = filled_world();
  const std::uint64_t hash = state_hash(world);
  world.liquid.particles.position[3].w += 1;
  EXPECT_EQ(state_hash(world), hash);
}

TEST(Checkpoint, gives_every_bit_of_the_state_back) {
  const TemporaryFolder folder;
  const World world = filled_world();
  write_checkpoint(folder / "c.h5", world);
  World read = built_world();
  ASSERT_NE(state_hash(read), state_hash(world));
  read_checkpoint(folder / "c.h5", read);
  EXPECT_EQ(state_hash(read), state_hash(world));
  // The hash leaves scratch out; the checkpoint does not.
  ASSERT_EQ(read.liquid.particles.size(), world.liquid.particles.size());
  EXPECT_EQ(std::memcmp(read.liquid.particles.position.data(), world.liquid.particles.position.data(),
                        world.liquid.particles.size() * sizeof(Float4)),
            0);
  EXPECT_EQ(read.textiles[0].name, "swatch/upper");
}

// Puts NaN into a field of real numbers, by its number.
class NanVisitor {
 public:
  explicit NanVisitor(int target) : target_(target) {}
  void group(const std::string& name) { group_ = name; }
  template <class T>
  void value(const char* name, T& x) {
    if (counter_++ == target_) put(name, x);
  }
  template <class T>
  void array(const char* name, std::vector<T>& x) {
    if (counter_++ == target_ && !x.empty()) put(name, x.back());
  }
  int fields() const { return counter_; }
  std::string changed;

 private:
  template <class T>
  void put(const char* name, T& x) {
    if constexpr (std::is_floating_point_v<T>) x = std::numeric_limits<T>::quiet_NaN(), changed = group_ + "/" + name;
    else if constexpr (requires { x.y; }) x.y = std::numeric_limits<Real>::quiet_NaN(), changed = group_ + "/" + name;
  }
  std::string group_;
  int target_, counter_ = 0;
};

TEST(Checkpoint, with_no_number_in_any_field_is_refused_by_that_field) {
  const TemporaryFolder folder;
  const World world = filled_world(10);
  NanVisitor none(-1);
  World counted = world;
  visit_state(none, counted);
  int real_fields = 0;
  for (int field = 0; field < none.fields(); ++field) {
    World changed = world;
    NanVisitor visitor(field);
    visit_state(visitor, changed);
    if (visitor.changed.empty()) continue;
    ++real_fields;
    write_checkpoint(folder / "c.h5", changed);
    World read = built_world();
    try {
      read_checkpoint(folder / "c.h5", read);
      ADD_FAILURE() << visitor.changed << " was NaN and is read";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(visitor.changed == "liquid/particle_mass" ? "another scene" : visitor.changed),
                std::string::npos)
          << visitor.changed << ": " << error.what();
    }
  }
  EXPECT_GT(real_fields, 40);
}

TEST(Checkpoint, with_numbers_that_no_run_comes_to_is_refused) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& words, const auto& change) {
    World world = filled_world(10);
    change(world);
    write_checkpoint(folder / "c.h5", world);
    World read = built_world();
    try {
      read_checkpoint(folder / "c.h5", read);
      ADD_FAILURE() << "read: " << words;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  };
  refused("out of reach", [](World& w) { w.liquid.particles.position[3].x = 1e6f; });
  refused("too fast", [](World& w) { w.liquid.particles.velocity[3].z = -3e4f; });
  refused("owes more", [](World& w) { w.liquid.particles.owed_kg[3] = 1e6; });
  refused("waits on a face", [](World& w) { w.textiles[1].exchange.waiting_kg[3] = -1e6; });
  refused("humidity", [](World& w) { w.air.humidity = 2; });
  refused("degC", [](World& w) { w.air.temperature = 20; });
  refused("gravity", [](World& w) { w.gravity = {0, 0, -1e4}; });
  refused("time", [](World& w) { w.time = -1; });
}

TEST(Checkpoint, of_a_world_without_liquid_and_textiles_is_read_back) {
  const TemporaryFolder folder;
  World world;
  world.time = 1.5;
  write_checkpoint(folder / "c.h5", world);
  World read;
  read_checkpoint(folder / "c.h5", read);
  EXPECT_EQ(state_hash(read), state_hash(world));
}

TEST(Checkpoint, that_was_cut_at_any_place_is_refused_and_leaves_the_world_alone) {
  const TemporaryFolder folder;
  write_checkpoint(folder / "c.h5", filled_world(50));
  const std::string whole = text_of(folder / "c.h5");
  World read = built_world();
  const std::uint64_t before = state_hash(read);
  for (const std::size_t bytes : {std::size_t{0}, std::size_t{10}, std::size_t{511}, std::size_t{512},
                                  std::size_t{700}, whole.size() / 2, whole.size() - 1}) {
    write_whole_file(folder / "cut.h5", whole.substr(0, bytes));
    EXPECT_THROW(read_checkpoint(folder / "cut.h5", read), InputError) << bytes << " bytes";
    EXPECT_EQ(state_hash(read), before);
  }
}

TEST(Checkpoint, with_one_bit_flipped_anywhere_is_refused) {
  const TemporaryFolder folder;
  write_checkpoint(folder / "c.h5", filled_world(50));
  const std::string whole = text_of(folder / "c.h5");
  World read = built_world();
  for (std::size_t i = 0; i < 200; ++i) {
    std::string damaged = whole;
    const std::size_t at = 512 + random_bits({.seed = 9, .id = i}) % (whole.size() - 512);
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << (i % 8)));
    write_whole_file(folder / "damaged.h5", damaged);
    EXPECT_THROW(read_checkpoint(folder / "damaged.h5", read), InputError) << "byte " << at;
  }
}

TEST(Checkpoint, of_another_format_version_or_kind_of_file_is_refused_by_name) {
  const TemporaryFolder folder;
  write_checkpoint(folder / "c.h5", World{});
  std::string whole = text_of(folder / "c.h5");
  const std::string version = fmt::format("version {}", checkpoint_version);
  whole.replace(whole.find(version), version.size(), "version 9");
  write_whole_file(folder / "new.h5", whole);
  World read;
  try {
    read_checkpoint(folder / "new.h5", read);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("format 9"), std::string::npos) << error.what();
  }
  write_whole_file(folder / "text.h5", std::string(2000, 'x'));
  EXPECT_THROW(read_checkpoint(folder / "text.h5", read), InputError);
  EXPECT_THROW(read_checkpoint(folder / "none.h5", read), InputError);
}

// A seed of an older format is refused at its first line: the search would never come to the rest.
TEST(Checkpoint, the_seed_of_the_fuzz_target_has_the_present_format) {
  const std::string seed = text_of(IMBIBE_SOURCE_DIR "/fuzz/corpus/checkpoint/file");
  EXPECT_EQ(seed.find(fmt::format("fimbibe checkpoint\nversion {}\n", checkpoint_version)), 0u)
      << "make it anew: an `f`, then the file that fuzz/checkpoint_fuzz.cpp writes for the input `c`";
}

TEST(Checkpoint, of_another_scene_is_refused_with_every_difference) {
  const TemporaryFolder folder;
  write_checkpoint(folder / "c.h5", filled_world());
  World other = built_world();
  other.liquid.particle_mass = 1e-7;
  other.textiles[1].contents.liquid_kg.resize(99);
  try {
    read_checkpoint(folder / "c.h5", other);
    FAIL();
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("particle mass"), std::string::npos) << text;
    EXPECT_NE(text.find("textile 'lower': number of nodes is 31, the scene has 99"), std::string::npos) << text;
  }
  other = built_world();
  other.textiles.pop_back();
  EXPECT_THROW(read_checkpoint(folder / "c.h5", other), InputError);
}

TEST(Checkpoint, of_a_source_that_owes_what_no_rounding_leaves_is_refused) {
  const TemporaryFolder folder;
  for (const Real carried : {1e255, -1.0, std::nan("")}) {
    World world = filled_world(), read = built_world();
    world.sources[0].carried = carried;
    write_checkpoint(folder / "c.h5", world);
    EXPECT_THROW(read_checkpoint(folder / "c.h5", read), InputError) << carried;
  }
}

TEST(Checkpoint, of_textiles_not_stepped_for_longer_than_any_run_leaves_them_is_refused) {
  const TemporaryFolder folder;
  for (const Real since : {3.5e30, -1.0, std::nan("")}) {  // the first was a finding of the fuzzer: 50,000 steps of 300 s
    World world = filled_world(), read = built_world();
    world.pace.since_wetting = since;
    write_checkpoint(folder / "c.h5", world);
    EXPECT_THROW(read_checkpoint(folder / "c.h5", read), InputError) << since;
  }
}

TEST(Checkpoint, that_does_not_fit_on_the_disk_leaves_the_last_one_intact) {
  const TemporaryFolder folder;
  World world = filled_world(100);
  world.step = 10;
  const auto first = save_checkpoint(folder.path(), world);
  World larger = filled_world(100000);
  larger.step = 20;
  {
    const testing::LimitedFileSize limit(200000);
    EXPECT_THROW(save_checkpoint(folder.path(), larger), OutputError);
  }
  EXPECT_EQ(list_checkpoints(folder.path()), std::vector<std::filesystem::path>{first});
  World read = built_world();
  EXPECT_EQ(read_newest_checkpoint(folder.path(), read), first);
  EXPECT_EQ(state_hash(read), state_hash(world));
}

TEST(Checkpoint, the_newest_two_are_kept_and_a_damaged_one_is_passed_over) {
  const TemporaryFolder folder;
  World world = filled_world(10);
  EXPECT_EQ(read_newest_checkpoint(folder.path(), world), std::nullopt);
  for (const std::uint64_t step : {5u, 90u, 1000u, 2000000000u}) {
    world.step = step;
    save_checkpoint(folder.path(), world);
  }
  const auto kept = list_checkpoints(folder.path());
  ASSERT_EQ(kept.size(), 2u);
  World read = built_world();
  read_newest_checkpoint(folder.path(), read);
  EXPECT_EQ(read.step, 2000000000u);

  std::filesystem::resize_file(kept.back(), 1000);
  std::vector<std::string> passed_over;
  EXPECT_EQ(read_newest_checkpoint(folder.path(), read, &passed_over), kept.front());
  EXPECT_EQ(read.step, 1000u);
  EXPECT_EQ(passed_over.size(), 1u);

  std::filesystem::resize_file(kept.front(), 1000);
  EXPECT_THROW(read_newest_checkpoint(folder.path(), read), InputError);
}

}  // namespace
}  // namespace imbibe
