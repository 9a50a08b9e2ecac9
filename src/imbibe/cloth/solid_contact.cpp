#include "imbibe/cloth/solid_contact.h"

#include <algorithm>

#include "imbibe/cloth/liquid_bridge.h"

namespace imbibe {
namespace {

constexpr Real leading_out_time = 0.01;  // s in which a node that starts inside a solid is led out
constexpr int path_samples = 64;

struct Approach {
  SurfaceSample start, contact;  // contact: at the first point of the path that is too near, or at its end
  Vec3 place{};                  // that point
  bool too_near = false;
};

// Follows from + t * step in steps of the distance still free.
Approach follow(const Shape& shape, const Vec3& from, const Vec3& step, Real reach) {
  Approach a;
  a.start = a.contact = nearest_surface(shape, from);
  a.place = from;
  const Real length = norm(step);
  if (a.start.distance - reach > length) return a;
  Real travelled = 0;
  const Real least = std::max(0.25 * reach, length / path_samples);
  while (true) {
    if (a.contact.distance < reach && (travelled > 0 || length == 0 || dot(a.contact.normal, step) < 0)) break;
    if (travelled >= length) return a;
    travelled = std::min(length, travelled + std::max(least, a.contact.distance - reach));
    a.place = from + (travelled / length) * step;
    a.contact = nearest_surface(shape, a.place);
  }
  a.too_near = true;
  return a;
}

}  // namespace

Real rise_between_nodes(const Shape& shape, Real edge) {
  // The circle through the corners has the radius edge/sqrt(2); the rise over its middle, no more than of a half ball.
  const auto over = [&](Real radius) { return std::min(0.25 * edge * edge / radius, radius); };
  if (const auto* ball = std::get_if<Sphere>(&shape)) return over(ball->radius);
  if (const auto* rod = std::get_if<Cylinder>(&shape)) return over(rod->radius);
  return 0;
}

SolidTouch touch_solid(const ClothSolid& solid, const Vec3& moved, const SolidNode& node, Real dt) {
  // In the frame of the solid.
  const Vec3 from = node.position - moved, relative = node.velocity - solid.velocity;
  const Real reach = node.half_thickness;
  const Approach a = follow(solid.shape, from, dt * relative, reach);
  SolidTouch touch{.clearance = a.start.distance - reach - (node.pull > 0 ? bridge_length : 0)};
  const bool bridged = node.pull > 0 && a.start.distance - reach < bridge_length;
  if (!a.too_near && !bridged) return touch;
  touch.touches = true;
  touch.clearance = 0;
  const Vec3& n = a.too_near ? a.contact.normal : a.start.normal;
  const Real mass = 1 / node.inverse_mass, along_normal = dot(relative, n);
  // Height over the face that it meets, taken as flat. Speed along n at which the node just reaches it; a node that is
  // inside is led out.
  const Real gap = a.start.distance < reach ? a.start.distance - reach
                                            : dot(from - a.place, n) + a.contact.distance - reach;
  const Real wanted = gap >= 0 ? -gap / dt : -gap / leading_out_time;
  Real normal_impulse = mass * (wanted - along_normal);
  if (normal_impulse < 0) {
    // Leaving: only the bridges hold, and no more than brings the node to rest.
    normal_impulse = -std::min({node.pull * dt, -normal_impulse, mass * std::max(Real{0}, along_normal)});
  }
  const Vec3 sliding = relative - along_normal * n;
  const Real speed = norm(sliding);
  const Real pressing = std::max(Real{0}, normal_impulse) + (bridged ? node.pull * dt : 0);
  const Real stopped = speed > 0 ? std::min(Real{1}, solid.friction * pressing * node.inverse_mass / speed) : 0;
  touch.impulse = normal_impulse * n - (mass * stopped) * sliding;
  return touch;
}

}  // namespace imbibe
