// What a scene says of a sheet: fixed, or soft with its size or mesh, its pins and its stiffness.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "imbibe/cloth/cloth_step.h"
#include "imbibe/core/parameter.h"
#include "imbibe/core/types.h"
#include "imbibe/coupling/cell_cloth.h"
#include "imbibe/geometry/shape_spec.h"

namespace imbibe {

enum class SheetKind { fixed, soft };

struct PinMoveSpec {
  Real time = 0;         // s
  Vec3 displacement{};   // m
};

template <class V>
void describe(V& v, PinMoveSpec& p) {
  v.value("time", p.time, {.unit = "s", .min = 0, .required = true, .help = "when the pin is displaced so far"});
  v.value("displacement", p.displacement, {.unit = "m", .shown = "mm", .required = true,
                                           .help = "from where it was pinned; in between it goes evenly"});
}

// One of corner, edge, point.
struct PinSpec {
  std::optional<std::string> corner, edge;
  std::optional<std::array<Real, 2>> point;  // m, along weft and warp from the lower left corner
  std::vector<PinMoveSpec> motion;
  std::optional<Real> until;                 // s
};

template <class V>
void describe(V& v, PinSpec& p) {
  v.value("corner", p.corner, {.help = "bottom_left | bottom_right | top_left | top_right (right: along the weft, top: along the warp)"});
  v.value("edge", p.edge, {.help = "left | right | bottom | top"});
  v.value("point", p.point, {.unit = "m", .shown = "mm", .help = "the node nearest to this place in the cloth, from its lower left corner"});
  v.list("motion", p.motion, "where the pin goes by key times");
  v.value("until", p.until, {.unit = "s", .min = 0, .above_min = true, .help = "when it lets go; default: never"});
}

struct SoftSheetSpec {
  int columns = 0, rows = 0;           // nodes along weft and warp
  std::optional<Real> node_distance;   // m
  std::optional<std::string> mesh;     // OBJ file with UV
  MeshTransform transform;
  Real uv_scale = 1;                   // m per unit of UV
  std::vector<PinSpec> pins;
  std::optional<std::string> preset;
  ClothParams cloth;
  WetClothParams wet;
};

template <class V>
void describe(V& v, SoftSheetSpec& p) {
  v.value("columns", p.columns, {.min = 0, .max = 4000, .help = "nodes along the weft; 0: from node_distance"});
  v.value("rows", p.rows, {.min = 0, .max = 4000, .help = "nodes along the warp; 0: from node_distance"});
  v.value("node_distance", p.node_distance, {.unit = "m", .shown = "mm", .min = 0, .above_min = true,
                                             .help = "distance of the nodes where columns and rows are not given; default: 1/24 of the longer side"});
  v.value("mesh", p.mesh, {.help = "OBJ file with UV coordinates of a free-form sheet, in place of size"});
  v.group("transform", p.transform, "how the mesh stands in the world");
  v.value("uv_scale", p.uv_scale, {.unit = "1", .min = 0, .above_min = true, .help = "metres of cloth per unit of UV"});
  v.list("pins", p.pins, "where it is held");
  v.value("preset", p.preset, {.help = "shirting | jersey | denim | wool suiting | silk: hand of a measured fabric; single values of cloth.hand replace its own"});
  v.group("cloth", p.cloth, "how it deforms");
  v.group("wet", p.wet, "what water changes");
}

struct SheetSpec {
  SheetKind kind = SheetKind::fixed;
  std::optional<SoftSheetSpec> soft;
  bool is_soft() const { return kind == SheetKind::soft || soft.has_value(); }
};

template <class V>
void describe(V& v, SheetSpec& p) {
  if constexpr (requires { v.short_form(""); }) v.short_form("kind");
  v.choice("kind", p.kind, {{"fixed", SheetKind::fixed}, {"soft", SheetKind::soft}},
           "fixed: a flat sheet that does not move; soft: a cloth that hangs and folds");
  v.group("soft", p.soft, "the soft sheet; giving this map chooses it");
}

}  // namespace imbibe
