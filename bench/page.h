// docs/performance.md: the committed table of a machine beside what the peers reached on the same kind of machine.
#pragma once

#include <filesystem>
#include <string>

#include "table.h"

namespace imbibe::bench {

// `peers`: name,size,threads,ns_per_item,who,how, a row per measured figure.
std::string performance_page(const Table& table, const std::filesystem::path& peers,
                             const std::filesystem::path& table_file);

}  // namespace imbibe::bench
