// Runs cases one after the other. A case that throws is a failed case; the others go on.
#pragma once

#include <functional>

#include "imbibe/verify/report.h"

namespace imbibe::verify {

struct RunChoice {
  std::vector<std::string> names;  // of cases or families; empty: all
  bool quick = false;
  bool pictures = true;
};

// Throws InputError naming every unknown name with its nearest.
std::vector<const Case*> chosen_cases(const RunChoice& choice);

// `scene_folder` is scenes/verify. `done` is called after each case with all outcomes so far, this one last.
Verification run_cases(const RunChoice& choice, const std::filesystem::path& scene_folder, const Library& library,
                       const std::function<void(const Verification&)>& done = {});

}  // namespace imbibe::verify
