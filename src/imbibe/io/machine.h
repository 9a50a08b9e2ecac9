// What a run was made on, for run.json: a timing means nothing without it. No names of users, hosts or folders.
#pragma once

#include <cstdint>
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

}  // namespace imbibe
