#include "imbibe/liquid/density.h"

#include <algorithm>
#include <array>
#include <span>

#include "imbibe/liquid/classes.h"
#include "imbibe/liquid/wall_push.h"

namespace imbibe {

using simd::Floats;
using simd::Floats3;
using simd::Floats4;
using simd::lanes;

namespace {

constexpr std::size_t completion_entries = 512;

// |n| H of a flat surface at its steepest, depth 0: 21 (1 - 3/2 + 4/7).
constexpr double steepest = 21.0 * (1.0 - 1.5 + 4.0 / 7.0);

// lambda over |n| H at equal steps of |n| H, both for depths from H (0) to 0 (steepest).
std::array<float, completion_entries + 1> completion_table() {
  std::array<float, completion_entries + 1> table{};
  for (std::size_t k = 0; k <= completion_entries; ++k) {
    const double wanted = steepest * static_cast<double>(k) / completion_entries;
    double near = 0, far = 1;  // depth in H; the slope falls with depth
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (near + far);
      (-half_space_integral(middle, 1).slope > wanted ? near : far) = middle;
    }
    table[k] = static_cast<float>(half_space_integral(near, 1).lambda);
  }
  return table;
}

// How far the gap between a particle and a wall is filled: |n + G| along the wall's normal is 0 where liquid reaches down
// to it and that of a free surface where air lies between. Limits: 0.9/H is a gap of about one layer, 0.5/H none (the noise
// of a resting layer is 0.2/H).
float wall_contact(const Vec3f& gradient, const Vec3f& normal, float support) {
  constexpr float open = 0.9f, closed = 0.5f;
  const float bare = support * dot(gradient, normal);
  return std::clamp((open - bare) / (open - closed), 0.0f, 1.0f);
}

// How far liquid reaches the walls of particle i as it alone sees them. liquid: V sum grad W over its neighbours.
void see_gaps(Boundary& boundary, std::size_t i, const Vec3f& liquid, float support) {
  const Float4& all = boundary.wall[i];
  const Vec3f gradient = liquid + Vec3f{all.x, all.y, all.z};
  bool dry = false;
  for (WallSample& w : boundary.samples(i)) {
    w.seen_contact = wall_contact(gradient, w.normal, support);
    dry |= w.seen_contact < 1;
  }
  boundary.dry[i] = dry;
}

// The mean contact of the neighbours that lie between particle i and the wall of its sample w: 1 without any.
float contact_below(const Boundary& boundary, const Slice& s, std::size_t lane, const WallSample& w, float support) {
  const float nearer = w.distance - 0.2f * support;  // by half a spacing
  float sum = 0, all = 0;
  for (std::size_t k = lane; k < s.slots * lanes; k += lanes) {
    if (s.slope[k] == 0) continue;
    for (const WallSample& other : boundary.samples(s.index[k])) {
      if (other.wall != w.wall || other.distance > nearer) continue;
      all += s.slope[k], sum += s.slope[k] * other.seen_contact;
    }
  }
  return all == 0 ? 1 : sum / all;
}

bool any_dry(const Boundary& boundary, const Slice& s, std::size_t lane) {
  for (std::size_t k = lane; k < s.slots * lanes; k += lanes)
    if (s.slope[k] != 0 && boundary.dry[s.index[k]] != 0) return true;
  return false;
}

// Whether a particle is among liquid: by the mean filling of its neighbours, 0.38 to 0.64 in droplets of up to 20 particles,
// 0.70 and more in a drop of 8 spacings' radius.
float liquid_around(std::span<const float> filling, const Slice& s, std::size_t lane) {
  constexpr float droplet = 0.62f, drop = 0.70f;
  float sum = 0, all = 0;
  for (std::size_t k = lane; k < s.slots * lanes; k += lanes) all += s.slope[k], sum += s.slope[k] * filling[s.index[k]];
  return all == 0 ? 0 : std::clamp((sum / all - droplet) / (drop - droplet), 0.0f, 1.0f);
}

// What is not among liquid touches a wall where it is as near as liquid's first layer is, not where a kernel ends.
float touch(float distance, float support) {
  constexpr float touches = 0.2f, free = 0.3f;
  return std::clamp((free - distance / support) / (free - touches), 0.0f, 1.0f);
}

// Takes the walls that liquid does not reach out of what particle i sees.
void leave_dry_walls(Boundary& boundary, std::size_t i, const Slice& s, float support, std::span<const float> filling) {
  const std::span<WallSample> samples = boundary.samples(i);
  if (samples.empty()) return;
  std::array<float, walls_per_particle> contact;
  float least = 1;
  const bool dry_below = any_dry(boundary, s, i - s.first);
  const float among = filling[i] > 0.85f ? 1 : liquid_around(filling, s, i - s.first);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    contact[k] = samples[k].seen_contact;
    if (dry_below) contact[k] = std::min(contact[k], contact_below(boundary, s, i - s.first, samples[k], support));
    contact[k] *= among + (1 - among) * touch(samples[k].distance, support);
    samples[k].contact = contact[k];
    least = std::min(least, contact[k]);
  }
  if (least == 1) return;
  set_pushes(samples, contact, support);
  Vec3f g{}, p{};
  float outside = 1;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    // The sample's gradient carries the factors 1 - lambda of the others: they become 1 - contact lambda.
    float scale = contact[k];
    for (std::size_t l = 0; l < samples.size(); ++l) {
      if (l != k) scale *= (1 - contact[l] * samples[l].lambda) / std::max(1 - samples[l].lambda, 0.05f);
    }
    outside *= 1 - contact[k] * samples[k].lambda;
    samples[k].push = samples[k].push * scale;
    g += samples[k].gradient * scale, p += samples[k].push;
  }
  boundary.wall[i] = {g.x, g.y, g.z, 1 - outside};
  boundary.push[i] = {p.x, p.y, p.z, 0};
}

}  // namespace

