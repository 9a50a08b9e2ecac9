// Values with units at the edge of the program: "20 tex", "24 /cm", "50 uL", "60 deg", "65 %", "20 degC".
// Units by UDUNITS-2, plus tex, dtex, denier, Ne (English cotton count), gsm, ends and picks. Inside, all is SI;
// angles are radians, temperatures kelvin, ratios 1.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

#include "imbibe/core/types.h"

namespace imbibe {

struct QuantityError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The SI value of `text`, which must be a number and a unit convertible to `si_unit` (UDUNITS spelling, e.g. "m",
// "kg/m", "m3", "rad", "K", "1"). A number alone is accepted only where it is already in SI, that is always, but for
// units "K" and "rad" a bare number is refused as ambiguous.
// Throws QuantityError saying what was read and what kind of unit is wanted.
Real parse_quantity(std::string_view text, std::string_view si_unit);

// `in_si` in `shown_unit`, e.g. format_quantity(4e-4, "m", "mm") = "0.4 mm". At most 6 significant digits.
std::string format_quantity(Real in_si, std::string_view si_unit, std::string_view shown_unit);

// The factor and offset of a conversion: shown = factor * si + offset.
Real convert_from_si(Real in_si, std::string_view si_unit, std::string_view shown_unit);

}  // namespace imbibe
