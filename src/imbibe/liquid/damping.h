// A filter for motions as small as the particle spacing, which a curvature measured on scattered particles feeds.
//
//   L(u)_i = sum_j V W_ij (u_j - u_i)          u <- u - e L(L(u)),   e = strength dt/t_c in [0, 0.5]
//   t_c = sqrt(rho dx^3/(2 pi gamma)), the shortest capillary time [s]
// The double smoothing takes a wave of length 8 dx 30 times less than one of 2 dx, so an oscillating drop keeps its energy
// where an added viscosity of the same effect at the spacing would damp it. L is symmetric: momentum is conserved and
// kinetic energy can only fall.
// Tested in tests/liquid/damping_test.cpp: momentum, energy, a rigid motion stays.
#pragma once

#include "imbibe/liquid/fields.h"

namespace imbibe {

// Changes f.velocity; f.acceleration is work space.
void damp_small_scales(LiquidFields& f, float strength);

}  // namespace imbibe
