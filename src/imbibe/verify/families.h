// Each family of cases adds its own to the list, in the order of the report.
#pragma once

#include <vector>

#include "imbibe/verify/case.h"

namespace imbibe::verify {

void add_capillaries(std::vector<Case>& cases);
void add_yarn_transport(std::vector<Case>& cases);
void add_spreading(std::vector<Case>& cases);
void add_network(std::vector<Case>& cases);
void add_sorption(std::vector<Case>& cases);
void add_drying(std::vector<Case>& cases);
void add_printed(std::vector<Case>& cases);
void add_cloth(std::vector<Case>& cases);
void add_coupled(std::vector<Case>& cases);
void add_flows(std::vector<Case>& cases);
void add_drops(std::vector<Case>& cases);
void add_drops_on_solids(std::vector<Case>& cases);
void add_pendant_drop(std::vector<Case>& cases);

}  // namespace imbibe::verify
