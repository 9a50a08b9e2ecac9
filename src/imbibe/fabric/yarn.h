// A yarn: a bundle of fibres of one kind, drawn as a round tube.
//
//   r = sqrt(T / (pi rho_f phi_y))
//   r      m      radius of the yarn as laid in the cloth
//   T      kg/m   linear density (1 tex = 1e-6 kg/m)
//   rho_f  kg/m3  density of the fibre substance
//   phi_y  1      packing: fibre share of the yarn's cross-section; 1 for a monofilament
// Any two of r, T and phi_y give the third; packing has a default for each fibre (about 0.55 for staple yarns, Hearle,
// Grosberg & Backer, Structural Mechanics of Fibers, Yarns, and Fabrics, 1969, give 0.5-0.65). Round, unflattened
// yarns are assumed. Tested in tests/fabric/yarn_test.cpp.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "imbibe/core/error.h"
#include "imbibe/core/parameter.h"
#include "imbibe/fabric/fibre_file.h"
#include "imbibe/fabric/network.h"

namespace imbibe {

struct YarnSpec {
  std::string fibre = "cotton";
  std::optional<Real> diameter{};             // m
  std::optional<Real> linear_density{};       // kg/m
  std::optional<Real> packing{};              // 1
  std::optional<Real> density{};              // 1/m, yarns per length across the family; only of warp and weft
  bool monofilament = false;
  std::optional<Real> fibre_radius{};         // m; otherwise the fibre file's
  Real tortuosity_squared = 4;
  std::optional<Real> absorption_coefficient{}; // kg/(m2 s^0.5)
  Vec3 colour{0.93, 0.91, 0.86};             // linear RGB, dry
};

template <class V>
void describe(V& v, YarnSpec& p) {
  v.value("fibre", p.fibre, {.help = "name of a fibre of the fibre library"});
  v.value("diameter", p.diameter,
          {.unit = "m", .shown = "mm", .min = 1e-6, .max = 2e-2, .help = "diameter of the yarn in the cloth"});
  v.value("linear_density", p.linear_density,
          {.unit = "kg/m", .shown = "tex", .min = 1e-8, .max = 1e-1,
           .help = "mass per length of yarn: tex, dtex, denier or Ne"});
  v.value("packing", p.packing,
          {.min = 0, .max = 1, .above_min = true,
           .help = "fibre share of the yarn's cross-section (1 - inner-yarn porosity); default from the fibre file"});
  v.value("density", p.density,
          {.unit = "1/m", .shown = "1/cm", .min = 10, .max = 1e5, .help = "yarns per length: ends or picks per cm or inch"});
  v.value("monofilament", p.monofilament, {.help = "one solid filament: no liquid between fibres, packing 1"});
  v.value("fibre_radius", p.fibre_radius,
          {.unit = "m", .shown = "um", .min = 1e-7, .max = 2e-3,
           .help = "radius of the real fibre in the yarn; default from the fibre file"});
  v.value("tortuosity_squared", p.tortuosity_squared,
          {.min = 1, .max = 100, .help = "divides the yarn's permeability; 2 to 10 in real yarns"});
  v.value("absorption_coefficient", p.absorption_coefficient,
          {.unit = "kg/(m2 s^0.5)", .min = 0, .max = 100,
           .help = "water absorption coefficient A_w for the Kuenzel form; default from the fibre file"});
  v.value("colour", p.colour, {.min = 0, .max = 1, .help = "linear red, green, blue of the dry yarn"});
}

// The equation of this file.
Real yarn_radius(Real linear_density, Real fibre_density, Real packing);

// The yarn of a spec. Problems are appended to `problems` under the dotted path `key`; the result is then not to be
// used. The default packing is that of the fibre's record, 1 for a monofilament.
YarnType make_yarn(const YarnSpec& spec, const FibreLibrary& library, const std::string& key,
                   std::vector<Problem>& problems);

}  // namespace imbibe
