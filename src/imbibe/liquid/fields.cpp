#include "imbibe/liquid/fields.h"

namespace imbibe {

void begin_fields(LiquidFields& f, const Liquid& liquid) {
  const Particles& p = liquid.particles;
  f.count = p.size();
  f.spacing = static_cast<float>(liquid.spacing());
  f.volume = static_cast<float>(liquid.particle_mass / liquid.kind.density);
  f.particle_mass = static_cast<float>(liquid.particle_mass);
  f.rest_density = static_cast<float>(liquid.kind.density);
  const Real ratio = static_cast<Real>(f.neighbours.kernel.support) / static_cast<Real>(f.spacing);
  if (ratio != f.lattice.ratio) {
    f.lattice = {ratio, static_cast<float>(lattice_excess(ratio) + disorder_excess), static_cast<float>(lattice_stress(ratio))};
  }
  const std::size_t padded = padded_size(f.count);
  for (auto* array : {&f.position, &f.position_swap, &f.velocity, &f.acceleration, &f.force, &f.colour_gradient,
                      &f.direction, &f.residual, &f.shift}) {
    array->resize(padded);
    for (std::size_t i = f.count; i < padded; ++i) (*array)[i] = {};
  }
  for (auto* array : {&f.filling, &f.colour, &f.factor, &f.source, &f.density_error, &f.applied, &f.pressure,
                      &f.wall_push}) {
    array->resize(padded);
    for (std::size_t i = f.count; i < padded; ++i) (*array)[i] = 0;
  }
  f.corrected = false;
  f.surface.assign(padded, 0);
  pad_positions(f.position, f.count);
  pad_positions(f.position_swap, f.count);
  parallel_for(f.count, [&](std::size_t i) {
    const Float4 &x = p.position[i], &u = p.velocity[i];
    f.position[i] = f.position_swap[i] = {x.x, x.y, x.z, 0};
    f.velocity[i] = {u.x, u.y, u.z, 0};
  }, 4096);
}

}  // namespace imbibe
