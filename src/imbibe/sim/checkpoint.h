// Checkpoints: the state of a World in one HDF5 file, so that a run goes on after a stop as if it had not stopped.
//
// The file: a 512-byte user block (which h5dump and h5py skip) with format version, length and a 64-bit checksum of all
// that follows, then an HDF5 file with one data set per field of sim/state_fields.h, by the same names. The checksum is
// verified before the HDF5 library sees a byte, so that a damaged file cannot lead it astray.
// What the scene builds (fabrics, models, solids, parameters) is not stored: the caller builds the World from
// scene.yaml, then reads. Written beside its place and renamed. Tested in tests/sim/checkpoint_test.cpp.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "imbibe/sim/world.h"

namespace imbibe {

inline constexpr int checkpoint_version = 4;

// Throws OutputError when the disk will not take it; an older checkpoint of that name then stays.
void write_checkpoint(const std::filesystem::path& path, const World& world);

// Replaces the state of `built`, which must be of the same scene: as many textiles of the same size, as many sources,
// the same particle mass. Throws InputError with every mismatch, or when the file is damaged; `built` is then
// unchanged.
void read_checkpoint(const std::filesystem::path& path, World& built);

// checkpoint_<step>.h5 in `folder`, oldest first.
std::vector<std::filesystem::path> list_checkpoints(const std::filesystem::path& folder);

// Writes checkpoint_<step>.h5 into `folder`, then removes all but the newest `keep`.
std::filesystem::path save_checkpoint(const std::filesystem::path& folder, const World& world, int keep = 2);

// Reads the newest checkpoint that is sound; damaged ones are passed over and named in `passed_over`.
// Empty: there is none. Throws InputError when there are some but none is sound.
std::optional<std::filesystem::path> read_newest_checkpoint(const std::filesystem::path& folder, World& built,
                                                            std::vector<std::string>* passed_over = nullptr);

}  // namespace imbibe
