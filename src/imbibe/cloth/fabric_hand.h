// What a fabric's hand is made of: the stiffnesses that a sheet needs, and those of five fabrics as they are measured
// with the KES instruments (Kawabata, The Standardization and Analysis of Hand Evaluation, 1980).
//
//   stretch  N/m: tension per width over strain; KES tensile test, the secant to its greatest tension of 490 N/m
//   shear    N/m: shear force per width over shear angle; KES G [gf/(cm deg)] x 0.98 N/m / (pi/180) = G x 56.2 N/m
//   bending  N m: moment per width over curvature; KES B [gf cm2/cm] x 9.807e-5 N m
//   twist    N m: stiffness against twisting; bending along 45 deg is (B_weft + B_warp)/4 + twist/2
// Confidence: typical of the class, good to a factor of two; a measured fabric replaces them in the scene.
#pragma once

#include <span>
#include <string>

#include "imbibe/core/parameter.h"
#include "imbibe/core/types.h"

namespace imbibe {

struct FabricHand {
  Real areal_mass = 0.120;     // kg/m2
  Real thickness = 0.3e-3;     // m
  Real stretch_weft = 4000;    // N/m
  Real stretch_warp = 8000;    // N/m
  Real shear = 45;             // N/m
  Real bending_weft = 5e-6;    // N m
  Real bending_warp = 8e-6;    // N m
  Real twist = 2.5e-6;         // N m
};

template <class V>
void describe(V& v, FabricHand& p) {
  v.value("areal_mass", p.areal_mass, {.unit = "kg/m2", .shown = "gsm", .min = 0, .max = 10, .above_min = true,
                                       .help = "mass per area of the dry cloth"});
  v.value("thickness", p.thickness, {.unit = "m", .shown = "mm", .min = 0, .max = 0.05, .above_min = true,
                                     .help = "distance that layers of the cloth keep from each other"});
  v.value("stretch_weft", p.stretch_weft, {.unit = "N/m", .min = 0, .max = 1e12, .above_min = true,
                                           .help = "tension per width over strain, along the weft"});
  v.value("stretch_warp", p.stretch_warp, {.unit = "N/m", .min = 0, .max = 1e12, .above_min = true,
                                           .help = "tension per width over strain, along the warp"});
  v.value("shear", p.shear, {.unit = "N/m", .min = 0, .max = 1e12, .above_min = true,
                             .help = "shear force per width over shear angle"});
  v.value("bending_weft", p.bending_weft, {.unit = "N m", .min = 0, .max = 1e3, .above_min = true,
                                           .help = "moment per width over curvature, bending the weft"});
  v.value("bending_warp", p.bending_warp, {.unit = "N m", .min = 0, .max = 1e3, .above_min = true,
                                           .help = "moment per width over curvature, bending the warp"});
  v.value("twist", p.twist, {.unit = "N m", .min = 0, .max = 1e3,
                             .help = "stiffness against twisting; isotropic cloth: the bending stiffness"});
}

struct NamedHand {
  const char* name;
  FabricHand hand;
  const char* source;  // what the values rest on
};
std::span<const NamedHand> fabric_hands();
// The hand of that name; throws InputError naming the nearest known one.
const FabricHand& fabric_hand(const std::string& name);

}  // namespace imbibe
