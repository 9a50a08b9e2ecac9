// Surface tension as a force on the free surface: curvature by a tangent-plane fit on reliable surface particles.
//
//   n_i = n^f_i + sum_k beta_k G_k            colour gradient with WETTED walls counted as liquid [1/m]
//   kappa_i = -trace of S,  S from (n^_j - n^_i).t_a = S_ab (x_j - x_i).t_b, weighted least squares    [1/m], sphere 2/R
//   F_i = 2 gamma kappa' V n_i                [N]   kappa' = kappa/(1 + offset dx kappa)
//   gamma surface tension [N/m], beta wetness of wall k (contact_angle.h), n^ = n/|n|
// The factor 2: only the liquid half of the colour's profile exists, integral of |n| across it is 1/2. The force equals the
// pressure p_s = gamma kappa prescribed at the surface (Young-Laplace), so p inside is the true one.
// kappa is measured only on the set S: |n|H > 0.3, C > 0.25, C + beta lambda < 0.92, at least 1.2 dx from walls (all as
// gradual weights); it acts on all particles with |n| > 0 (extended from S by a kernel mean): else 17 % of the tension is lost.
// offset: depth, in dx, at which particles stand under the surface; 0 gives the best Laplace pressure (+2 % at R = 8 dx).
// Sources: Brackbill, Kothe & Zemach, J. Comput. Phys. 100 (1992) 335; Morris, Int. J. Numer. Meth. Fluids 33 (2000) 333.
// Net force of a drop that touches nothing is set to zero (a gather form does not conserve momentum by itself).
// The force acts at particle centres, dx/2 inside: its sum over a cap is low by about 0.7 dx/a.
// Validity: radius >= 4 dx, films >= 3 dx. Stability: dt <= 0.5 sqrt(rho dx^3/(2 pi gamma)), and damping.h.
// Tested in tests/liquid/drop_test.cpp: Laplace pressure, Rayleigh period, resting centre, vertical force.
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
  Real numerical_viscosity = 0.1;  // of sqrt(gamma dx/rho), added to the liquid's: see numerical_viscosity()
  Real damping = 1;               // strength of the grid-scale filter per shortest capillary time (damping.h)
  ContactAngleParams contact;
};

template <class V>
void describe(V& v, SurfaceParams& p) {
  v.value("offset", p.offset, {.min = 0, .max = 1, .help = "depth of surface particles for the curvature, in spacings"});
  v.value("numerical_viscosity", p.numerical_viscosity,
          {.min = 0, .max = 2, .help = "viscosity added for stability, of sqrt(surface tension x spacing / density)"});
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
  Vec3 net_force{};  // N, of the curvature part on all drops that touch a wall; -2 pi a gamma sin(theta) z on a cap
};

// Fills f.force (m/s2), f.surface (S) and kinds; slows f.velocity by the line's friction; impulse[wall] += what the line
// gives to each wall, N s.
SurfaceReport compute_surface(LiquidFields& f, const SurfaceParams& params, Real surface_tension,
                              std::span<const Wall> walls, Real dt, SurfaceScratch& scratch,
                              std::vector<ParticleClass>& kinds, std::vector<Vec3>& impulse);

// m2/s, kinematic. Motions of a few spacings would otherwise gain energy from the curvature's error; scales with
// dx^(1/2), is about 9 times water's viscosity at dx = 0.12 mm.
Real numerical_viscosity(const SurfaceParams& params, Real surface_tension, Real density, Real spacing);

}  // namespace imbibe
