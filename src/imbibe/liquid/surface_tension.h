// Surface tension as a force on the free surface: curvature by a tangent-plane fit on reliable surface particles.
//
//   n_i = n^f_i + sum_k beta_k G_k            colour gradient with WETTED walls counted as liquid [1/m], for n^ and S
//   S,  (n^_j - n^_i).t_a = S_ab (x_j - x_i).t_b     weighted least squares over reliable neighbours (tangent_fit.h)
//   kappa = (k + 2 d K)/(1 + d k + d^2 K),  k = -tr S, K = det S      [1/m], sphere 2/R
//   F_i = 2 gamma kappa_i V N_i - gamma d dx^2 grad_s kappa           [N]
//   gamma surface tension [N/m], beta wetness of wall k (contact_angle.h), n^ = n/|n|, d = offset dx
//   N_i  what a uniform pressure does to particle i: the pressure operator's own response (pressure.h) to p = 1,
//        (1/2) sum_j V (w_i L_i + w_j L_j) grad W_ij + w_i P_i, w = 1/(1 - lambda), L of gradient_correction.h
// The force is that of the pressure p_s = gamma kappa prescribed at the surface (Young-Laplace): a drop of uniform curvature
// is exactly at rest, on walls too, p inside is the true one, and the sum over a cap is -2 pi a gamma sin(theta) with a the
// true radius, since the wall's P counts whole columns of liquid.
// d: centres of the outermost particles stand half a spacing under the liquid's surface. Their surface is parallel to it,
// hence kappa; and on the shell outside them p_s pushes along the surface, hence the second term (work done on an
// incompressible flow is then right to first order in d: Rayleigh's period +8 % without it, +1 % with it, at R = 8 dx).
// kappa is measured only on the set S: |n|H > 0.3, C > 0.25, C + beta lambda < 0.92, at least 1.2 dx from walls unless the
// surface runs along a solid (within 26 to 45 degrees), S evenly around (all as gradual weights); it acts on all particles
// with |n| > 0 and at the contact line (extended by a kernel mean): else 17 % of the tension is lost. Films of one layer and
// thin rims thus have the curvature that keeps them whole; without it a drop of 45 degrees that started at 15 left 17 % of
// itself behind.
// Sources: Brackbill, Kothe & Zemach, J. Comput. Phys. 100 (1992) 335; Morris, Int. J. Numer. Meth. Fluids 33 (2000) 333.
// Momentum: the forces on a drop that touches nothing are made to sum to zero (a gather form does not conserve it by
// itself); the sum on a drop with a contact line is the wall's pull on the line, and the wall gets the reaction.
// Validity: radius >= 4 dx, films >= 3 dx. Stability: dt <= 0.5 sqrt(rho dx^3/(2 pi gamma)), and damping.h.
// Tested in tests/liquid/drop_test.cpp: Laplace pressure, Rayleigh period, resting centre, vertical force, momentum.
#pragma once

#include <span>
#include <vector>

#include "imbibe/core/parameter.h"
#include "imbibe/liquid/contact_angle.h"
#include "imbibe/liquid/fields.h"
#include "imbibe/liquid/wall.h"

namespace imbibe {

struct SurfaceParams {
  Real offset = 0.5;              // dx
  Real numerical_viscosity = 0.1;  // of sqrt(gamma dx/rho), the least kinematic viscosity at walls: see least_viscosity()
  Real damping = 1;               // strength of the grid-scale filter per shortest capillary time (damping.h)
  ContactAngleParams contact;
};

template <class V>
void describe(V& v, SurfaceParams& p) {
  v.value("offset", p.offset, {.min = 0, .max = 1, .help = "depth of the outermost particles under the surface, in spacings"});
  v.value("numerical_viscosity", p.numerical_viscosity,
          {.min = 0, .max = 2, .help = "least viscosity next to walls, for stability, of sqrt(surface tension x spacing / density)"});
  v.value("damping", p.damping,
          {.min = 0, .max = 1, .help = "filter of motions as small as the spacing, per shortest capillary time"});
  v.group("contact", p.contact, "contact line");
}

// Work space kept between steps.
struct SurfaceScratch {
  std::vector<Float4> gradient;       // n with wetted walls, w = |n| H
  std::vector<Float4> normal;         // unit n, w = kappa; on S
  std::vector<float> curvature;       // kappa, extended beyond S
  std::vector<float> reliability;     // 0..1, of the normal; > 0: in S
  std::vector<float> trust;           // 0..reliability, of the curvature
  std::vector<float> line_length;     // m, of contact line that the particle stands for
  std::vector<Index> line_wall;       // its wall, where the length is > 0
  std::vector<Index> owner;           // the reliable particle whose drop i belongs to; no_index: none
  std::vector<Index> root;            // of the drops, by reliable particle
  std::vector<double> drop_sums;
  std::vector<Vec3> wall_parts;
};

struct SurfaceReport {
  std::size_t surface_particles = 0;  // members of S
  Vec3 net_force{};  // N, of the curvature part on all drops with a contact line; -2 pi a gamma sin(theta) z on a cap
};

// Fills f.force (m/s2), f.surface (S) and kinds; slows f.velocity by the line's friction; impulse[wall] += what lines give
// to each wall, N s: friction, the tangential force's and the surface's reaction.
SurfaceReport compute_surface(LiquidFields& f, const SurfaceParams& params, Real surface_tension,
                              std::span<const Wall> walls, Real dt, SurfaceScratch& scratch,
                              std::vector<ParticleClass>& kinds, std::vector<Vec3>& impulse);

// m2/s, kinematic, next to walls: less is raised to it there, a thicker liquid keeps its own (so oils damp as they should).
// Motions of a few spacings would otherwise gain energy at contact lines; away from walls damping.h is enough, and a free
// drop swings as its own viscosity lets it. Scales with dx^(1/2): about 9 times water's at dx = 0.12 mm.
Real least_viscosity(const SurfaceParams& params, Real surface_tension, Real density, Real spacing);

}  // namespace imbibe
