// Each family of cases adds its own to the list, in the order of the report.
#pragma once

#include <vector>

#include "imbibe/verify/case.h"

namespace imbibe::verify {

void add_capillaries(std::vector<Case>& cases);
void add_yarn_transport(std::vector<Case>& cases);

}  // namespace imbibe::verify
