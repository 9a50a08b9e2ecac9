// The liquid's momentum over a step, whole in spite of single precision.
//
//   p' = p + m N g dt - sum_k J_k            p N s, J_k impulse that wall k got, m particle mass, N their number
//
// Forces between particles and by walls are equal and opposite until they are rounded to single precision, each side by
// itself, and so is every new velocity: the sum over the particles misses p' by some 1e-7 of all that was exchanged. What is
// missing is found in double and given to all particles alike, which changes no motion relative to each other; each is
// rounded to a velocity that can be stored, and its remainder goes to the next one. The last remainder goes to the slowest
// particle, whose velocity has the finest steps. So walls got what the liquid lost: to 1e-10 of sum m |v| with a hundred
// particles (half a step of single precision of one slow particle). That last part is given to a soft sheet that the liquid
// touches: the exchange with cloth is exact to double precision.
// More than rounding can have lost is not made up: an error in a stage of the step is to be seen.
// Tested in tests/liquid/momentum_test.cpp, and with soft sheets in tests/physics/seed_b_test.cpp.
#pragma once

#include <span>

#include "imbibe/liquid/particles.h"

namespace imbibe {

// Sums over the particles, m/s, in double and in a fixed order.
struct SpeedSums {
  Vec3 velocity{};
  Real speed = 0;
  SpeedSums& operator+=(const SpeedSums& o) { return velocity += o.velocity, speed += o.speed, *this; }
};
SpeedSums sum_speeds(std::span<const Float4> velocity);

// Changes the velocities so that their sum grows by `missing` m/s, evenly. Returns what could not be stored, m/s.
Vec3 spread_over_particles(std::span<Float4> velocity, const Vec3& missing);

// Makes the sum of the velocities that of `before` plus `given`, m/s, if it misses that by no more than rounding can: a
// hundred thousandth of the speeds and of `exchanged`, the sum of the changes of velocity that cancelled, m/s. Returns
// what could not be stored, m/s; 0 when it did nothing.
Vec3 make_up_rounding(std::span<Float4> velocity, const SpeedSums& before, const Vec3& given, Real exchanged);

}  // namespace imbibe
