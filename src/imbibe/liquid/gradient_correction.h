// Gradients of the pressure's operator made exact for linear fields, however the particles lie.
//
//   D(u)_i = sum_j V (u_i - u_j).(L_i grad W_ij) + ...     a(k)_i = -sum_j V (k_i L_i + k_j L_j) grad W_ij - ...   (pressure.h)
//   L_i = B_i M_i^-1
//   M_i = -sum_j V x_ij (x) grad W_ij       second moment of i's pairs, 1
//   B_i = s [(1 - lambda) I - sum_k d_k A_k m_k (x) m_k prod_{l != k} (1 - lambda_l)]      what M is in evenly spread liquid
//         that ends at walls k, half-spaces at distance d_k with normal m_k, of which lambda is missing, A = -dlambda/dd
//         (kernel.h); s = lattice_stress (kernel.h)
// So D of a linear field does not depend on how the particles lie, and L = I where they lie evenly: walls keep the operator
// they have (wall_push.h). With plain gradients D sees a shear of disordered particles as
// compression, and a liquid under pressure resists every shear as if by dry friction: a vortex of Re 100 in a layer 10 mm
// wide under its own weight kept 0.13 of its due speed at 12 particles across, 0.56 at 24
// (docs/decisions/0010-corrected-gradients-in-the-pressure.md).
// Since the force is still minus the transpose of D, the operator stays symmetric and momentum is exact; L M = B is symmetric,
// so a rotation is no compression and angular momentum is exact as well.
// Limits: |L - I| <= 1/2 (Frobenius); L = I where M is nearly singular (one layer, a thread), for spray, and under a free
// surface, fading in over |n + f G| H = 0.4 to 0.15: the pressure there is small, and a B that follows a surface whose depth is
// guessed from the colour gradient brakes (vortex 0.88, the drop of water 40 % shorter of breath).
// Liquid with surface tension keeps plain gradients: its thin films, held by hardly any pressure of their own, do not come to
// rest with L (decision 10).
// Tested in tests/liquid/gradient_correction_test.cpp.
#pragma once

#include "imbibe/liquid/fields.h"

namespace imbibe {

// Fills f.correction and sets f.corrected; L = I for spray, whose kernel is filled less than spray_filling (pressure.h).
void correct_gradients(LiquidFields& f, Real spray_filling);

}  // namespace imbibe
