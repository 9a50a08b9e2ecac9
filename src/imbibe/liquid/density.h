// Colour, filling and their gradients: the one pass over all pairs on which every later stage builds.
//
//   C_i = V W(0) + sum_j V W_ij                   liquid's share of the kernel (colour), 1
//   c_i = C_i + lambda_i                          filling: density / rest density with the walls counted as full
//   n_i = sum_j V grad W_ij                       colour gradient, points into the liquid, 1/m
//   1/a_ii, a_ii = |n_i + 2 P_i|^2 + sum_j |V grad W_ij|^2   diagonal of the pressure operator (pressure.h), 1/m2
//   V = m/rho0 constant [m3]; lambda, G, P of the walls (boundary.h)
//
// Air gap. A wall counts only where liquid reaches it: with air between, it must not push (fragments would glide over a
// wall on a cushion 1.5 spacings high). Lambda, G and P of each wall near a particle are scaled by its contact, 1 where
// (n + G).m H < 0.5 (n + G all liquid and walls around, m out of this wall) and 0 above 0.9, as under a free surface. A
// drop in a corner may stand on one wall and not yet touch the other. Where the liquid between a particle and the wall sees
// a gap, that particle does too: its contact is at most the mean of its neighbours' that are nearer to the wall. And what is not
// among liquid (below) touches a wall only where it is as near as a first layer, 0.2 to 0.3 H.
//
// Air completion. A particle at a free surface misses neighbours, so its filling says nothing about its spacing. The
// missing part is inferred from the colour gradient: a flat surface at depth d gives |n| = A(d) and misses lambda(d)
// (both in kernel.h), so
//   lambda_a = lambda(A^-1(|grad lambda_a|)),   error e = (1 - lambda)(f + lambda_a - 1),   f = C/(1 - lambda)
//   grad lambda_a = -(n + f G)/(1 - lambda), from C = (1 - lambda)(1 - lambda_a): wall and air share the kernel like
//   half-spaces that cross at right angles
// e = 0 for an evenly spaced flat surface at ANY depth (within 0.2 %: slopes below 0.07/H are disorder, not air). At a contact
// line, where wall and air meet at any angle, only compression counts: e = max(0, C + lambda - 1). (Completed there as well,
// a 120 degree drop stood at 130 to 135.)
// This gives surface particles a density that does not drift (without it a drop of water gains energy from its own
// oscillation: docs/decisions/0002-surface-tension-in-the-incompressible-solver.md).
// A droplet of some ten particles has no surface flat over H: its middle seems to lack 13 % for good. What is missing counts
// only among particles that are themselves mostly surrounded (mean filling of the neighbours 0.62 to 0.70): followed, such
// errors made droplets swim over a wall without ever reaching it.
// Assumes a surface flat over H; for a sphere of radius 8 dx the bias is below 1.5 % of the volume.
// Tested in tests/liquid/density_test.cpp; droplets in tests/liquid/droplet_test.cpp.
#pragma once

#include "imbibe/liquid/fields.h"

namespace imbibe {

// Fills f.colour, f.filling, f.colour_gradient (w: |n + f G| H), f.factor and f.density_error; takes the walls across a gap out of
// f.boundary (its sums and each sample's push).
void compute_density(LiquidFields& f);

// lambda_a for gradient_h = |grad lambda_a| H.
float air_completion(float gradient_h);

// e from the colour C, the walls' lambda and |n + f G| H; at least -0.05. Spray (C + lambda < 0.5) is free to be thin:
// max(0, C + lambda - 1) there.
float density_error(float colour, float wall_lambda, float gradient_h);

}  // namespace imbibe
