// What a run was made on, for run.json: a timing means nothing without it. No names of users, hosts or folders.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace imbibe {

struct Machine {
  std::string processor;  // model name
  int cores = 0;
  std::uint64_t memory_bytes = 0;
  std::string system;     // kernel and architecture
  std::string compiler;
};

Machine this_machine();

// bytes of memory that this program occupies now; 0 where the system does not say.
double memory_in_use();

// bytes that the file system of `folder`, or of the nearest folder above it that exists, still takes; infinity where
// the system does not say.
double free_space(const std::filesystem::path& folder);

}  // namespace imbibe
