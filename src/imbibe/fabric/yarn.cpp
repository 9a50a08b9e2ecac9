#include "imbibe/fabric/yarn.h"

#include <fmt/format.h>

#include "imbibe/core/quantity.h"

namespace imbibe {

Real yarn_radius(Real linear_density, Real fibre_density, Real packing) {
  return std::sqrt(linear_density / (pi * fibre_density * packing));
}

namespace {

// Equal circles cannot fill more of a plane than pi / (2 sqrt 3).
constexpr Real densest_packing = 0.9069;

void check_ranges(const YarnSpec& spec, const std::string& key, std::vector<Problem>& problems) {
  const auto positive = [&](const std::optional<Real>& value, const char* name) {
    if (value && !(*value > 0 && std::isfinite(*value)))
      problems.push_back(Problem{"", 0, 0, key + "." + name, fmt::format("{} is not above 0", *value)});
  };
  positive(spec.diameter, "diameter");
  positive(spec.linear_density, "linear_density");
  positive(spec.packing, "packing");
  positive(spec.density, "density");
  positive(spec.fibre_radius, "fibre_radius");
  if (spec.packing && *spec.packing > 1)
    problems.push_back(Problem{"", 0, 0, key + ".packing", fmt::format("{} is above 1", *spec.packing)});
  if (!(spec.tortuosity_squared >= 1))
    problems.push_back(Problem{"", 0, 0, key + ".tortuosity_squared", fmt::format("{} is below 1", spec.tortuosity_squared)});
}

}  // namespace

YarnType make_yarn(const YarnSpec& spec, const FibreLibrary& library, const std::string& key,
                   std::vector<Problem>& problems) {
  YarnType yarn;
  const std::size_t before = problems.size();
  check_ranges(spec, key, problems);
  const FibreRecord* record = find_fibre(library, spec.fibre);
  if (record == nullptr) {
    problems.push_back(Problem{"", 0, 0, key + ".fibre", unknown_fibre_message(library, spec.fibre)});
  } else {
    yarn.fibre = record->fibre;
    if (spec.fibre_radius) yarn.fibre.radius = *spec.fibre_radius;
  }
  if (!spec.diameter && !spec.linear_density)
    problems.push_back(Problem{"", 0, 0, key, "needs a diameter (such as 0.4 mm) or a linear_density (such as 20 tex)"});
  if (spec.monofilament && spec.packing && *spec.packing != 1)
    problems.push_back(Problem{"", 0, 0, key + ".packing", "a monofilament has packing 1"});
  if (problems.size() > before) return yarn;

  yarn.monofilament = spec.monofilament;
  yarn.tortuosity_squared = spec.tortuosity_squared;
  yarn.absorption_coefficient = spec.absorption_coefficient.value_or(0);
  yarn.colour = Vector3<float>(spec.colour);
  yarn.packing = spec.packing.value_or(spec.monofilament ? 1 : record->staple_packing);
  const Real rho = yarn.fibre.density;
  if (!spec.diameter) {
    yarn.linear_density = *spec.linear_density;
    yarn.radius = yarn_radius(yarn.linear_density, rho, yarn.packing);
  } else {
    yarn.radius = *spec.diameter / 2;
    const Real section = pi * yarn.radius * yarn.radius * rho;
    if (spec.linear_density) {
      // Both given: they fix the packing.
      const Real packing = *spec.linear_density / section;
      const Real wanted = spec.monofilament ? Real(1) : spec.packing.value_or(packing);
      if (std::abs(packing / wanted - 1) > 0.01)
        problems.push_back(Problem{"", 0, 0, key,
                                   fmt::format("{} in a diameter of {} is a packing of {:.3f}, not {:.3f}: leave one of "
                                               "the three out", format_quantity(*spec.linear_density, "kg/m", "tex"),
                                               format_quantity(*spec.diameter, "m", "mm"), packing, wanted)});
      yarn.packing = spec.monofilament ? 1 : packing;
      yarn.linear_density = *spec.linear_density;
    } else {
      yarn.linear_density = section * yarn.packing;
    }
  }
  if (!spec.monofilament && yarn.packing > densest_packing)
    problems.push_back(Problem{"", 0, 0, key,
                               fmt::format("round fibres fill at most {} of a yarn, this one is packed to {:.3f}; a "
                                           "single filament says monofilament: true", densest_packing, yarn.packing)});
  if (yarn.fibre.radius > yarn.radius * (1 + 1e-9) && !spec.monofilament)
    problems.push_back(Problem{"", 0, 0, key,
                               fmt::format("a fibre of {} is thicker than its yarn of {}",
                                           format_quantity(2 * yarn.fibre.radius, "m", "um"),
                                           format_quantity(2 * yarn.radius, "m", "um"))});
  return yarn;
}

}  // namespace imbibe
