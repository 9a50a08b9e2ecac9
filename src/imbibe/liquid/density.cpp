#include "imbibe/liquid/density.h"

#include <algorithm>
#include <array>

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

// Takes the walls that liquid does not reach out of what particle i sees. liquid: V sum grad W over its neighbours.
void leave_dry_walls(Boundary& boundary, std::size_t i, const Vec3f& liquid, float support) {
  const std::span<WallSample> samples = boundary.samples(i);
  if (samples.empty()) return;
  const Float4& all = boundary.wall[i];
  const Vec3f gradient = liquid + Vec3f{all.x, all.y, all.z};
  std::array<float, walls_per_particle> contact;
  float least = 1;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    contact[k] = wall_contact(gradient, samples[k].normal, support);
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

void compute_density(LiquidFields& f) {
  const Kernel kernel = f.neighbours.kernel;
  const float volume = f.volume;
  const float tiny = 1e-6f * kernel.inverse * kernel.inverse;  // a particle alone
  const Real ratio = static_cast<Real>(kernel.support) / static_cast<Real>(f.spacing);
  const float own = volume * kernel.value(0) - static_cast<float>(lattice_excess(ratio) + disorder_excess);
  parallel_tiles(f.count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; i += lanes) {
      const Slice s = f.neighbours.slice(i);
      const Floats4 here = simd::load4(&f.position[i]);
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
      const std::size_t last = std::min(i + lanes, f.count);
      simd::store4(&f.colour_gradient[i], gradient, Floats{});
      for (std::size_t p = i; p < last; ++p) {
        const Float4& n = f.colour_gradient[p];
        leave_dry_walls(f.boundary, p, {n.x, n.y, n.z}, kernel.support);
      }
      const Floats4 wall = simd::load4(&f.boundary.wall[i]), push = simd::load4(&f.boundary.push[i]);
      const Floats colour = own + volume * kernel.value_scale * sum;
      const Floats share = simd::min(colour / simd::max(1 - wall.w, 0.25f), 1.0f);
      const Floats3 air{gradient.x + share * wall.x, gradient.y + share * wall.y, gradient.z + share * wall.z};
      const Floats3 doubled{gradient.x + 2 * push.x, gradient.y + 2 * push.y, gradient.z + 2 * push.z};
      simd::store(&f.colour[i], colour);
      simd::store(&f.filling[i], colour + wall.w);
      simd::store4(&f.colour_gradient[i], gradient, kernel.support * simd::sqrt(simd::dot(air, air)));
      simd::store(&f.factor[i], 1 / (simd::dot(doubled, doubled) + square + tiny));
      for (std::size_t p = i; p < last; ++p) {
        f.density_error[p] = density_error(f.colour[p], f.boundary.wall[p].w, f.colour_gradient[p].w);
      }
    }
  });
}

}  // namespace imbibe
