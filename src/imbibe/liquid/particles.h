// The state of the free liquid: equal-mass particles. Plain and copyable; arrays in sorted (cell) order, so an index
// is valid only until the next step; `id` is for life.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "imbibe/core/portable.h"
#include "imbibe/core/types.h"

namespace imbibe {

// Bulk properties of a liquid. Data: liquids/*.yaml, with a source per value.
struct LiquidKind {
  std::string name = "water";
  Real density = 998.2;           // kg/m3
  Real viscosity = 1.002e-3;      // Pa s
  Real surface_tension = 0.0728;  // N/m
};

// Where a particle lies (seed A section 6), from the gradient of the colour field.
enum class ParticleClass : std::uint8_t { inside = 0, liquid_vapour = 1, liquid_solid = 2 };

// 16-byte record that vector loops load as one row.
struct alignas(16) Float4 {
  float x = 0, y = 0, z = 0, w = 0;
};

struct Particles {
  std::vector<Float4> position;  // m; w is scratch of the solver
  std::vector<Float4> velocity;  // m/s; w is scratch of the solver
  std::vector<Index> id;
  std::vector<ParticleClass> kind;
  std::vector<float> density;          // kg/m3, for output
  std::vector<float> pressure;         // Pa, for output and exchange, time-averaged over a few steps
  std::vector<float> warm_pressure;    // solver warm starts
  std::vector<float> warm_divergence;
  std::vector<Real> owed_kg;           // kg, of the particle's mass that a textile has taken already

  std::size_t size() const { return position.size(); }
};

// Calls visit(array) for every array of the particles: the one list of them, for sorting, removing and appending.
template <class AnyParticles, class Visit>
void visit_arrays(AnyParticles& p, Visit&& visit) {
  visit(p.position), visit(p.velocity), visit(p.id), visit(p.kind), visit(p.density), visit(p.pressure),
      visit(p.warm_pressure), visit(p.warm_divergence), visit(p.owed_kg);
}

struct Liquid {
  LiquidKind kind;
  Real particle_mass = 0;  // kg, the same for all
  Index next_id = 0;
  Particles particles;
  Real spacing() const { return portable::cbrt(particle_mass / kind.density); }  // m, dx
  Real mass() const { return particle_mass * static_cast<Real>(particles.size()); }
};

// Rounds v into f; w stays. Not inline on purpose: g++ 12 reads back what it has just rounded WITHOUT the rounding where its
// vectoriser sees both, so that the impulse booked for a bounce was not that of the velocity kept, and clang had other bits.
void store(Float4& f, const Vec3& v);

// Appends a particle with a new id, at rest density and without warm start. Returns the id.
Index add_particle(Liquid& liquid, const Vec3& position, const Vec3& velocity);

// Removes the particles with dead[i] != 0; the others keep their order. Returns how many were removed.
std::size_t remove_particles(Particles& particles, std::span<const std::uint8_t> dead);

}  // namespace imbibe
