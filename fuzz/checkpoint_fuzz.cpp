// Checkpoints. First byte 'f': the rest is a file as it lies on a disk. Otherwise the rest changes fields of a sound
// state - lengths of arrays, numbers, also to NaN and infinity - which is then written and read with a right checksum:
// what the checksum cannot catch; first byte 's': of a soft cloth of cells and a soft woven one. (Damage behind a right checksum inside HDF5's own structures is not made here: it
// cannot come from a disk, and HDF5 is not made for hostile files.)
#include <cstring>

#include "fuzz.h"
#include "imbibe/core/output_file.h"
#include "imbibe/scene/builder.h"
#include "imbibe/scene/library.h"
#include "imbibe/sim/checkpoint.h"
#include "imbibe/sim/state_fields.h"
#include "imbibe/sim/state_hash.h"
#include "imbibe/sim/step.h"

using namespace imbibe;

namespace {

World world_of(const char* text) {
  World built = build_world(read_scene_text(text, "small.yaml"), read_library({IMBIBE_SOURCE_DIR}));
  emit_due(built);
  return built;
}

const World& small_world() {
  static const World world = world_of(
      "version: 1\nduration: 1 s\nliquid: {kind: water, particle_mass: 0.1 mg, drops: [{centre: [0, 0, 1 mm], volume: "
      "1 uL}]}\ntextiles: [{size: [3 mm, 3 mm], warp: {fibre: cotton, diameter: 0.3 mm, density: 10 /cm}, "
      "weft: {fibre: cotton, diameter: 0.3 mm, density: 10 /cm}}]\n");
  return world;
}

// Both cloths a little on their way.
const World& soft_world() {
  static const World world = [] {
    World w = world_of(
        "version: 1\nduration: 1 s\nliquid: {kind: water, particle_mass: 0.1 mg, drops: [{centre: [0, 0, 1 mm], volume: 1 uL}]}\n"
        "textiles:\n"
        "  - {name: net, size: [3 mm, 3 mm], warp: {fibre: cotton, diameter: 0.3 mm, density: 10 /cm}, weft: {fibre: cotton, diameter: "
        "0.3 mm, density: 10 /cm}, sheet: {soft: {columns: 4, rows: 4, preset: silk, pins: [{corner: top_left}]}}}\n"
        "  - {name: cells, size: [3 mm, 3 mm], areal_mass: 150 g/m2, centre: [0, 0, -3 mm], wetting: {cells: {capacity_ratio: 3}}, "
        "sheet: {soft: {columns: 4, rows: 4, pins: [{corner: top_left}]}}}\n");
    StepScratch scratch;
    for (int k = 0; k < 20; ++k) step(w, {.until = 0.1}, scratch);
    for (int k = 0; k < 3; ++k) {
      CellCloth& cloth = w.cell_cloths[0];
      const Vec3 at = cloth.grid->centre(5 + k);
      add_parcel(*cloth.grid, cloth.contents, at.x, at.y, 1e-7);
      w.ledger.initial_kg += 1e-7;
    }
    return w;
  }();
  return world;
}

// Takes four bytes for each change: field, place and eight more for the value.
class Change {
 public:
  Change(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  void group(const std::string&) {}
  template <class T>
  void value(const char*, T& x) {
    if (mine()) put(x);
  }
  template <class T>
  void array(const char*, std::vector<T>& x) {
    if (!mine()) return;
    if (size_ < 14) {
      x.resize(x.size() + (place_ % 5) - 2 < 1000000 ? x.size() + (place_ % 5) - 2 : 0);
    } else if (!x.empty()) {
      put(x[place_ % x.size()]);
    }
  }
  bool next() {
    if (size_ < 4) return false;
    field_ = 0;
    wanted_ = data_[0];
    place_ = static_cast<std::size_t>(data_[1]) * 256 + data_[2];
    const std::size_t step = std::min<std::size_t>(size_, 12);
    std::memcpy(bytes_, data_ + step - std::min<std::size_t>(step, 8), std::min<std::size_t>(step, 8));
    data_ += step, size_ -= step;
    return true;
  }

 private:
  bool mine() { return field_++ == wanted_; }
  template <class T>
  void put(T& x) {
    if constexpr (std::is_same_v<T, bool>) x = (bytes_[0] & 1) != 0;
    else if constexpr (std::is_same_v<T, ParticleClass>) x = static_cast<ParticleClass>(bytes_[0] % 3);
    else if constexpr (std::is_trivially_copyable_v<T>) std::memcpy(static_cast<void*>(&x), bytes_, std::min(sizeof x, sizeof bytes_));
  }
  const std::uint8_t* data_;
  std::size_t size_;
  int wanted_ = 0, field_ = 0;
  std::size_t place_ = 0;
  std::uint8_t bytes_[8] = {};
};

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const World& start = data[0] == 's' ? soft_world() : small_world();
  World read = start;
  if (data[0] == 'f') {
    const fuzz::MemoryFile file(fuzz::text_of(data + 1, size - 1));
    fuzz::reads([&] { read_checkpoint(file.path(), read); });
    return 0;
  }
  World changed = start;
  Change change(data + 1, size - 1);
  while (change.next()) visit_state(change, changed);
  static const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("imbibe_fuzz_" + std::to_string(::getpid()) + ".h5");
  write_checkpoint(path, changed);
  if (!fuzz::reads([&] { read_checkpoint(path, read); })) return 0;
  IMBIBE_ASSERT(state_hash(read) == state_hash(changed));
  StepScratch scratch;
  StepOptions options;
  options.until = read.time + 1e-3;
  try {
    if (options.until > read.time) step(read, options, scratch);
  } catch (const NumericalError&) {  // no sound state, and it says so
  }
  return 0;
}
