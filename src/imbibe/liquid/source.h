// Where liquid comes from: drops, boxes of liquid, a timed dropper (a drop repeated), and a pipe.
//
// A drop is born as a ball, as an ellipsoid of its volume, or as a spherical cap on a level plane at its centre.
//   cap     of a sphere of cap_radius (drop_shape.h), whose centre is R cos a under the base
//   vortex  u = U sin(pi x/a) cos(pi y/b), v = -U (b/a) cos(pi x/a) sin(pi y/b), x and y from the box's corner, a x b its size
// A pipe lets go single particles at a steady rate, each from a random place inside its bore (counter-based random: seed,
// number of the particle), with a constant velocity along it. Particles due since the last step are carried on by what
// they would have flown. Where eight random places are all taken, the particle waits. A mouth
// that lies in liquid (`submerged`) would wait for ever: its particle takes the widest of the eight gaps instead, if it is
// 0.4 spacings or more, and pushes its neighbours away as any error of density does, by displacement without velocity.
// Particles are seeded on a lattice of the liquid's density, drops on a cubic one, boxes on a body-centred one whose kernel sum is
// that of liquid that has flowed (disorder_excess, kernel.h), 0.6 % denser. The supplied mass is exactly
// (number of particles) x (particle mass); the number is the wanted volume over the particle volume, rounded, and the difference is carried to
// the source's next drop, so a dropper's total is right to half a particle.
// A drop that would overlap liquid already there waits until the place is free: never two particles in one place.
#pragma once

#include <cstdint>
#include <string>

#include "imbibe/core/parameter.h"
#include "imbibe/core/types.h"
#include "imbibe/geometry/bounds.h"
#include "imbibe/liquid/particles.h"

namespace imbibe {

enum class SourceForm { drop, box, pipe };

struct Source {
  std::string name{};
  SourceForm form = SourceForm::drop;
  Vec3 centre{};             // m
  Real volume = 0;           // m3 of each drop; of a box, 0 = its size
  Vec3 size{};               // m, of a box
  Vec3 velocity{};           // m/s at birth
  Vec3 stretch{1, 1, 1};     // of a drop: relative half axes of its ellipsoid
  Real cap_angle = 0;        // rad, > 0: the drop is born as a spherical cap of this angle, `centre` the middle of its base
  Real vortex = 0;           // m/s, of a box: greatest speed of one Taylor-Green cell that fills it in x and y
  Real start = 0;            // s
  Real interval = 0;         // s between drops of a dropper
  int count = 1;             // drops; of a pipe, particles
  Real radius = 0;           // m, of a pipe's bore; its mouth is centred on `centre`, its axis lies along `velocity`
  Real length = 0;           // m, of the part of a pipe from whose random places particles start
  bool submerged = false;    // a pipe's mouth lies in liquid, which makes room for what it gives
  std::uint64_t seed = 1;    // of a pipe's random places

  // Progress (state, saved in checkpoints).
  int emitted = 0;           // drops
  Real carried = 0;          // m3 owed to the next drop by rounding
  Real supplied_kg = 0;
};

template <class V>
void describe(V& v, Source& s) {
  v.value("name", s.name, {.help = "name in the report"});
  v.choice("form", s.form, {{"drop", SourceForm::drop}, {"box", SourceForm::box}, {"pipe", SourceForm::pipe}},
           "a ball, a box, or a pipe of liquid");
  v.value("centre", s.centre, {.unit = "m", .shown = "mm", .required = true, .help = "centre at birth"});
  v.value("volume", s.volume, {.unit = "m3", .shown = "uL", .min = 0, .help = "volume of each drop"});
  v.value("size", s.size, {.unit = "m", .shown = "mm", .min = 0, .help = "edges of a box of liquid"});
  v.value("velocity", s.velocity, {.unit = "m/s", .help = "velocity at birth"});
  v.value("start", s.start, {.unit = "s", .min = 0, .help = "time of the first drop"});
  v.value("interval", s.interval, {.unit = "s", .min = 0, .help = "time between the drops of a dropper"});
  v.value("count", s.count, {.min = 1, .max = 1e6, .help = "number of drops of a dropper"});
}

struct EmitReport {
  std::size_t particles = 0;
  Real kg = 0;            // exactly particles * particle_mass
  bool waiting = false;   // a drop is due, but its place is still taken
};

// Emits what is due in [t0, t1) into the liquid and advances the source's progress. Drops due earlier that had to wait
// come first. New particles are appended (unsorted) with new ids.
EmitReport emit(Source& source, Liquid& liquid, Real t0, Real t1);

// The number of particles of drop `n` (counted from 0) of a source that starts with nothing carried; what `check` prints.
std::size_t particle_count(const Source& source, const Liquid& liquid);

// Where a source's drop will lie.
Bounds bounds_of(const Source& source);

// Time of the next drop, or infinity when the source is done.
Real next_emission(const Source& source);

}  // namespace imbibe
