#include "imbibe/verify/resting.h"

#include <algorithm>
#include <cmath>

#include "imbibe/liquid/drop_measure.h"

namespace imbibe::verify {

Real volume_of(Real radius) { return 4 * pi / 3 * radius * radius * radius; }

std::string resolution(Real volume, Real across) {
  const Real spacing = std::cbrt(3 * volume / (4 * pi)) / across;
  return set("liquid.particle_mass", water_density * spacing * spacing * spacing, "kg");
}

Real capillary_time(const World& w, Real radius) {
  return std::sqrt(w.liquid.kind.density * radius * radius * radius / w.liquid.kind.surface_tension);
}

Moments moments(const Liquid& liquid) {
  Moments m;
  const auto n = static_cast<Real>(liquid.particles.size());
  for (std::size_t i = 0; i < liquid.particles.size(); ++i) {
    const Float4 &x = liquid.particles.position[i], &u = liquid.particles.velocity[i];
    m.centre += Vec3{x.x, x.y, x.z} / n, m.momentum += liquid.particle_mass * Vec3{u.x, u.y, u.z};
    m.speed += (u.x * u.x + u.y * u.y + u.z * u.z) / n;
  }
  for (const Float4& p : liquid.particles.position) {
    const Vec3 d = Vec3{p.x, p.y, p.z} - m.centre;
    m.xx += d.x * d.x / n, m.yy += d.y * d.y / n, m.zz += d.z * d.z / n;
  }
  m.speed = std::sqrt(m.speed);
  return m;
}

Resting settle(CaseRunner& runner, const std::string& scene, std::vector<std::string> o, Real units, World* kept) {
  const World at_start = runner.world(scene, o);
  const Real volume = at_start.sources[0].volume, unit = capillary_time(at_start, std::cbrt(3 * volume / (4 * pi)));
  const Real end = units * unit, from = end - averaged * unit;
  o.push_back(set("duration", end, "s"));
  o.push_back(set("output.every", 0.1 * unit, "s"));
  Resting mean;
  Real count = 0, steps = 0;
  const Plane frame{at_start.sources[0].centre, {0, 0, 1}};
  const Shape solid = at_start.solids.empty() ? Shape(frame) : at_start.solids[0].shape;
  World w = runner.run(scene, o, [&](const World& now, const StepReport&) {
    if (now.time < from) return;
    const DropMeasure d = measure_drop_on(now.liquid, solid, frame, norm(now.gravity));
    mean.fit += degrees(d.fit_angle), mean.slope += degrees(d.slope_angle), mean.base += d.base_radius, mean.height += d.height, mean.volume += d.volume;
    mean.base_slope += degrees(d.base_slope);
    mean.speed += moments(now.liquid).speed;
    count += 1;
  }, [&](const World& now, const StepReport& step) {
    if (now.time >= from) mean.force += step.surface_force.z, steps += 1;
  });
  mean.fit /= count, mean.slope /= count, mean.base /= count, mean.height /= count, mean.volume /= count, mean.speed /= count;
  mean.base_slope /= count;
  mean.force /= std::max(steps, 1.0);
  if (kept) *kept = std::move(w);
  return mean;
}

void add_shape_checks(CaseResult& r, const std::string& name, const Resting& d, const World& w, Real base_radius, Real height) {
  const Real volume = w.sources[0].volume, gamma = w.liquid.kind.surface_tension;
  r.checks.push_back(near(name + "base radius", 1e3 * d.base, 1e3 * base_radius, "mm", 0.05, "project's goal"));
  r.checks.push_back(near(name + "height", 1e3 * d.height, 1e3 * height, "mm", 0.05, "project's goal"));
  r.checks.push_back(near(name + "volume", 1e9 * d.volume, 1e9 * volume, "uL", 0.005, "project's goal"));
  r.checks.push_back(near(name + "net vertical surface force", 1e6 * d.force, -1e6 * 2 * pi * d.base * gamma * std::sin(radians(d.base_slope)), "uN", 0.05,
                          "-2 pi a gamma sin(slope of the surface at the base) of the shape shown"));
}

}  // namespace imbibe::verify
