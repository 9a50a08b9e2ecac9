#include "imbibe/liquid/particles.h"

#include "imbibe/core/error.h"

namespace imbibe {

void store(Float4& f, const Vec3& v) {
  f.x = static_cast<float>(v.x), f.y = static_cast<float>(v.y), f.z = static_cast<float>(v.z);
}

Index add_particle(Liquid& liquid, const Vec3& position, const Vec3& velocity) {
  Particles& p = liquid.particles;
  const std::size_t size = p.size() + 1;
  visit_arrays(p, [size](auto& array) { array.resize(size); });
  store(p.position.back(), position);
  store(p.velocity.back(), velocity);
  p.id.back() = liquid.next_id;
  p.kind.back() = ParticleClass::inside;
  p.density.back() = static_cast<float>(liquid.kind.density);
  return liquid.next_id++;
}

std::size_t remove_particles(Particles& particles, std::span<const std::uint8_t> dead) {
  const std::size_t before = particles.size();
  IMBIBE_ASSERT(dead.size() == before);
  visit_arrays(particles, [&](auto& array) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < before; ++i)
      if (dead[i] == 0) array[kept++] = array[i];
    array.resize(kept);
  });
  return before - particles.size();
}

}  // namespace imbibe
