#include "imbibe/liquid/surface_tension.h"

#include <algorithm>
#include <cmath>

#include "imbibe/liquid/classes.h"

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
  float weight(float distance) const { return f.volume * f.neighbours.kernel.value(distance); }
  float corrected(float kappa) const {
    return kappa / (1 + static_cast<float>(params.offset) * f.spacing * kappa);
  }
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

// Colour gradient with wetted walls, filling, set S and the particle's class.
void mark_surface(const Stage& t, std::size_t i, ParticleClass& kind) {
  LiquidFields& f = t.f;
  Vec3f n = xyz(f.colour_gradient[i]);
  float dry = 1, nearest = 1e6f;
  for (const WallSample& wall : f.boundary.samples(i)) {
    const float beta = wetness_of(t, i, wall);
    n += wall.gradient * beta;
    dry *= 1 - beta * wall.lambda;
    nearest = std::min(nearest, wall.distance / f.spacing);
  }
  const float length = norm(n), gradient_h = length * f.neighbours.kernel.support;
  const float filling = f.colour[i] + (1 - dry);
  const float layer = first_layer(nearest, 1);
  kind = particle_class(gradient_h, filling, nearest);
  const float reliability = ramp(gradient_h, 0.2f, 0.4f) * ramp(-filling, -0.95f, -0.89f) *
                            ramp(f.colour[i], 0.2f, 0.3f) * ramp(-layer, -0.6f, -0.4f);
  t.s.reliability[i] = reliability;
  f.surface[i] = reliability > 0;
  t.s.gradient[i] = {n.x, n.y, n.z, gradient_h};
  t.s.wet_filling[i] = filling;
  t.s.first_layer[i] = layer;
  const Vec3f unit = length > 0 ? n / length : Vec3f{};
  t.s.normal[i] = {unit.x, unit.y, unit.z, 0};
}

// kappa = -trace S of the least-squares fit in the tangent plane.
float fitted_curvature(const Stage& t, std::size_t i) {
  const LiquidFields& f = t.f;
  const Vec3f normal = xyz(t.s.normal[i]);
  const Vec3f across = std::abs(normal.x) < 0.6f ? Vec3f{1, 0, 0} : Vec3f{0, 1, 0};
  const Vec3f first = normalized(across - normal * dot(across, normal));
  const Vec3f second = cross(normal, first);
  float xx = 0, xy = 0, yy = 0, nxx = 0, nxy = 0, nyx = 0, nyy = 0;
  each_surface_neighbour(f, i, [&](Index j, const Vec3f& to_here) {
    const Vec3f other = xyz(t.s.normal[j]);
    if (dot(other, normal) <= 0) return;
    const float near = std::max(0.0f, 1 - norm(to_here) * f.neighbours.kernel.inverse), w = near * near * near * t.s.reliability[j];
    const float x = -dot(to_here, first), y = -dot(to_here, second);
    const float n1 = dot(other, first), n2 = dot(other, second);
    xx += w * x * x, xy += w * x * y, yy += w * y * y;
    nxx += w * n1 * x, nxy += w * n1 * y, nyx += w * n2 * x, nyy += w * n2 * y;
  });
  const float ridge = 0.02f * (xx + yy);
  xx += ridge, yy += ridge;
  const float determinant = xx * yy - xy * xy;
  if (!(determinant > 0)) return 0;
  const float trace = (nxx * yy - nxy * xy + nyy * xx - nyx * xy) / determinant;
  const float limit = 0.6f / f.spacing;
  return std::clamp(-trace, -limit, limit);
}

// Curvature off S by the kernel mean over S, and the drop a particle belongs to.
void extend(const Stage& t, std::size_t i) {
  const float own = t.s.reliability[i];
  t.s.owner[i] = own > 0 ? static_cast<Index>(i) : no_index;
  t.s.curvature[i] = t.s.normal[i].w;
  if (own == 1) return;
  if (own == 0 && t.s.gradient[i].w < carries_force) {
    t.s.curvature[i] = 0;
    return;
  }
  float sum = 0, weights = 0, heaviest = 0;
  each_surface_neighbour(t.f, i, [&](Index j, const Vec3f& x) {
    const float w = t.weight(norm(x)) * t.s.reliability[j];
    sum += w * t.s.normal[j].w, weights += w;
    if (own == 0 && w > heaviest) heaviest = w, t.s.owner[i] = j;
  });
  const float mean = weights > 1e-6f ? sum / weights : t.s.curvature[i];
  t.s.curvature[i] = own * t.s.curvature[i] + (1 - own) * mean;
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
    seen.curvature += w * t.s.normal[j].w;
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
  Vec3f normal{};       // of the first layer at the line, times |n|
  float curvature = 0;
  Vec3f force{};        // N on the particle, along the wall
  float drag = 0;       // 1/s
  float activity = 0;   // 0..1
};

