// How far apart two surfaces may come before the liquid bridges between them break.
//
//   l = (1 + theta/2) V^(1/3)
//
// l m, V m3 volume of one bridge, theta rad. Lian, Thornton & Adams, J. Colloid Interface Sci. 161 (1993) 138, eq. 10, for
// spheres; for crossing yarns it is a measure. V: what a mesh of a shirting holds when full, 0.12 mm3 (pitch 0.4 mm,
// 0.75 mm between the faces that touch), on fibres that water wets (theta = 0).
#pragma once

#include "imbibe/core/types.h"

namespace imbibe {

inline constexpr Real bridge_length = 0.5e-3;  // m

}  // namespace imbibe
