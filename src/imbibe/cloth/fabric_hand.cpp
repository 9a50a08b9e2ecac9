#include "imbibe/cloth/fabric_hand.h"

#include <fmt/format.h>

#include <array>

#include "imbibe/core/error.h"

namespace imbibe {
namespace {

// KES units to SI, see the header.
constexpr Real shear_unit = 0.980665 * 180 / pi;  // gf/(cm deg) -> N/m
constexpr Real bending_unit = 9.80665e-5;         // gf cm2/cm -> N m

// Twist: isotropic cloth would have the mean of both bending stiffnesses; woven cloth yields more along the bias.
constexpr FabricHand hand(Real areal_mass, Real thickness, Real stretch_weft, Real stretch_warp, Real shear_kes,
                          Real bending_weft_kes, Real bending_warp_kes) {
  return {.areal_mass = areal_mass, .thickness = thickness, .stretch_weft = stretch_weft, .stretch_warp = stretch_warp,
          .shear = shear_kes * shear_unit, .bending_weft = bending_weft_kes * bending_unit,
          .bending_warp = bending_warp_kes * bending_unit,
          .twist = 0.4 * 0.5 * (bending_weft_kes + bending_warp_kes) * bending_unit};
}

// KES B and G: ranges that Kawabata (1980) gives for the class (men's shirting B .03-.10, G .5-1.2; winter suiting
// B .08-.25, G .5-1.0; women's thin dress fabrics of silk B .01-.05, G .2-.4), jersey and denim from textbooks of fabric
// mechanics. Stretch: secant from the usual extensibility at 490 N/m (shirting 4-12 %, suiting 3-10 %, denim 2-15 %,
// jersey 30-80 %, silk 3-10 %).
constexpr std::array hands{
    NamedHand{"shirting", hand(0.120, 0.35e-3, 4900, 9800, 0.8, 0.05, 0.08),
              "cotton poplin; KES ranges of Kawabata 1980 for men's shirting; good to a factor of 2"},
    NamedHand{"jersey", hand(0.180, 0.80e-3, 800, 1400, 0.6, 0.015, 0.025),
              "single cotton jersey; extensible at 490 N/m by 35-60 %; good to a factor of 2"},
    NamedHand{"denim", hand(0.400, 0.90e-3, 4900, 16000, 3.0, 0.40, 0.70),
              "cotton twill 3/1, 400 g/m2; stiff in shear; good to a factor of 2"},
    NamedHand{"wool_suiting", hand(0.210, 0.60e-3, 6100, 9800, 0.6, 0.07, 0.10),
              "worsted; KES ranges of Kawabata 1980 for men's suiting; good to a factor of 2"},
    NamedHand{"silk", hand(0.060, 0.15e-3, 7000, 14000, 0.3, 0.015, 0.03),
              "habutae and crepe; KES ranges of Kawabata 1980 for thin dress fabrics; good to a factor of 2"}};

}  // namespace

std::span<const NamedHand> fabric_hands() { return hands; }

const FabricHand& fabric_hand(const std::string& name) {
  std::vector<std::string> known;
  for (const NamedHand& h : hands) {
    if (name == h.name) return h.hand;
    known.emplace_back(h.name);
  }
  std::string message = fmt::format("there is no fabric hand '{}'", name);
  if (const std::string near = nearest_word(name, known); !near.empty()) message += fmt::format("; did you mean {}?", near);
  throw InputError(message + fmt::format(" (known: {})", fmt::join(known, ", ")));
}

}  // namespace imbibe
