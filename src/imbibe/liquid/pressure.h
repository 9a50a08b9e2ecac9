// Incompressible pressure: one projection per step whose source holds the divergence AND the density.
//
//   D(u)_i = sum_j V (u_i - u_j).grad W_ij + 2 u_i.P_i        (1 - lambda_i) times the rate of compression, 1/s
//   a(k)_i = -sum_j V (k_i + k_j) grad W_ij - 2 k_i P_i       pressure acceleration, m/s2
//   find k:  D(u* + dt a(k)) = -(dt/tau) (1 - lambda) e/dt    e relative density error (density.h)
//   p_i = 0.984 rho0 (1 - lambda_i) k_i     pressure, Pa; 0.984 at H = 2.5 dx: the pairs' second moment (lattice_stress)
// For the velocity grad W_ij is L_i grad W_ij in D and (k_i L_i + k_j L_j) grad W_ij in a (gradient_correction.h).
// Next to a wall (lambda, P: boundary.h) the pairs hold only the part 1 - lambda of the kernel, and with it of every
// gradient ALONG the wall: without the weight 1/(1 - lambda) in k the pressure in a column between walls rose 4 % faster
// than rho g at 20 spacings width, 9 % at 10. With it the sum over all layers at the wall is exact. P stands in for the
// gradient of lambda so that a uniform p does not accelerate.
// u* velocity after all other forces, surface tension among them (surface_tension.h): outside the liquid p = 0.
// a() is the transpose of -D(), so A = -D a is symmetric positive semi-definite; it is solved by conjugate gradients with
// its diagonal as preconditioner, started from the last step's pressure. Relaxed Jacobi (0.5), the usual choice with 30
// neighbours, diverges with 65: the largest eigenvalue of the scaled operator grows with the number of neighbours.
// Pressure may be negative: nothing is clamped, so the surface is not compressed and suction acts. What a separating
// spray may not do is pull itself together: particles with little filling have k = 0.
// The compression that the tolerance leaves is of one sign where a column comes down on a floor, so it adds up from step to step; the
// displacement that undoes it (liquid_step.h) moves a particle 0.2 dx a step at most, that is 0.2/n of a column of n layers.
// With the tolerance of 1e-3 that is usual elsewhere (where one solve serves both) a block of 46 layers falling on a floor
// had a mean density error of 1 to 4 % after 100 steps and growing; with 3e-4 and 1e-4 it is 0.3 % and stays.
// tau = density_time: errors of density fade with that time constant instead of being kicked out in one step (which
// heats the liquid). The step by default gives them to a displacement instead (liquid_step.h) and solves here with e = 0.
// Sources: Bender & Koschier, IEEE TVCG 23 (2017) 1193 (operators); Asai et al., Int. J. Numer. Meth. Eng. 93 (2012)
// (mixed source); transposed pair and its conservation of momentum: Cummins & Rudman, J. Comput. Phys. 152 (1999) 584.
// Tested in tests/liquid/pressure_test.cpp and tests/liquid/drop_test.cpp.
#pragma once

#include <span>
#include <vector>

#include "imbibe/core/parameter.h"
#include "imbibe/liquid/fields.h"

namespace imbibe {

struct PressureParams {
  Real tolerance = 1e-4;      // mean relative compression per step the projected velocity may still cause
  int max_iterations = 60;
  Real density_time = 5;      // tau in units of sqrt(rho dx^3/(2 pi gamma)); with gamma = 0: in steps / 2
  Real spray_filling = 0.4;   // below: k = 0
  bool corrected_gradients = true;  // gradient_correction.h, of liquid without surface tension; off: dry friction under pressure
};

template <class V>
void describe(V& v, PressureParams& p) {
  v.value("tolerance", p.tolerance,
          {.min = 1e-8, .max = 0.1, .help = "mean relative compression per step left by the pressure"});
  v.value("max_iterations", p.max_iterations, {.min = 1, .max = 10000, .help = "limit of the pressure's iterations"});
  v.value("density_time", p.density_time,
          {.min = 1, .max = 1000, .help = "time in which an error of density fades, in shortest capillary times"});
  v.value("spray_filling", p.spray_filling,
          {.min = 0, .max = 0.6, .help = "a particle whose kernel is filled less than this has no pressure"});
  v.value("corrected_gradients", p.corrected_gradients,
          {.help = "without surface tension: gradients of the pressure exact for linear flows; else liquid under pressure resists shear as if by dry friction"});
}

struct PressureReport {
  int iterations = 0;
  Real residual = 0;            // mean relative compression per step left
  Real density_error = 0;       // mean |e| before the step
  Real compression = 0;         // mean of max(0, C + lambda - 1) there: what particles at a surface lack is no error
  Real peak_density_error = 0;  // largest e before the step
  bool converged = true;
};

// Changes f.velocity to a divergence-free one; fills f.pressure [Pa] and f.wall_push = 2 k (acceleration by walls is
// -wall_push P). warm: k of the last step per particle, in and out. relaxation = dt/tau in (0, 1].
// sheets: soft sheets that move and give way (sheet_wall.h), their impulse booked at their feet; none: all walls stand.
PressureReport project_velocity(LiquidFields& f, const PressureParams& params, Real dt, Real relaxation,
                                std::vector<float>& warm, SheetContacts* sheets = nullptr);

// f.acceleration = a(k) of these pressures, Pa.
void pressure_response(LiquidFields& f, std::span<const float> pressure);

// f.acceleration = -a(k)/2 for the uniform pressure k = 1/(1 - lambda): what it does to each particle, 1/m. Away from walls, with
// plain gradients, the colour gradient.
void uniform_pressure_response(LiquidFields& f);

}  // namespace imbibe