float air_completion(float gradient_h) {
  static const auto table = completion_table();
  const float place = std::min(gradient_h * static_cast<float>(completion_entries / steepest),
                               static_cast<float>(completion_entries) - 0.001f);
  const auto k = static_cast<std::size_t>(place);
  return table[k] + (place - static_cast<float>(k)) * (table[k + 1] - table[k]);
}

float density_error(float colour, float wall_lambda, float gradient_h) {
  // Inside the liquid |grad lambda_a| H is 0.05 by the particles' disorder alone: taken for air, it would let the liquid
  // swell by 0.3 %.
  constexpr float disorder = 0.07f;
  gradient_h = std::sqrt(std::max(0.0f, gradient_h * gradient_h - disorder * disorder));
  const float filling = colour + wall_lambda;
  const float lowest = -0.05f * std::clamp((filling - 0.5f) / 0.15f, 0.0f, 1.0f);
  if (lowest == 0) return std::max(0.0f, filling - 1);
  const float open = std::max(1 - wall_lambda, 0.25f);  // deep in a wall (never for long): bounded
  const float completed = std::max(lowest, filling - 1 + open * air_completion(gradient_h / open));
  // At a contact line neither part is known: there only compression counts.
  const float at_line = std::clamp((wall_lambda - 0.02f) / 0.1f, 0.0f, 1.0f) *
                        std::clamp((gradient_h - surface_gradient_h) / 0.4f, 0.0f, 1.0f);
  const float known = filling > 1 ? filling - 1 : std::min(completed, 0.0f);
  return completed + at_line * (known - completed);
}

namespace {

// Sums over the pairs: f.colour, the gradient in f.colour_gradient, sum |V grad W|^2 in f.factor, the filling with all walls in
// f.applied, and what each particle sees of gaps.
void sum_pairs(LiquidFields& f) {
  const Kernel kernel = f.neighbours.kernel;
  const float volume = f.volume;
  const float own = volume * kernel.value(0) - f.lattice.excess;
  f.boundary.dry.assign(f.position.size(), 0);
  for_each_slice(f.neighbours, [&](const Slice& s) {
    const Floats4 here = simd::load4(&f.position[s.first]);
    Floats sum{}, square{};
    Floats3 gradient{};
    for (std::size_t k = 0; k < s.slots; ++k) {
      const Floats4 there = simd::load4(f.position.data(), s.index + k * lanes);
      const Floats slope = volume * simd::load(s.slope + k * lanes);
      const Floats3 x = here.xyz() - there.xyz();
      const Floats d2 = simd::dot(x, x);
      const Floats q = simd::sqrt(d2) * kernel.inverse, t = simd::max(1 - q, 0.0f), t2 = t * t;
      sum += t2 * t2 * (4 * q + 1);
      gradient.x += slope * x.x, gradient.y += slope * x.y, gradient.z += slope * x.z;
      square += slope * slope * d2;
    }
    simd::store(&f.colour[s.first], own + volume * kernel.value_scale * sum);
    simd::store(&f.factor[s.first], square);
    simd::store(&f.applied[s.first], simd::load(&f.colour[s.first]) + simd::load4(&f.boundary.wall[s.first]).w);
    simd::store4(&f.colour_gradient[s.first], gradient, Floats{});
    for (std::size_t p = s.first; p < std::min(s.first + lanes, f.count); ++p) {
      const Float4& n = f.colour_gradient[p];
      see_gaps(f.boundary, p, {n.x, n.y, n.z}, kernel.support);
    }
  });
}

}  // namespace

void compute_density(LiquidFields& f) {
  sum_pairs(f);
  const Kernel kernel = f.neighbours.kernel;
  const float tiny = 1e-6f * kernel.inverse * kernel.inverse;  // a particle alone
  for_each_slice(f.neighbours, [&](const Slice& s) {
    const std::size_t i = s.first, last = std::min(i + lanes, f.count);
    for (std::size_t p = i; p < last; ++p) leave_dry_walls(f.boundary, p, s, kernel.support, f.applied);
    const Floats4 wall = simd::load4(&f.boundary.wall[i]), push = simd::load4(&f.boundary.push[i]);
    const Floats3 gradient = simd::load4(&f.colour_gradient[i]).xyz();
    const Floats colour = simd::load(&f.colour[i]), square = simd::load(&f.factor[i]);
    const Floats share = simd::min(colour / simd::max(1 - wall.w, 0.25f), 1.0f);
    const Floats3 air{gradient.x + share * wall.x, gradient.y + share * wall.y, gradient.z + share * wall.z};
    const Floats3 doubled{gradient.x + 2 * push.x, gradient.y + 2 * push.y, gradient.z + 2 * push.z};
    simd::store(&f.filling[i], colour + wall.w);
    simd::store4(&f.colour_gradient[i], gradient, kernel.support * simd::sqrt(simd::dot(air, air)));
    simd::store(&f.factor[i], 1 / (simd::dot(doubled, doubled) + square + tiny));
  });
  for_each_slice(f.neighbours, [&](const Slice& s) {
    for (std::size_t p = s.first; p < std::min(s.first + lanes, f.count); ++p) {
      float& error = f.density_error[p];
      error = density_error(f.colour[p], f.boundary.wall[p].w, f.colour_gradient[p].w);
      // Up to 1 % is what disorder and the completion's own bias make of any surface; a look around costs a list of neighbours.
      if (error < -0.01f) error *= liquid_around(f.filling, s, p - s.first);
    }
  });
}

}  // namespace imbibe
