#include "imbibe/coupling/hem_drops.h"

#include <algorithm>
#include <array>

#include "imbibe/core/portable.h"
#include "imbibe/coupling/footprint.h"
#include "imbibe/geometry/direction.h"
#include "imbibe/liquid/occupancy.h"

namespace imbibe {
namespace {

constexpr Real neck_of_capillary_length = 0.75;
constexpr Real steep = 0.5;  // cosine from which an edge looks down: drops run off steeper ones

Real edge_distance(const YarnNetwork& n, const Vec3& c) {
  return std::min(0.5 * n.size_x - std::abs(c.x), 0.5 * n.size_y - std::abs(c.y));
}

// The point of the outline nearest to a node, and the direction out of the cloth there, in the world.
struct EdgePoint {
  Vec3 at{}, outward{};
};
EdgePoint edge_near(const YarnNetwork& n, const ClothPlace& place, const Vec3& c) {
  const bool along_x = 0.5 * n.size_x - std::abs(c.x) < 0.5 * n.size_y - std::abs(c.y);
  Vec3 edge{c.x, c.y, 0}, inside = edge;
  const Real step = 2 * std::max(n.pitch_x, n.pitch_y);
  if (along_x)
    edge.x = std::copysign(0.5 * n.size_x, c.x), inside.x = edge.x - std::copysign(step, c.x);
  else
    edge.y = std::copysign(0.5 * n.size_y, c.y), inside.y = edge.y - std::copysign(step, c.y);
  const Vec3 at = place.to_world(edge);
  return {at, normalized(at - place.to_world(inside))};
}

// Where drops of these nodes may be born.
Bounds region_of(const YarnNetwork& n, const ClothPlace& place, std::span<const Index> nodes, Real around) {
  Bounds region;
  for (const Index k : nodes) region.include(edge_near(n, place, n.node_centre(k)).at);
  region.grow(around);
  return region;
}

}  // namespace

std::vector<Vec3> hanging_drop(std::size_t count, Real spacing, Real top, const Vec3& down) {
  const Vec3 a = any_perpendicular(down), b = cross(down, a);
  const int reach = static_cast<int>(std::ceil(portable::cbrt(static_cast<Real>(count)))) + 1;
  std::vector<std::array<int, 3>> points;
  for (int k = -reach; k <= reach; ++k)
    for (int j = -reach; j <= reach; ++j)
      for (int i = -reach; i <= reach; ++i) points.push_back({k, j, i});
  const auto square = [](const std::array<int, 3>& p) { return p[0] * p[0] + p[1] * p[1] + p[2] * p[2]; };
  std::sort(points.begin(), points.end(), [&](const auto& p, const auto& q) {
    return square(p) != square(q) ? square(p) < square(q) : p > q;  // among equals the lower ones: a drop hangs
  });
  points.resize(count);
  int highest = reach;
  for (const auto& p : points) highest = std::min(highest, p[0]);
  std::vector<Vec3> places;
  for (const auto& p : points)
    places.push_back(spacing * ((p[0] - highest + top) * down + Real(p[1]) * a + Real(p[2]) * b));
  return places;
}

Real hem_neck(Real surface_tension, Real density, Real gravity) {
  return gravity > 0 ? neck_of_capillary_length * std::sqrt(surface_tension / (density * gravity)) : 0;
}

void find_hem(const YarnNetwork& network, const ClothPlace& place, const Vec3& gravity, Real neck, Hem& hem) {
  hem.holds.assign(network.nodes(), 0);
  hem.nodes.clear();
  const Real g = norm(gravity);
  if (!(g > 0)) return;
  for (Index k = 0; k < network.nodes(); ++k) {
    const Vec3& c = network.node_centre(k);
    if (edge_distance(network, c) > neck) continue;
    if (!(dot(edge_near(network, place, c).outward, gravity) > steep * g)) continue;
    hem.holds[k] = 1;
    hem.nodes.push_back(k);
  }
}

std::vector<HangingDrop> drops_at_hem(const YarnNetwork& network, const ClothPlace& place, const Hem& hem, Real neck,
                                      const ExchangeState& exchange) {
  const auto near = [&](Index a, Index b) { return norm(network.node_centre(a) - network.node_centre(b)) <= 2 * neck; };
  std::vector<HangingDrop> drops;
  for (const auto& [node, kg] : gather_drops(hem.nodes, exchange.waiting_kg, near))
    drops.push_back({edge_near(network, place, network.node_centre(node)).at, kg});
  return drops;
}

CaughtAtHem catch_at_hem(const YarnNetwork& network, const ClothPlace& place, const Hem& hem, const Vec3& gravity,
                         Real neck, SoftSheet& soft, std::span<const std::uint8_t> held, ExchangeState& exchange,
                         Liquid& liquid, std::span<std::uint8_t> dead) {
  CaughtAtHem caught;
  if (hem.nodes.empty()) return caught;
  const Real stopped = 2 * norm(gravity) * neck, reach_z = 0.5 * network.thickness + touch_distance(liquid.spacing());
  Particles& particles = liquid.particles;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const Float4 &x = particles.position[i], &v = particles.velocity[i];
    const Vec3 p = place.to_sheet({x.x, x.y, x.z});
    if (!(std::abs(p.z) < reach_z) || edge_distance(network, p) > neck) continue;
    const Vec3 velocity(v.x, v.y, v.z);
    if (squared_norm(velocity - place.velocity_at(p)) > stopped) continue;
    const Index node = *std::min_element(hem.nodes.begin(), hem.nodes.end(), [&](Index a, Index b) {
      return squared_norm(network.node_centre(a) - p) < squared_norm(network.node_centre(b) - p);
    });
    if (norm(network.node_centre(node) - p) > neck) continue;  // at an edge that holds no drops
    const Real owed = particles.owed_kg[i];
    exchange.waiting_kg[node] += liquid.particle_mass - owed;
    join_sheet(soft, held, place.surface_point(p), liquid.particle_mass, velocity);
    particles.owed_kg[i] = 0, dead[i] = 1;
    caught.owed_kg += owed, ++caught.particles;
  }
  exchange.absorbed_particles += caught.particles;
  return caught;
}

