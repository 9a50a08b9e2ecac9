// What the pressure feels of each wall near a particle, P_k, where walls meet too.
//
//   P_k = G_k (1 + (2 r_k - 1) prod_{l != k} J_l)/2       r: pressure_gradient_ratio (kernel.h), 1/m
//   J(d) = integral over y > 0 of A(|d - y|)/(1 - lambda(y)) dy     1 far from the wall, 0.66 on it
// G_k holds the factors 1 - lambda_l of the others (boundary.h). A uniform pressure p is k = p/(1 - lambda) in the operator
// (pressure.h): along wall k's normal the pairs give -(A/o_k + A_s prod J_l), o = 1 - lambda, A_s as in kernel.h, where the
// kernel counts as a product of its parts across each wall (lambda of an edge is within 0.001 of that product). With
// J = 1, the flat wall's P in a corner, liquid was pushed out of vertical edges between walls and left hollows there.
// Tested in tests/liquid/wall_push_test.cpp: a uniform pressure does not accelerate a block in a corner.
#pragma once

#include <span>

#include "imbibe/liquid/boundary.h"

namespace imbibe {

// Sets push of each sample from its gradient and distance. contact: per sample, 1 where liquid reaches the wall, 0 where
// it does not (density.h); an absent wall has J = 1.
void set_pushes(std::span<WallSample> samples, std::span<const float> contact, float support);

}  // namespace imbibe
