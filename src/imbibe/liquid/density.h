// Colour, filling and their gradients: the one pass over all pairs on which every later stage builds.
//
//   C_i = V W(0) + sum_j V W_ij                   liquid's share of the kernel (colour), 1
//   c_i = C_i + lambda_i                          filling: density / rest density with the walls counted as full
//   n_i = sum_j V grad W_ij                       colour gradient, points into the liquid, 1/m
//   1/a_ii, a_ii = |n_i + 2 G_i|^2 + sum_j |V grad W_ij|^2   diagonal of the pressure operator (pressure.h), 1/m2
//   V = m/rho0 constant [m3]; lambda, G of the walls (boundary.h)
//
// Air completion. A particle at a free surface misses neighbours, so its filling says nothing about its spacing. The
// missing part is inferred from the colour gradient: a flat surface at depth d gives |n| = A(d) and misses lambda(d)
// (both in kernel.h), so
//   lambda_air = lambda(A^-1(|n_i + G_i|)),   c_i + lambda_air = 1 for an evenly spaced flat surface at ANY depth.
// This gives surface particles a density that does not drift (without it a drop of water gains energy from its own
// oscillation: docs/decisions/0002-surface-tension-in-the-incompressible-solver.md).
// Assumes a surface flat over H; for a sphere of radius 8 dx the bias is below 1.5 % of the volume.
// Tested in tests/liquid/density_test.cpp.
#pragma once

#include "imbibe/liquid/fields.h"

namespace imbibe {

// Fills f.colour, f.filling, f.colour_gradient (w: |n| H), f.factor and the slopes W'/r of the neighbour lists.
void compute_density(LiquidFields& f);

// lambda_air for gradient_h = |n| H.
float air_completion(float gradient_h);

// Relative density error of a particle: c + lambda_air - 1 where the completion can be trusted, at least -lowest;
// max(0, c - 1) for spray (c < 0.55), which is free to be thin.
float density_error(float filling, float gradient_h);

}  // namespace imbibe
