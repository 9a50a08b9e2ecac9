#include "imbibe/io/machine.h"

#include <sys/utsname.h>
#include <unistd.h>

#include <fstream>
#include <limits>
#include <system_error>
#include <thread>

namespace imbibe {

Machine this_machine() {
  Machine machine;
  machine.processor = "unknown";
  std::ifstream cpus("/proc/cpuinfo");
  for (std::string line; std::getline(cpus, line);) {
    if (!line.starts_with("model name")) continue;
    const std::size_t at = line.find(": ");
    if (at != std::string::npos) machine.processor = line.substr(at + 2);
    break;
  }
  machine.cores = static_cast<int>(std::thread::hardware_concurrency());
  machine.memory_bytes = static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) *
                         static_cast<std::uint64_t>(::sysconf(_SC_PAGE_SIZE));
  utsname system{};
  if (::uname(&system) == 0) machine.system = std::string(system.sysname) + " " + system.release + " " + system.machine;
#ifdef __VERSION__
  machine.compiler = __VERSION__;
#endif
  return machine;
}

double memory_in_use() {
  std::ifstream pages("/proc/self/statm");
  double all = 0, resident = 0;
  return pages >> all >> resident ? resident * static_cast<double>(::sysconf(_SC_PAGE_SIZE)) : 0;
}

double free_space(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::path at = std::filesystem::absolute(folder, error);
  while (!std::filesystem::exists(at, error) && at.has_relative_path()) at = at.parent_path();
  const auto space = std::filesystem::space(at, error);
  return error ? std::numeric_limits<double>::infinity() : static_cast<double>(space.available);
}

}  // namespace imbibe