// Contact line at one wall (contact_angle.h). others: gradient of all other wetted walls.
LinePull line_pull(const Stage& t, std::size_t i, const WallSample& wall) {
  LinePull pull;
  const LiquidFields& f = t.f;
  const float support = f.neighbours.kernel.support;
  Vec3f along = xyz(f.colour_gradient[i]);
  along -= wall.normal * dot(along, wall.normal);
  const float length = norm(along), tau = length / std::max(1 - wall.lambda, 0.1f);
  // 0 for spray on the wall (little colour), inside (filled) and where nothing points along the wall.
  const float activity =
      ramp(f.colour[i], 0.22f, 0.28f) * ramp(-f.filling[i], -0.97f, -0.93f) * ramp(tau * support, 0.2f, 0.4f);
  if (activity == 0) return pull;
  const NearInterface seen = near_interface(t, i, wall);
  const Vec3f inward = along / length;
  const float kappa = t.corrected(seen.curvature);
  // Without an interface in reach i belongs to a film of one layer: its angle is 0, it withdraws. Otherwise a receding
  // line leaves such a film behind.
  const float extrapolated =
      std::clamp(-(dot(seen.normal, wall.normal) + 0.5f * seen.height * kappa), -1.0f, 1.0f);
  const float cosine = 1 + seen.trust * (extrapolated - 1);
  const float sine = std::sqrt(1 - cosine * cosine);
  pull.activity = activity;
  pull.normal = (inward * sine - wall.normal * cosine) * (tau / std::max(sine, 0.35f));
  pull.curvature = seen.curvature;
  const float strength = norm(wall.gradient);
  pull.force = inward * (-4 * t.gamma * strength * tau * f.volume * activity *
                         unbalanced_cosine(cosine, wall.cos_contact_angle, wall.cos_receding_angle));
  pull.drag = activity * static_cast<float>(t.params.contact.line_friction) * std::sqrt(t.gamma * f.spacing / f.rest_density) *
              strength / std::max(wall.distance, 0.3f * f.spacing);
  return pull;
}

// Force on particle i; what the line gives to walls is added to impulse (of the tile).
void force_on(const Stage& t, std::size_t i, Real dt, Vec3* impulse) {
  LiquidFields& f = t.f;
  Vec3f n = xyz(t.s.gradient[i]);
  float kappa = t.s.curvature[i];
  Vec3f line{};
  for (const WallSample& wall : f.boundary.samples(i)) {
    const LinePull pull = line_pull(t, i, wall);
    const float w = first_layer(wall.distance, f.spacing);
    n = n * (1 - w) + pull.normal * (w * pull.activity);
    kappa = (1 - w * pull.activity) * kappa + w * pull.activity * pull.curvature;
    if (pull.activity == 0) continue;
    line += pull.force;
    // Friction of the line, implicit so that it can only slow.
    Float4& u = f.velocity[i];
    const Vec3f v = xyz(u), tangential = v - wall.normal * dot(v, wall.normal);
    const float change = static_cast<float>(dt) * pull.drag;
    const Vec3f lost = tangential * (change / (1 + change));
    u = {v.x - lost.x, v.y - lost.y, v.z - lost.z, 0};
    impulse[wall.wall] += Vec3(lost * f.particle_mass - pull.force * static_cast<float>(dt));
  }
  const Vec3f a = (n * (2 * t.gamma * t.corrected(kappa)) + line / f.volume) / f.rest_density;
  f.force[i] = {a.x, a.y, a.z, 0};
  // Kept for the balance of free drops: the curvature part alone is wanted there, and away from walls it is all.
  t.s.gradient[i] = {a.x - line.x / f.particle_mass, a.y - line.y / f.particle_mass, a.z - line.z / f.particle_mass,
                     t.s.gradient[i].w};
}

// Drops are the connected parts of S; root[i] is the smallest index of i's part.
Index root_of(std::vector<Index>& root, Index i) {
  while (root[i] != i) i = root[i] = root[root[i]];
  return i;
}

