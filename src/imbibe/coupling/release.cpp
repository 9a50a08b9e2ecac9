#include "imbibe/coupling/release.h"

#include <algorithm>

namespace imbibe {
namespace {

constexpr Real clear_of_others = 0.8;  // spacings: no particle is born nearer to another

// The particles beside the two faces, in sheet coordinates, by the bins of the face map.
class NearFaces {
 public:
  NearFaces(const Liquid& liquid, const YarnNetwork& network, const ClothPlace& cloth, const FaceMap& map)
      : map_(map), clearance_(clear_of_others * liquid.spacing()) {
    const Real reach = 0.5 * network.thickness + 2 * liquid.spacing();
    for (const Float4& x : liquid.particles.position) {
      const Vec3 p = cloth.to_sheet({x.x, x.y, x.z});
      if (std::abs(p.z) <= reach) places_.push_back({bin_of(p.x, p.y), p});
    }
    std::sort(places_.begin(), places_.end(), [](const Place& a, const Place& b) { return a.bin < b.bin; });
  }
  bool is_free(const Vec3& at) const {
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i) {
        const long bin = bin_of(at.x + i * map_.bin, at.y + j * map_.bin);
        for (auto place = first_of(bin); place != places_.end() && place->bin == bin; ++place)
          if (squared_norm(place->at - at) < clearance_ * clearance_) return false;
      }
    return true;
  }
  void add(const Vec3& at) {
    const long bin = bin_of(at.x, at.y);
    places_.insert(first_of(bin), {bin, at});
  }

 private:
  struct Place {
    long bin;
    Vec3 at;
  };
  long bin_of(Real x, Real y) const {
    return map_.row_of(y) * (map_.bins_x + 4L) + map_.column_of(x);
  }
  std::vector<Place>::const_iterator first_of(long bin) const {
    return std::lower_bound(places_.begin(), places_.end(), bin, [](const Place& p, long b) { return p.bin < b; });
  }
  const FaceMap& map_;
  Real clearance_;
  std::vector<Place> places_;
};

// Waiting mass of the nodes of a face within reach of `centre`.
Real waiting_near(const FaceMap& map, const Vec3& centre, bool upper, const ExchangeState& exchange) {
  Real sum = 0;
  map.near(centre.x, centre.y, upper, [&](const FaceMap::Node& n) { sum += exchange.waiting_kg[n.index]; });
  return sum;
}

// Takes `share` of what waits and moves at the nodes near `centre`; returns the momentum taken.
Real take_near(const FaceMap& map, const Vec3& centre, bool upper, Real share, std::vector<Real>& momentum,
               ExchangeState& exchange) {
  Real taken = 0;
  map.near(centre.x, centre.y, upper, [&](const FaceMap::Node& n) {
    const Index k = n.index;
    exchange.waiting_kg[k] -= share * exchange.waiting_kg[k];
    taken += share * momentum[k];
    momentum[k] -= share * momentum[k];
  });
  return taken;
}

}  // namespace

Real release_speed(Real excess_pressure, Real density, Real flow, Real mouth_area) {
  if (!(excess_pressure > 0) || !(flow > 0) || !(mouth_area > 0)) return 0;
  return std::min(std::sqrt(2 * excess_pressure / density), flow / mouth_area);
}

Real mouth_area(const YarnNetwork& network, Index node) {
  const std::size_t segments = network.segments();
  if (node >= segments) return network.pore_opening_x[node - segments] * network.pore_opening_y[node - segments];
  return pi * network.type_of_segment(node).radius * network.segment_length[node];
}

ReleaseReport release_particles(const YarnNetwork& network, const ClothPlace& cloth, const FaceMap& map,
                                std::span<const ReleasedLiquid> released, const Vec3& gravity, const SolidAt& solid_at,
                                ExchangeState& exchange, Liquid& liquid) {
  ReleaseReport report;
  const auto upper_first = [&](Index node) { return dot(gravity, cloth.normal_at(network.node_centre(node))) > 0; };
  // A node between other layers (its fibres swelled) gives off through the layer on the lower face.
  const auto at_face = [&](Index node) {
    if (map.on_upper[node] || map.on_lower[node]) return node;
    const std::size_t alike = network.is_pore(node) ? network.pores() : network.segments();
    const std::size_t per_layer = alike / static_cast<std::size_t>(network.layers);
    const int layers_off = (upper_first(node) ? 0 : network.layers - 1) - network.layer_of(node);
    return static_cast<Index>(static_cast<std::ptrdiff_t>(node) + layers_off * static_cast<std::ptrdiff_t>(per_layer));
  };
  // Liquid waits on the lower face, where the node has it.
  const auto waits_above = [&](Index node) { return upper_first(node) ? map.on_upper[node] != 0 : map.on_lower[node] == 0; };
  for (const ReleasedLiquid& r : released) exchange.waiting_kg[at_face(r.node)] += r.kg;
  if (liquid.particle_mass <= 0) return report;  // a scene without free liquid: what comes out waits on the face
  const Real mass = liquid.particle_mass, dx = liquid.spacing(), density = liquid.kind.density;
  std::vector<Index> full;  // nodes about which a particle's mass waits, most first
  for (Index k = 0; k < exchange.waiting_kg.size(); ++k)
    if (exchange.waiting_kg[k] > 0 && waiting_near(map, network.node_centre(k), waits_above(k), exchange) >= mass)
      full.push_back(k);
  if (full.empty()) return report;
  std::stable_sort(full.begin(), full.end(),
                   [&](Index a, Index b) { return exchange.waiting_kg[a] > exchange.waiting_kg[b]; });
  // What leaves now has its speed; the greatest excess says whether the other face opens too.
  std::vector<Real> momentum(exchange.waiting_kg.size(), 0), excess(exchange.waiting_kg.size(), 0);
  for (const ReleasedLiquid& r : released) {
    const Index k = at_face(r.node);
    momentum[k] += r.kg * release_speed(r.excess_pressure, density, r.flow, mouth_area(network, k));
    excess[k] = std::max(excess[k], r.excess_pressure);
  }
  NearFaces near(liquid, network, cloth, map);
  for (const Index k : full) {
    const Vec3& centre = network.node_centre(k);
    const Vec3 normal = cloth.normal_at(centre);
    const Real across = density * std::abs(dot(gravity, normal)) * network.thickness;  // Pa, from face to face
    const bool above = waits_above(k);
    const Real present = waiting_near(map, centre, above, exchange);
    if (present < mass) continue;
    const auto place_at = [&](Real side) { return Vec3{centre.x, centre.y, side * (0.5 * network.thickness + 0.5 * dx)}; };
    const auto closed = [&](Real side) { return solid_at && solid_at(cloth.to_world(place_at(side))); };
    Real side = above ? 1 : -1;
    const bool has_other = map.on_upper[k] && map.on_lower[k];
    if (has_other && (closed(side) || (!near.is_free(place_at(side)) && excess[k] >= across))) side = -side;
    const Vec3 place = place_at(side), world = cloth.to_world(place);
    if (!near.is_free(place) || closed(side)) continue;
    Vec3 velocity = (side * take_near(map, centre, above, mass / present, momentum, exchange) / mass) * normal;
    if (!cloth.is_flat()) velocity += cloth.velocity_at(centre);
    add_particle(liquid, world, velocity);
    near.add(place);
    ++report.particles;
    report.places.push_back(place);
    report.kg += mass;
    report.momentum += mass * velocity;
  }
  exchange.released_particles += report.particles;
  exchange.impulse -= report.momentum;
  return report;
}

}  // namespace imbibe
