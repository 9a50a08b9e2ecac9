// What every fuzz target shares. A target gives bytes to one reader: an InputError or a QuantityError is a good end, all
// else that leaves the reader (another exception, a failed assertion, a sanitizer's report, a hang) is a finding.
// Built with clang's libFuzzer (IMBIBE_FUZZ) to search, and with fuzz/replay.cpp as an ordinary test that goes through
// fuzz/corpus and fuzz/findings.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "imbibe/core/error.h"
#include "imbibe/core/quantity.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace imbibe::fuzz {

template <class Body>
bool reads(Body&& body) {
  try {
    body();
    return true;
  } catch (const InputError& error) {
    IMBIBE_ASSERT(!error.problems().empty() && !std::string(error.what()).empty());
  } catch (const QuantityError&) {
  }
  return false;
}

inline std::string text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

// A file in memory with a path, for readers that want one.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view content) : file_(memfd_create("fuzz", 0)) {
    IMBIBE_ASSERT(file_ >= 0);
    IMBIBE_ASSERT(::write(file_, content.data(), content.size()) == static_cast<ssize_t>(content.size()));
  }
  ~MemoryFile() { ::close(file_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(file_); }

 private:
  int file_;
};

}  // namespace imbibe::fuzz