void find_drops(const Stage& t) {
  std::vector<Index>& root = t.s.root;
  for (std::size_t i = 0; i < t.f.count; ++i) root[i] = static_cast<Index>(i);
  for (std::size_t i = 0; i < t.f.count; ++i) {
    if (!t.f.surface[i]) continue;
    each_neighbour(t.f, i, [&](Index j) { return j < i && t.f.surface[j] != 0; }, [&](Index j, const Vec3f&) {
      const Index a = root_of(root, static_cast<Index>(i)), b = root_of(root, j);
      root[std::max(a, b)] = std::min(a, b);
    });
  }
}

// The curvature forces on a drop that touches nothing add up to zero; a gather form misses that by about 0.1 % of
// 2 pi R gamma, enough to make a small drop swim. Returns the sum over drops that do touch something.
Vec3 balance_free_drops(const Stage& t) {
  LiquidFields& f = t.f;
  find_drops(t);
  constexpr std::size_t width = 5;  // per root: force x y z, sum of |force|, touches a wall
  std::vector<double>& sums = t.s.drop_sums;
  sums.assign(width * f.count, 0);
  const auto drop = [&](std::size_t i) { return width * root_of(t.s.root, t.s.owner[i]); };
  for (std::size_t i = 0; i < f.count; ++i) {
    if (t.s.owner[i] == no_index) continue;
    double* sum = &sums[drop(i)];
    const Float4& a = t.s.gradient[i];
    sum[0] += a.x, sum[1] += a.y, sum[2] += a.z;
    sum[3] += norm(xyz(a));
    if (t.s.first_layer[i] > 0) sum[4] = 1;
  }
  Vec3 held{};
  for (std::size_t i = 0; i < f.count; ++i) {
    if (t.s.owner[i] == no_index) continue;
    const double* sum = &sums[drop(i)];
    const Vec3f a = xyz(t.s.gradient[i]);
    if (sum[4] != 0) {
      held += Vec3(a) * Real(f.particle_mass);
    } else if (sum[3] > 0) {
      const auto share = static_cast<float>(norm(a) / sum[3]);
      Float4& force = f.force[i];
      force = {force.x - share * static_cast<float>(sum[0]), force.y - share * static_cast<float>(sum[1]),
               force.z - share * static_cast<float>(sum[2]), 0};
    }
  }
  return held;
}

void begin_scratch(SurfaceScratch& s, std::size_t count) {
  s.gradient.resize(count), s.normal.resize(count);
  s.curvature.resize(count), s.wet_filling.resize(count), s.first_layer.resize(count);
  s.reliability.resize(count), s.owner.resize(count), s.root.resize(count);
}

}  // namespace

SurfaceReport compute_surface(LiquidFields& f, const SurfaceParams& params, Real surface_tension,
                              std::span<const Wall> walls, Real dt, SurfaceScratch& scratch,
                              std::vector<ParticleClass>& kinds, std::vector<Vec3>& impulse) {
  SurfaceReport report;
  begin_scratch(scratch, f.count);
  const Stage t{f, params, scratch, static_cast<float>(surface_tension)};
  parallel_for(f.count, [&](std::size_t i) { mark_surface(t, i, kinds[i]); });
  parallel_for(f.count, [&](std::size_t i) {
    if (f.surface[i]) scratch.normal[i].w = fitted_curvature(t, i);
  });
  parallel_for(f.count, [&](std::size_t i) { extend(t, i); });
  const std::size_t tiles = (f.count + default_tile - 1) / default_tile;
  scratch.wall_parts.assign(tiles * walls.size(), {});
  parallel_tiles(f.count, [&](std::size_t begin, std::size_t end) {
    Vec3* part = scratch.wall_parts.data() + begin / default_tile * walls.size();
    for (std::size_t i = begin; i < end; ++i) force_on(t, i, dt, part);
  });
  for (std::size_t k = 0; k < scratch.wall_parts.size(); ++k) impulse[k % walls.size()] += scratch.wall_parts[k];
  report.net_force = balance_free_drops(t);
  for (std::size_t i = 0; i < f.count; ++i) report.surface_particles += f.surface[i];
  return report;
}

Real numerical_viscosity(const SurfaceParams& params, Real surface_tension, Real density, Real spacing) {
  return params.numerical_viscosity * std::sqrt(surface_tension * spacing / density);
}

}  // namespace imbibe
