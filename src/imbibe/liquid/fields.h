// The arrays the passes of one liquid step share. Caches of the step, not state: sized in begin_fields, never shrunk, so
// steps do not allocate once the particle count is steady. All are padded (padded_size, neighbours.h): whole slices can
// be loaded and stored, and index `dummy` is the far dummy whose values stay 0 (position: far away).
#pragma once

#include <vector>

#include "imbibe/liquid/boundary.h"
#include "imbibe/liquid/neighbours.h"
#include "imbibe/liquid/particles.h"

namespace imbibe {

struct LiquidFields {
  std::size_t count = 0;
  float spacing = 0;           // dx, m
  float volume = 0;            // V = m/rho0 = dx^3, m3
  float particle_mass = 0;     // kg
  float rest_density = 0;      // kg/m3
  struct LatticeSums {         // kernel.h; kept while H/dx stays
    Real ratio = 0;
    float excess = 0, stress = 0;  // the excess with disorder_excess
  } lattice;
  Neighbours neighbours;
  Boundary boundary;

  std::vector<Float4> position;       // m; w free for the solver running
  std::vector<Float4> position_swap;  // same xyz; for a solver that writes w while others read it
  std::vector<Float4> velocity;       // m/s
  std::vector<Float4> acceleration;   // m/s2, work space of the stage running
  std::vector<Float4> force;          // m/s2: surface tension and contact line (written by the surface stage)
  std::vector<Float4> shift;          // m/s, moves particles without being part of their velocity
  std::vector<Float4> direction;      // work space of solvers
  std::vector<Float4> residual;
  std::vector<float> filling;         // C_i + lambda_i: density / rest density, walls included
  std::vector<float> colour;          // C_i = V sum W (own included), liquid only
  std::vector<Float4> colour_gradient;  // xyz = V sum grad W over liquid neighbours [1/m], w free
  std::vector<float> factor;          // solver's diagonal
  std::vector<float> source;          // solver's right side
  std::vector<float> density_error;   // relative, air completed (density.h)
  std::vector<float> applied;         // work space of solvers
  std::vector<float> pressure;        // Pa, of the projection
  std::vector<float> wall_push;       // acceleration by the walls' pressure is -wall_push_i P_i; m2/s2
  bool corrected = false;             // the pressure's operator uses L
  std::vector<Float4> correction;     // three rows a particle: L of gradient_correction.h
  std::vector<Float4> stress;         // three rows a particle: k L, and x, y, z in the rows' w; work space of pressure.cpp
  std::vector<float> sheet_rate;      // 2 w.P by the soft sheets' motion, 1/s; only with such sheets
  std::vector<SheetFoot*> feet;       // on soft sheets, by rising particle
  std::vector<std::uint8_t> surface;  // set by the class stage: 1 = free surface (pressure is prescribed there)
};

// Sizes every array for the sorted particles (sort_particles first: it sets the kernel) and copies position and velocity in.
void begin_fields(LiquidFields& f, const Liquid& liquid);

}  // namespace imbibe
