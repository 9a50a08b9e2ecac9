// report.html of a run: key figures, derived fabric numbers, curves as inline SVG, pictures, the command to repeat it.
// One file that opens without network; pictures are linked by relative path. Made only from what lies in the run
// folder (run.json, series.csv, pictures/, film.mp4), so `imbibe report RUN` can make it again at any time.
// Tested in tests/io/report_test.cpp.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "imbibe/core/types.h"

namespace imbibe {

// Writes <folder>/report.html and returns its path. InputError when run.json or series.csv is missing or damaged.
std::filesystem::path write_report(const std::filesystem::path& folder);

std::string report_html(const std::filesystem::path& folder);

}  // namespace imbibe
