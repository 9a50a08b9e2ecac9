#include "imbibe/liquid/damping.h"

namespace imbibe {

using simd::Floats;
using simd::Floats3;
using simd::Floats4;
using simd::lanes;

namespace {

// L(u) of the eight particles of a slice. W from its stored slope needs the distance anyway.
Floats3 kernel_difference(const LiquidFields& f, const std::vector<Float4>& u, const Slice& s) {
  const Kernel& kernel = f.neighbours.kernel;
  const Floats4 here = simd::load4(&f.position[s.first]), own = simd::load4(&u[s.first]);
  Floats3 sum{};
  for (std::size_t k = 0; k < s.slots; ++k) {
    const Index* id = s.index + k * lanes;
    const Floats3 x = here.xyz() - simd::load4(f.position.data(), id).xyz();
    const Floats4 other = simd::load4(u.data(), id);
    const Floats q = simd::sqrt(simd::dot(x, x)) * kernel.inverse, t = simd::max(1 - q, 0.0f), t2 = t * t;
    const Floats weight = t2 * t2 * (4 * q + 1);
    sum.x += weight * (other.x - own.x), sum.y += weight * (other.y - own.y), sum.z += weight * (other.z - own.z);
  }
  return sum * (Floats{} + f.volume * kernel.value_scale);
}

}  // namespace

void damp_small_scales(LiquidFields& f, float strength) {
  if (strength <= 0) return;
  for_each_slice(f.neighbours, [&](const Slice& s) {
    simd::store4(&f.acceleration[s.first], kernel_difference(f, f.velocity, s), Floats{});
  });
  for (std::size_t i = f.count; i < f.acceleration.size(); ++i) f.acceleration[i] = {};
  for_each_slice(f.neighbours, [&](const Slice& s) {
    const Floats3 twice = kernel_difference(f, f.acceleration, s);
    const Floats4 own = simd::load4(&f.velocity[s.first]);
    simd::store4(&f.direction[s.first],
                 Floats3{own.x - strength * twice.x, own.y - strength * twice.y, own.z - strength * twice.z}, Floats{});
  });
  for (std::size_t i = f.count; i < f.direction.size(); ++i) f.direction[i] = {};
  std::swap(f.velocity, f.direction);
}

}  // namespace imbibe
