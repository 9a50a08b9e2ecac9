// Viscosity of the liquid and friction at walls.
//
//   a_i = sum_j nu_ij 10 V (u_ij . x_ij)/r^2 grad W      (factor 2 (dim + 2) = 10)
//   wall: a_i = -friction w_i nu_i half_space_shear(d_i) u_t    the same sum over the solid, whose velocity continues the
//         liquid's linearly through the surface's own velocity (zero unless it runs as a belt; kernel.h); u_t tangential,
//         against the surface
//   nu_ij = (w_i nu_i + w_j nu_j)/2,  w_i = (1 - sum_k friction_k lambda_k)/C_i in [1, 3]
//         what the pairs of i miss of a whole kernel: C its liquid's part, lambda_k the walls' (boundary.h), which friction
//         makes up for at a wall that holds the liquid. At a wall that it slips along, and under a free surface, the motion
//         goes on like its mirror image: without w a layer of 6 spacings between two such faces had 0.87 of its viscosity
//   u_ij = u_i - u_j [m/s], x_ij = x_i - x_j [m], nu = eta/rho0 [m2/s], eta dynamic viscosity [Pa s], V = m/rho0 [m3]
// Sources: Monaghan, Annu. Rev. Astron. Astrophys. 30 (1992) 543 (form along the line of centres); Cleary & Monaghan,
// J. Comput. Phys. 148 (1999) 227; walls by linear continuation: Morris, Fox & Zhu, J. Comput. Phys. 136 (1997) 214.
// The pair force acts along the line of centres: linear and angular momentum are conserved to rounding. A free surface
// is free of stress because nothing is there to sum over. Shear across it would need no w, but vanishes there.
// Stability: explicit for dt <= explicit_limit (H/2)^2/nu; a longer step is made implicitly, (1 - dt A) u = u_old, by
// conjugate gradients (A is symmetric and negative), so viscosity never bounds the step. Its A acts on the velocity at the end of
// the step, so what the liquid expects of its other accelerations f goes in and comes out again, u = (1 - dt A)^-1 (u_old + dt f)
// - dt f: a flow in which they and viscosity are in balance then has one speed for all steps (without f it is dt f too fast), and
// liquid that they leave at rest is at rest. The explicit form is right without f but at walls, whose friction is always
// implicit: a speed of dt f is left there, an error of second order in H.
// Tested in tests/liquid/viscosity_test.cpp: momentum, decay of a shear wave, implicit against explicit, wall shear, balance.
#pragma once

#include "imbibe/core/parameter.h"
#include "imbibe/liquid/fields.h"
#include "imbibe/liquid/wall.h"

namespace imbibe {

struct ViscosityParams {
  bool on = true;
  bool wall_friction = true;
  Real explicit_limit = 0.125;   // of H_eff^2 rho/eta, H_eff = H/2; a longer step is made implicitly
  Real tolerance = 1e-4;         // relative residual of the implicit form
  int max_iterations = 100;
};

template <class V>
void describe(V& v, ViscosityParams& p) {
  v.value("on", p.on, {.help = "viscosity acts"});
  v.value("wall_friction", p.wall_friction, {.help = "the liquid sticks to walls according to their friction"});
  v.value("explicit_limit", p.explicit_limit,
          {.min = 0, .max = 0.5, .help = "largest step of the explicit form, in (H/2)^2 rho/eta"});
  v.value("tolerance", p.tolerance, {.min = 0, .max = 0.1, .above_min = true, .help = "relative residual"});
  v.value("max_iterations", p.max_iterations, {.min = 1, .max = 10000, .help = "iterations of the implicit form"});
}

struct ViscosityReport {
  int iterations = 0;  // 0: explicit
  bool converged = true;
};

// The rate coefficient of one pair, 1/s: a_i = -pair_rate x_ij (u_ij . x_ij)/r^2. slope = W'(r)/r <= 0.
template <class T>
T viscous_pair_rate(T viscosity_over_density, T volume, T slope) {
  return -10 * viscosity_over_density * volume * slope;
}

// Pa s: in the bulk, and, if larger, next to walls: up to H/2 from them, fading to the bulk's at H.
struct ViscosityAt {
  Real bulk = 0, walls = 0;
};

// Changes f.velocity by viscosity over dt (w is work space); impulse[wall] gets what friction gave to each wall, N s. Soft
// sheets are dragged explicitly, by no more than brings them to the liquid's velocity. expected: f, m/s2; null: none is known.
ViscosityReport apply_viscosity(LiquidFields& f, const ViscosityParams& params, const ViscosityAt& viscosity, Real dt,
                                std::span<const Wall> walls, std::vector<Vec3>& impulse,
                                const std::vector<Float4>* expected = nullptr);

// Whether a step of dt is too long for the explicit form; kinematic: the largest viscosity, m2/s; support: H.
bool viscosity_is_implicit(const ViscosityParams& params, Real kinematic, Real support, Real dt);

}  // namespace imbibe
