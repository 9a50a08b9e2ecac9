#include "imbibe/coupling/release.h"

#include <algorithm>

namespace imbibe {
namespace {

bool is_free(const Particles& particles, const Vec3& place, Real clearance) {
  for (const Float4& x : particles.position) {
    const Vec3 d(x.x - place.x, x.y - place.y, x.z - place.z);
    if (squared_norm(d) < clearance * clearance) return false;
  }
  return true;
}

// Waiting mass of the nodes within reach of `centre`.
Real waiting_near(const FaceMap& map, const Vec3& centre, const ExchangeState& exchange) {
  Real sum = 0;
  map.near(centre.x, centre.y, [&](Index k) { sum += exchange.waiting_kg[k]; });
  return sum;
}

// Takes `kg` from the nodes near `centre`, each giving the same share of what it has.
void take_near(const FaceMap& map, const Vec3& centre, Real kg, Real present, ExchangeState& exchange) {
  map.near(centre.x, centre.y, [&](Index k) { exchange.waiting_kg[k] -= exchange.waiting_kg[k] * (kg / present); });
}

}  // namespace

Real release_speed(Real excess_pressure, Real density) {
  return excess_pressure > 0 ? std::sqrt(2 * excess_pressure / density) : 0;
}

ReleaseReport release_particles(const YarnNetwork& network, const Placement& placement, const FaceMap& map,
                                std::span<const Real> excess_pressure, const Vec3& gravity, ExchangeState& exchange,
                                Liquid& liquid) {
  ReleaseReport report;
  std::vector<Index> full;  // nodes with anything waiting, most first
  for (Index k = 0; k < exchange.waiting_kg.size(); ++k)
    if (exchange.waiting_kg[k] > 0) full.push_back(k);
  std::stable_sort(full.begin(), full.end(),
                   [&](Index a, Index b) { return exchange.waiting_kg[a] > exchange.waiting_kg[b]; });
  const Real mass = liquid.particle_mass, dx = liquid.spacing();
  const Real side = dot(gravity, placement.n) > 0 ? 1 : -1;  // the lower face
  for (const Index k : full) {
    const Vec3& centre = network.node_centre(k);
    const Real present = waiting_near(map, centre, exchange);
    if (present < mass) continue;
    const Vec3 place = placement.to_world({centre.x, centre.y, side * (0.5 * network.thickness + 0.5 * dx)});
    if (!is_free(liquid.particles, place, 0.8 * dx)) continue;
    const Real speed = excess_pressure.empty() ? 0 : release_speed(excess_pressure[k], liquid.kind.density);
    const Vec3 velocity = (side * speed) * placement.n;
    add_particle(liquid, place, velocity);
    take_near(map, centre, mass, present, exchange);
    ++report.particles;
    report.kg += mass;
    report.momentum += mass * velocity;
  }
  exchange.released_particles += report.particles;
  exchange.impulse -= report.momentum;
  return report;
}

}  // namespace imbibe
