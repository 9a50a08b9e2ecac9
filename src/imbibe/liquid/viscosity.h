// Viscosity of the liquid and friction at walls.
//
//   a_i = (eta/rho0) sum_j 10 V (u_ij . x_ij)/(r^2) grad W     (Monaghan & Cleary form, d + 2 = 5, times 2)
//   u_ij = u_i - u_j [m/s], x_ij = x_i - x_j [m], eta dynamic viscosity [Pa s], V = m/rho0 [m3]
//   Sources: Monaghan, Annu. Rev. Astron. Astrophys. 30 (1992) 543; Cleary & Monaghan, J. Comput. Phys. 148 (1999) 227.
// Acts along the line of centres: linear and angular momentum are conserved to rounding.
// Wall: the solid moves with zero velocity as the liquid's continuation; shear over the kernel-weighted distance:
//   a_i = -friction (eta/rho0) 2 |G_i| u_t / max(d_i, dx/4)  with u_t tangential, weakly depends on kernel, see the test.
// Stability: explicit for dt <= viscous_factor H^2 rho/eta; beyond, the stage runs implicit (viscosity.cpp).
// Tested in tests/liquid/viscosity_test.cpp: momentum, decay of a shear wave, Couette start-up.
#pragma once

#include "imbibe/core/parameter.h"
#include "imbibe/liquid/fields.h"

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

// Changes f.velocity by viscosity over dt; impulse[wall] gets what friction gave to each wall, N s.
ViscosityReport apply_viscosity(LiquidFields& f, const ViscosityParams& params, Real viscosity, Real dt,
                                std::vector<Vec3>& impulse);

}  // namespace imbibe
