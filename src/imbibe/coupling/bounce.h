// What a contact does to a particle that is not taken up: it bounces off the yarn or rests on it, and the textile gets
// the opposite impulse.
//
//   v' = v - (1 + e)(v.n) n - min(mu (1 + e)|v.n|, |v_t|) v_t / |v_t|,  v_t = v - (v.n) n
//
//   v, v'  m/s    velocity before and after, relative to the yarn's surface
//   n      1      outward unit normal of the yarn
//   e      1      restitution, 0..1
//   mu     1      Coulomb friction coefficient, >= 0
//
// e = 1, mu = 0 is the specular bounce at kept speed of seed A, section 5.1. Assumes that the yarn is much heavier than
// the particle. Holds for any step. Tested in tests/coupling/contact_test.cpp.
#pragma once

#include "imbibe/core/types.h"

namespace imbibe {

struct Bounce {
  Vec3 velocity{};            // m/s, of the particle afterwards
  Vec3 impulse_on_textile{};  // N s, exactly opposite to the particle's change of momentum
};

// A particle that moves away is left alone.
Bounce bounce(const Vec3& velocity, const Vec3& normal, Real mass, Real restitution = 1, Real friction = 0);

// A resting particle: friction takes all its motion relative to the yarn.
Bounce rest(const Vec3& velocity, Real mass);

}  // namespace imbibe