ReleaseReport release_hem_drops(const YarnNetwork& network, const ClothPlace& place, const Hem& hem, const Vec3& gravity,
                                Real neck, const SolidAt& solid_at, ExchangeState& exchange, Liquid& liquid) {
  ReleaseReport report;
  const Real mass = liquid.particle_mass, spacing = liquid.spacing();
  if (mass <= 0) return report;
  Real total = 0;
  for (const Index k : hem.nodes) total += std::max(exchange.waiting_kg[k], 0.0);
  const Real falling = falling_drop_kg(neck, liquid.kind.surface_tension, norm(gravity));
  if (total < std::max(mass, falling)) return report;
  std::vector<Index> waiting;
  for (const Index k : hem.nodes)
    if (exchange.waiting_kg[k] > 0) waiting.push_back(k);
  const auto count = static_cast<std::size_t>(std::max(1.0, std::round(falling / mass)));
  const Real drop_kg = static_cast<Real>(count) * mass;
  const Vec3 down = normalized(gravity);
  const std::vector<Vec3> drop = hanging_drop(count, spacing, hanging_spacings, down);
  std::stable_sort(waiting.begin(), waiting.end(),
                   [&](Index a, Index b) { return exchange.waiting_kg[a] > exchange.waiting_kg[b]; });
  Occupancy occupancy;
  occupancy.reset(liquid.particles.position, region_of(network, place, waiting, norm(drop.back()) + 4 * spacing),
                  clear_spacings * spacing);
  for (const Index k : waiting) {
    const Vec3& centre = network.node_centre(k);
    const auto near = [&](Index other) { return norm(network.node_centre(other) - centre) <= 2 * neck; };
    Real present = 0;
    for (const Index other : waiting) present += near(other) ? exchange.waiting_kg[other] : 0;
    if (present < drop_kg) continue;
    const Vec3 from = edge_near(network, place, centre).at;
    const auto free = [&](const Vec3& p) { return occupancy.is_free(from + p) && !(solid_at && solid_at(from + p)); };
    const bool stream = present > drops_of_a_stream * drop_kg;
    if (!stream && !std::all_of(drop.begin(), drop.end(), free)) continue;
    std::size_t born = 0;
    for (const Vec3& p : drop) {
      if (stream && !free(p)) continue;
      const Vec3 velocity = place.velocity_at(centre);
      add_particle(liquid, from + p, velocity);
      occupancy.add(from + p);
      report.places.push_back(centre), report.momentum += mass * velocity;
      ++born;
    }
    const Real taken = static_cast<Real>(born) * mass;
    for (const Index other : waiting)
      if (near(other)) exchange.waiting_kg[other] -= taken / present * exchange.waiting_kg[other];
    report.particles += born, report.kg += taken;
  }
  exchange.released_particles += report.particles;
  exchange.impulse -= report.momentum;
  return report;
}

}  // namespace imbibe
