// When the free liquid makes no SPH steps: it rests, and when it moves again.
//
// It rests when its shape does: centre and extents have stayed within a twentieth of a particle spacing for half the
// capillary time sqrt(rho R^3 / gamma) of a drop of all the liquid, and for the time in which it would fall a tenth.
// Particle speeds are no measure: a resting drop keeps a residual motion of 2-10 % of the capillary velocity inside. Falling,
// spreading, oscillating or running liquid leaves the band; so does a drop from which the textile drinks fast.
// Sums over all the liquid do not show what little of it does, so then every connected blob is looked at, once per
// window: one that nothing holds (no particle of it within a spacing of a solid or a sheet) falls, and one that slides
// faster than a tenth of its own capillary velocity runs. Then nothing rests, and the window begins anew.
// It moves again when 2 % of its particles are gone, or one has come.
// Tested in tests/sim/rest_test.cpp and tests/scenes/resting_test.cpp.
#pragma once

#include <vector>

#include "imbibe/liquid/fields.h"
#include "imbibe/sim/world.h"

namespace imbibe {

// Connected particles, of the fields of the last liquid step.
struct Blob {
  std::size_t particles = 0;
  bool held = false;  // a particle of it is within a spacing of a wall
  Vec3 velocity{};    // m/s, mean
};

// Particles nearer than 1.5 spacings are connected, but not through a sheet. In the order of their first particles.
std::vector<Blob> find_blobs(const LiquidFields& fields, const Particles& particles);

// Sets world.pace.resting where the liquid has come to rest. `fields`: of the step just made.
void judge_rest(World& world, const LiquidFields& fields);

void wake_when_changed(World& world);

}  // namespace imbibe
