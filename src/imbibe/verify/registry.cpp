// The list of all cases.
#include "imbibe/verify/families.h"

namespace imbibe::verify {

const std::vector<Case>& all_cases() {
  static const std::vector<Case> cases = [] {
    std::vector<Case> all;
    add_flows(all);
    add_drops(all);
    add_drops_on_solids(all);
    add_pendant_drop(all);
    add_capillaries(all);
    add_yarn_transport(all);
    add_spreading(all);
    add_network(all);
    add_sorption(all);
    add_drying(all);
    add_printed(all);
    add_cloth(all);
    add_coupled(all);
    return all;
  }();
  return cases;
}

}  // namespace imbibe::verify
