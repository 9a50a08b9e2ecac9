#include "imbibe/liquid/surface_tension.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "imbibe/core/union_find.h"
#include "imbibe/liquid/classes.h"
#include "imbibe/liquid/pressure.h"
#include "imbibe/liquid/tangent_fit.h"

namespace imbibe {

namespace {

// |n| H below which a particle is inside and carries no surface force.
constexpr float carries_force = 0.05f;

Vec3f xyz(const Float4& v) { return {v.x, v.y, v.z}; }

// Calls body(j, x_i - x_j) for every neighbour j of i that passes the test; the others cost next to nothing.
template <class Test, class Body>
void each_neighbour(const LiquidFields& f, std::size_t i, Test&& test, Body&& body) {
  const std::size_t lane = i % simd::lanes;
  const Slice s = f.neighbours.slice(i - lane);
  const Vec3f here = xyz(f.position[i]);
  const Index* id = s.index + lane;
  for (std::size_t k = 0; k < s.slots; ++k, id += simd::lanes) {
    if (*id >= f.count) break;  // padding ends every list
    if (test(*id)) body(*id, here - xyz(f.position[*id]));
  }
}

template <class Body>
void each_surface_neighbour(const LiquidFields& f, std::size_t i, Body&& body) {
  each_neighbour(f, i, [&](Index j) { return f.surface[j] != 0; }, body);
}

struct Stage {
  LiquidFields& f;
  const SurfaceParams& params;
  SurfaceScratch& s;
  float gamma;
  std::span<const Wall> walls;
  float weight(float distance) const { return f.volume * f.neighbours.kernel.value(distance); }
  float depth() const { return static_cast<float>(params.offset) * f.spacing; }  // of surface particles
  float least_spread() const { return 1e-3f * f.spacing * f.spacing; }           // of a surface to be fitted, m2
};

// 0 below `from`, 1 above `to`: every switch of this stage is gradual, since a step in a force heats the liquid.
float ramp(float value, float from, float to) { return std::clamp((value - from) / (to - from), 0.0f, 1.0f); }

// Wetness of the wall of one sample: the kernel sum of i's neighbourhood at the foot point.
float wetness_of(const Stage& t, std::size_t i, const WallSample& wall) {
  if (t.f.filling[i] > 0.97f) return 1;  // liquid all around, down to the wall
  const Vec3f foot = wall.normal * wall.distance;  // x_i - x_F
  float sum = t.weight(norm(foot));
  each_neighbour(t.f, i, [](Index) { return true; },
                 [&](Index, const Vec3f& x) { sum += t.weight(norm(x - foot)); });
  return wall_wetness(2 * sum, static_cast<float>(t.params.contact.wet_from),
                      static_cast<float>(t.params.contact.wet_to));
}

// 1 in the first layer of particles on a wall, 0 from the second on.
float first_layer(float distance, float spacing) { return std::clamp(2 - distance / (0.8f * spacing), 0.0f, 1.0f); }

// How far the surface with this (not normalised) inward normal runs along a wall: 0 from 45 degrees on, 1 below 26.
float lies_along(const Vec3f& normal, float length, const Vec3f& wall) {
  return length > 0 ? ramp(-dot(normal, wall) / length, 0.7f, 0.9f) : 0;
}

// Colour gradient with wetted walls, filling, set S and the particle's class.
void mark_surface(const Stage& t, std::size_t i, ParticleClass& kind) {
  LiquidFields& f = t.f;
  Vec3f n = xyz(f.colour_gradient[i]);
  float dry = 1, nearest = 1e6f;
  Vec3f nearest_wall{};
  bool woven = false;
  for (const WallSample& wall : f.boundary.samples(i)) {
    const float beta = wetness_of(t, i, wall);
    n += wall.gradient * beta;
    dry *= 1 - beta * wall.lambda;
    if (wall.distance >= nearest * f.spacing) continue;
    nearest = wall.distance / f.spacing, nearest_wall = wall.normal, woven = t.walls[wall.wall].two_sided;
  }
  const float length = norm(n), gradient_h = length * f.neighbours.kernel.support;
  const float filling = f.colour[i] + (1 - dry);
  // At a line the first layer sees the kink of surface and wall, not the surface. Where the surface runs along the wall both
  // have one normal: a film of one layer and the thin rim of a flat drop have their curvature as any surface. A woven face is
  // as rough as a layer is thick: on wet cloth a puddle of two layers would pull holes into itself and never come to rest.
  const float along = woven ? 0 : lies_along(n, length, nearest_wall);
  const float layer = first_layer(nearest, 1) * (1 - along);
  kind = particle_class(gradient_h, filling, nearest);
  const float reliability = ramp(gradient_h, 0.2f, 0.4f) * ramp(-filling, -0.95f, -0.89f) *
                            ramp(f.colour[i], 0.2f, 0.3f) * ramp(-layer, -0.6f, -0.4f);
  t.s.reliability[i] = reliability;
  f.surface[i] = reliability > 0;
  t.s.gradient[i] = {n.x, n.y, n.z, gradient_h};
  const Vec3f unit = length > 0 ? n / length : Vec3f{};
  t.s.normal[i] = {unit.x, unit.y, unit.z, 0};
}

// The surface around i in S, values(j) -> two values above those at i.
template <class Values>
TangentFit surface_fit(const Stage& t, std::size_t i, Values&& values) {
  const Vec3f normal = xyz(t.s.normal[i]);
  TangentFit fit(normal, t.s.reliability[i]);
  each_surface_neighbour(t.f, i, [&](Index j, const Vec3f& to_here) {
    if (dot(xyz(t.s.normal[j]), normal) <= 0) return;
    const float near = std::max(0.0f, 1 - norm(to_here) * t.f.neighbours.kernel.inverse);
    const auto [v1, v2] = values(fit, j);
    fit.add(near * near * near * t.s.reliability[j], -to_here, v1, v2);
  });
  return fit;
}

// kappa of the liquid's surface at i in S, and how far it can be trusted: near the rim of S it cannot.
void fit_curvature(const Stage& t, std::size_t i) {
  const Vec3f here = xyz(t.s.normal[i]);
  const TangentFit fit = surface_fit(t, i, [&](const TangentFit& axes, Index j) {
    const Vec3f change = xyz(t.s.normal[j]) - here;
    return std::pair(dot(change, axes.first()), dot(change, axes.second()));
  });
  const auto [s11, s12, s21, s22] = fit.slopes(t.least_spread());
  const float centres = -(s11 + s22), gauss = s11 * s22 - 0.25f * (s12 + s21) * (s12 + s21), d = t.depth();
  // From the surface through the centres to the liquid's, outside it by d (parallel surfaces).
  const float stretch = std::max(1 + d * centres + d * d * gauss, 0.2f), limit = 0.6f / t.f.spacing;
  t.s.normal[i].w = std::clamp((centres + 2 * d * gauss) / stretch, -limit, limit);
  t.s.trust[i] = t.s.reliability[i] * ramp(-fit.lopsidedness(), -0.3f, -0.1f);
}

// Curvature off S by the kernel mean over S, and the drop a particle belongs to.
void extend(const Stage& t, std::size_t i) {
  const float own = t.s.reliability[i], trust = t.s.trust[i];
  t.s.owner[i] = own > 0 ? static_cast<Index>(i) : no_index;
  t.s.curvature[i] = t.s.normal[i].w;
  if (trust == 1) return;
  if (own == 0 && t.s.gradient[i].w < carries_force) {
    t.s.curvature[i] = 0;
    return;
  }
  float sum = 0, weights = 0, heaviest = 0;
  each_surface_neighbour(t.f, i, [&](Index j, const Vec3f& x) {
    const float kernel = t.weight(norm(x)), w = kernel * (t.s.trust[j] + 0.01f * t.s.reliability[j]);
    sum += w * t.s.normal[j].w, weights += w;
    if (own == 0 && kernel > heaviest) heaviest = kernel, t.s.owner[i] = j;
  });
  const float mean = weights > 1e-6f ? sum / weights : t.s.curvature[i];
  t.s.curvature[i] = trust * t.s.curvature[i] + (1 - trust) * mean;
}

// The interface as particle i, near the line, sees it: kernel means over reliable neighbours.
struct NearInterface {
  Vec3f normal{};
  float curvature = 0, height = 0;  // of those particles over the wall
  float trust = 0;                  // 0: no such particle is near
};

NearInterface near_interface(const Stage& t, std::size_t i, const WallSample& wall) {
  NearInterface seen;
  float weights = 0;
  const auto add = [&](std::size_t j, const Vec3f& to_here) {
    const float w = t.weight(norm(to_here)) * t.s.reliability[j];
    seen.normal += xyz(t.s.normal[j]) * w;
    seen.curvature += w * t.s.curvature[j];
    seen.height += w * (wall.distance - dot(to_here, wall.normal));
    weights += w;
  };
  if (t.f.surface[i]) add(i, {});
  each_surface_neighbour(t.f, i, [&](Index j, const Vec3f& x) { add(j, x); });
  if (weights <= 1e-6f) return seen;
  seen.normal = normalized(seen.normal);
  seen.curvature /= weights, seen.height /= weights;
  seen.trust = ramp(weights, 0, 0.004f);
  return seen;
}

struct LinePull {
  float curvature = 0;  // of the interface near
  Vec3f force{};        // N on the particle, along the wall
  float length = 0;     // m, of the line that the particle stands for
  float drag = 0;       // 1/s
  Vec3f inward{};                   // unit, along the wall
  float hold_in = 0, hold_out = 0;  // N, most that hysteresis holds against motion inward and outward
  float activity = 0;   // 0..1
};

// |G| of one wall as it were without the others, whose liquid parts it is weighted with (boundary.h).
float bare_gradient(const Stage& t, std::size_t i, const WallSample& wall) {
  float others = 1;
  for (const WallSample& other : t.f.boundary.samples(i))
    if (other.wall != wall.wall) others *= std::max(1 - other.lambda, 0.1f);
  return norm(wall.gradient) / others;
}

// Contact line at one wall (contact_angle.h). Other wetted walls count as liquid: in the corner of two walls liquid that
// fills it has no line, and one that ends there has its line's own direction on each.
LinePull line_pull(const Stage& t, std::size_t i, const WallSample& wall) {
  LinePull pull;
  const LiquidFields& f = t.f;
  const float support = f.neighbours.kernel.support;
  Vec3f along = xyz(t.s.gradient[i]);
  along -= wall.normal * dot(along, wall.normal);
  const float length = norm(along), tau = length / std::max(1 - wall.lambda, 0.1f);
  // 0 for spray on the wall (little colour), inside (filled), where nothing points along the wall and across a gap.
  float activity = wall.contact *
      ramp(f.colour[i], 0.22f, 0.28f) * ramp(-f.filling[i], -0.97f, -0.93f) * ramp(tau * support, 0.2f, 0.4f);
  if (activity == 0) return pull;
  const NearInterface seen = near_interface(t, i, wall);
  const Vec3f inward = along / length;
  const float kappa = seen.curvature;
  // Without an interface in reach a particle with little around it belongs to a film of one layer: its angle is 0, it
  // withdraws. Otherwise a receding line leaves such a film behind. One with much around it lies in liquid that disorder
  // has thinned (in corners between walls): pulled there, hollows would open.
  activity *= seen.trust + (1 - seen.trust) * ramp(-f.filling[i], -0.85f, -0.75f);
  if (activity == 0) return pull;
  const float extrapolated = std::clamp(
      -(dot(seen.normal, wall.normal) * (1 - 0.5f * t.depth() * kappa) + 0.5f * seen.height * kappa), -1.0f, 1.0f);
  const float cosine = 1 + seen.trust * (extrapolated - 1);
  pull.activity = activity;
  pull.curvature = seen.curvature;
  const float strength = bare_gradient(t, i, wall);
  pull.length = 4 * strength * tau * f.volume * activity;
  const Float4& here = f.position[i];
  const WallAngles angles = angles_at(t.walls[wall.wall], {here.x, here.y, here.z});
  pull.force = inward * (-t.gamma * pull.length * unbalanced_cosine(cosine, angles.cos_advancing, angles.cos_receding));
  pull.inward = inward;
  // A line that moves inward feels the receding angle, one that moves outward the advancing one (contact_angle.h). Not on a woven
  // face, whose angles stand for yarns and what they hold: droplets of a splash that were held on wet cloth did not come down to it.
  if (!t.walls[wall.wall].two_sided) {
    const float within = std::clamp(cosine, angles.cos_advancing, angles.cos_receding);
    pull.hold_in = t.gamma * pull.length * (angles.cos_receding - within);
    pull.hold_out = t.gamma * pull.length * (within - angles.cos_advancing);
  }
  pull.drag = activity * static_cast<float>(t.params.contact.line_friction) * std::sqrt(t.gamma * f.spacing / f.rest_density) *
              strength / std::max(wall.distance, 0.3f * f.spacing);
  return pull;
}

// Gradient of the curvature along the surface at i in S, 1/m2.
Vec3f curvature_slope(const Stage& t, std::size_t i) {
  const TangentFit fit = surface_fit(t, i, [&](const TangentFit&, Index j) {
    return std::pair(t.s.curvature[j] - t.s.curvature[i], 0.0f);
  });
  const TangentFit::Slopes slopes = fit.slopes(t.least_spread());
  return fit.first() * slopes.s11 + fit.second() * slopes.s12;
}

// Force on particle i; what the line gives to walls is added to impulse (of the tile).
void force_on(const Stage& t, std::size_t i, Real dt, Vec3* impulse) {
  LiquidFields& f = t.f;
  float kappa = t.s.curvature[i];
  Vec3f line{};
  t.s.line_length[i] = 0;
  for (const WallSample& wall : f.boundary.samples(i)) {
    const LinePull pull = line_pull(t, i, wall);
    const float w = first_layer(wall.distance, f.spacing);
    kappa = (1 - w * pull.activity) * kappa + w * pull.activity * pull.curvature;
    if (pull.activity == 0) continue;
    line += pull.force;
    if (pull.length > t.s.line_length[i]) t.s.line_length[i] = pull.length, t.s.line_wall[i] = wall.wall;
    // Friction of the line and what hysteresis holds, implicit so that they can only slow.
    Float4& u = f.velocity[i];
    const Vec3f v = xyz(u), slip = v - f.boundary.wall_velocity(i, wall), tangential = slip - wall.normal * dot(slip, wall.normal);
    const float change = static_cast<float>(dt) * pull.drag;
    Vec3f lost = tangential * (change / (1 + change));
    const float slides = dot(tangential - lost, pull.inward);
    const float held = static_cast<float>(dt) / f.particle_mass * (slides > 0 ? pull.hold_in : pull.hold_out);
    lost += pull.inward * std::clamp(slides, -held, held);
    u = {v.x - lost.x, v.y - lost.y, v.z - lost.z, 0};
    const Vec3 given(lost * f.particle_mass - pull.force * static_cast<float>(dt));
    impulse[wall.wall] += given;
    f.boundary.give(i, wall, given);
  }
  Vec3f surface{};
  if (kappa != 0) surface = xyz(f.acceleration[i]) * (2 * t.gamma * kappa);
  if (t.s.trust[i] > 0) surface -= curvature_slope(t, i) * (t.depth() / f.spacing * t.gamma * t.s.trust[i]);
  surface = surface / f.rest_density;
  const Vec3f a = surface + line / f.particle_mass;
  f.force[i] = {a.x, a.y, a.z, 0};
  // Kept for the balance of free drops: the curvature part alone is wanted there, and away from walls it is all.
  t.s.gradient[i] = {surface.x, surface.y, surface.z, t.s.gradient[i].w};
}

// Drops are the connected parts of S; root[i] is the smallest index of i's part.
void find_drops(const Stage& t) {
  std::vector<Index>& root = t.s.root;
  for (std::size_t i = 0; i < t.f.count; ++i) root[i] = static_cast<Index>(i);
  for (std::size_t i = 0; i < t.f.count; ++i) {
    if (!t.f.surface[i]) continue;
    each_neighbour(t.f, i, [&](Index j) { return j < i && t.f.surface[j] != 0; }, [&](Index j, const Vec3f&) {
      unite(root, static_cast<Index>(i), j);
    });
  }
}

// The momentum of the curvature forces, drop by drop. On a drop without a contact line they must add up to zero; a gather
// form misses that by about 0.1 % of 2 pi R gamma, enough to make a small drop swim: the rest is taken off. On a drop with
// a line their sum is the wall's pull on the line (-2 pi a gamma sin(theta) on a cap): the walls get the reaction, shared
// by the length of line on each. Returns the sum over drops with a line.
Vec3 balance_drops(const Stage& t, Real dt, std::vector<Vec3>& impulse) {
  LiquidFields& f = t.f;
  find_drops(t);
  constexpr std::size_t width = 5;  // per root: force/mass x y z, sum of |force/mass|, length of line
  std::vector<double>& sums = t.s.drop_sums;
  sums.assign(width * f.count, 0);
  const auto drop = [&](std::size_t i) { return width * root_of(t.s.root, t.s.owner[i]); };
  for (std::size_t i = 0; i < f.count; ++i) {
    if (t.s.owner[i] == no_index) continue;
    double* sum = &sums[drop(i)];
    const Float4& a = t.s.gradient[i];
    sum[0] += a.x, sum[1] += a.y, sum[2] += a.z;
    sum[3] += norm(xyz(a));
    sum[4] += t.s.line_length[i];
  }
  Vec3 held{};
  for (std::size_t i = 0; i < f.count; ++i) {
    if (t.s.owner[i] == no_index) continue;
    const double* sum = &sums[drop(i)];
    if (sum[4] > 0) {
      if (t.s.line_length[i] == 0) continue;
      const Vec3 share = Vec3{sum[0], sum[1], sum[2]} * (t.s.line_length[i] / sum[4] * Real(f.particle_mass));
      held += share;
      impulse[t.s.line_wall[i]] -= share * dt;
      for (const WallSample& wall : f.boundary.samples(i))
        if (wall.wall == t.s.line_wall[i]) f.boundary.give(i, wall, -share * dt);
    } else if (sum[3] > 0) {
      const auto share = static_cast<float>(norm(xyz(t.s.gradient[i])) / sum[3]);
      Float4& force = f.force[i];
      force = {force.x - share * static_cast<float>(sum[0]), force.y - share * static_cast<float>(sum[1]),
               force.z - share * static_cast<float>(sum[2]), 0};
    }
  }
  return held;
}

// Without surface tension nothing but the classes is wanted; every wall that liquid reaches counts as wet.
void classify_only(LiquidFields& f, std::vector<ParticleClass>& kinds) {
  parallel_for(f.count, [&](std::size_t i) {
    float nearest = 1e6f;
    for (const WallSample& wall : f.boundary.samples(i)) nearest = std::min(nearest, wall.distance / f.spacing);
    const float gradient_h = norm(xyz(f.colour_gradient[i]) + xyz(f.boundary.wall[i])) * f.neighbours.kernel.support;
    kinds[i] = particle_class(gradient_h, f.filling[i], nearest);
    f.force[i] = {};
  });
}

void begin_scratch(SurfaceScratch& s, std::size_t count) {
  s.gradient.resize(count), s.normal.resize(count);
  s.curvature.resize(count), s.line_length.resize(count), s.line_wall.resize(count);
  s.reliability.resize(count), s.trust.resize(count), s.owner.resize(count), s.root.resize(count);
}

}  // namespace

SurfaceReport compute_surface(LiquidFields& f, const SurfaceParams& params, Real surface_tension,
                              std::span<const Wall> walls, Real dt, SurfaceScratch& scratch,
                              std::vector<ParticleClass>& kinds, std::vector<Vec3>& impulse) {
  SurfaceReport report;
  if (surface_tension <= 0) {
    classify_only(f, kinds);
    return report;
  }
  begin_scratch(scratch, f.count);
  const Stage t{f, params, scratch, static_cast<float>(surface_tension), walls};
  parallel_for(f.count, [&](std::size_t i) { mark_surface(t, i, kinds[i]); });
  parallel_for(f.count, [&](std::size_t i) {
    scratch.trust[i] = 0;
    if (f.surface[i]) fit_curvature(t, i);
  });
  parallel_for(f.count, [&](std::size_t i) { extend(t, i); });
  uniform_pressure_response(f);
  const std::size_t tiles = (f.count + default_tile - 1) / default_tile;
  scratch.wall_parts.assign(tiles * walls.size(), {});
  parallel_tiles(f.count, [&](std::size_t begin, std::size_t end) {
    Vec3* part = scratch.wall_parts.data() + begin / default_tile * walls.size();
    for (std::size_t i = begin; i < end; ++i) force_on(t, i, dt, part);
  });
  for (std::size_t k = 0; k < scratch.wall_parts.size(); ++k) impulse[k % walls.size()] += scratch.wall_parts[k];
  report.net_force = balance_drops(t, dt, impulse);
  for (std::size_t i = 0; i < f.count; ++i) report.surface_particles += f.surface[i];
  return report;
}

Real least_viscosity(const SurfaceParams& params, Real surface_tension, Real density, Real spacing) {
  return params.numerical_viscosity * std::sqrt(surface_tension * spacing / density);
}

}  // namespace imbibe
