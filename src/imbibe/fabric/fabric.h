// A fabric from its description: weave, two yarn systems, counts; optionally a WIF file, stripes of other yarns, and
// a wanted areal mass or porosity. `build_fabric` is the way in; the parts are in the other files of this folder.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "imbibe/core/parameter.h"
#include "imbibe/fabric/fibre_file.h"
#include "imbibe/fabric/network.h"
#include "imbibe/fabric/porosity.h"
#include "imbibe/fabric/weave.h"
#include "imbibe/fabric/yarn.h"

namespace imbibe {

// Other yarns at some places of a family: yarns first, first+1, ... first+count-1, and again every `repeat` yarns.
struct StripeSpec {
  Family family = Family::warp;
  int first = 1;      // counted from 1, at the smallest x (warp) or y (weft)
  int count = 1;
  int repeat = 0;     // 0 = once
  YarnSpec yarn;
};

template <class V>
void describe(V& v, StripeSpec& p) {
  v.choice("family", p.family, Choices<Family>{{"warp", Family::warp}, {"weft", Family::weft}},
           "which yarns the stripe replaces");
  v.value("first", p.first, {.min = 1, .max = 1e7, .help = "first yarn of the stripe, counted from 1"});
  v.value("count", p.count, {.min = 1, .max = 1e7, .help = "number of neighbouring yarns"});
  v.value("repeat", p.repeat, {.min = 0, .max = 1e7, .help = "distance to the next such stripe, in yarns; 0 = only once"});
  v.group("yarn", p.yarn, "the yarn of the stripe; its density is not used");
}

// Layers of a textile that lie on each other.
struct LayerSpec {
  int count = 1;
  std::string fibre;  // of all yarns of these layers, with the described diameters and packings; empty: as described
};

template <class V>
void describe(V& v, LayerSpec& p) {
  v.value("count", p.count, {.min = 1, .max = 64, .help = "so many like this"});
  v.value("fibre", p.fibre,
          {.help = "fibre of all their yarns, of the same diameter and packing; default: the fibres of warp and weft"});
}

enum class PorosityBy { thickness, pitch };

struct FabricSpec {
  std::array<Real, 2> size{0.05, 0.05};        // m, along the weft (x) and along the warp (y)
  std::string weave = "plain";                 // a form of weave.h or a .wif file
  std::vector<std::string> weave_rows;         // rows of 0 and 1 in place of `weave`
  YarnSpec warp, weft;
  std::vector<StripeSpec> stripes;
  std::vector<LayerSpec> layers;               // from above downwards; none: one layer
  Real layer_gap = 0;                          // m
  std::optional<Real> thickness;               // m, of the slab whose voids are the pores
  std::optional<Real> areal_mass;              // kg/m2, wanted: both pitches are scaled to reach it
  std::optional<Real> porosity;                // 1, wanted
  PorosityBy porosity_by = PorosityBy::thickness;
  std::optional<Real> warp_crimp_share;        // share of the warp in the crimp height; default: flush faces
  int points_per_segment = 8;
  // Not part of the description: where relative .wif paths start.
  std::filesystem::path folder;
};

// woven: false of a cloth of cells, which has an extent and an areal mass and no yarns.
template <class V>
void describe(V& v, FabricSpec& p, bool woven = true) {
  v.value("size", p.size, {.unit = "m", .shown = "mm", .min = 0, .max = 100, .above_min = true,
                           .help = "extent along the weft (x) and along the warp (y)"});
  read_when(v, woven, [&] {
    v.value("weave", p.weave,
            {.help = "plain | twill 2/1 [left] | satin 5/2 | sateen 5/2 | basket 2/2 | rows like \"10 01\" | a .wif file"});
    v.value("weave_rows", p.weave_rows, {.help = "rows of 0 and 1, one per pick, 1 = warp on the face; in place of weave"});
    v.group("warp", p.warp, "the yarns along y");
    v.group("weft", p.weft, "the yarns along x");
    v.list("stripes", p.stripes, "other yarns by index");
    v.list("layers", p.layers, "several layers of the fabric lying on each other, from above downwards; default: one");
    v.value("layer_gap", p.layer_gap,
            {.unit = "m", .shown = "um", .min = 0, .max = 1e-3,
             .help = "distance of layers that lie on each other, between their highest points; 0: they touch"});
    v.value("thickness", p.thickness,
            {.unit = "m", .shown = "mm", .min = 0, .max = 1, .above_min = true,
             .help = "thickness of the slab whose voids are the pores, of one layer; default from the yarns, "
                     "2 (r_warp + r_weft)"});
  });
  v.value("areal_mass", p.areal_mass,
          {.unit = "kg/m2", .shown = "g/m2", .min = 0, .max = 100, .above_min = true,
           .help = "wanted mass per area of one layer: both densities are scaled alike to reach it"});
  read_when(v, woven, [&] {
    v.value("porosity", p.porosity, {.min = 0, .max = 1, .above_min = true, .help = "wanted porosity between the yarns"});
    v.choice("porosity_by", p.porosity_by,
             Choices<PorosityBy>{{"thickness", PorosityBy::thickness}, {"pitch", PorosityBy::pitch}},
             "what is changed to reach the wanted porosity");
    v.value("warp_crimp_share", p.warp_crimp_share,
            {.min = 0, .max = 1,
             .help = "share of the warp in the crimp height; default: both families flush with both faces"});
    v.value("points_per_segment", p.points_per_segment,
            {.min = 2, .max = 64, .help = "steps of the centre line per half loop; an even number"});
  });
}

struct Fabric {
  YarnNetwork network;
  FabricNumbers numbers;
  WeaveDraft draft;
  std::string weave_name;   // as written
};

// What a fabric will cost, before anything is allocated.
struct FabricEstimate {
  std::size_t ends = 0, picks = 0;
  double segments = 0, pores = 0, edges = 0, points = 0;
  double bytes = 0;
};
// From sizes and densities alone; `key` prefixes the problems, e.g. "textiles[0]".
FabricEstimate estimate_fabric(const FabricSpec& spec);

// Throws InputError with all problems of the spec (keys prefixed by `key`).
Fabric build_fabric(const FabricSpec& spec, const FibreLibrary& library, const std::string& key = "");

// All derived numbers in textile units, for `imbibe fabric` and `imbibe check`.
struct ShownLiquid {
  std::string name = "water, 20 degC";
  Real density = 998.2, surface_tension = 0.0728;
};
std::string describe_fabric(const Fabric& fabric, const ShownLiquid& liquid = {});

}  // namespace imbibe
