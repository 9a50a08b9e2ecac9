#include "imbibe/sim/rest.h"

#include "imbibe/core/parallel.h"
#include "imbibe/core/portable.h"
#include "imbibe/core/union_find.h"

namespace imbibe {
namespace {

constexpr Real share_taken_before_moving = 0.02;  // of the particles that came to rest
constexpr float connected_spacings = 1.5f;
constexpr Real sliding_share = 0.1;               // of a blob's own capillary velocity
constexpr std::size_t least_sliding_particles = 8;  // fewer jitter about as fast

// Sums over the particles that make centre, extents and mean velocity; and the greatest squared speed.
struct Moments {
  Vec3 first{}, second{}, velocity{};
  Real fastest = 0;
  Moments& operator+=(const Moments& o) {
    fastest = std::max(fastest, o.fastest);
    return first += o.first, second += o.second, velocity += o.velocity, *this;
  }
};

Moments moments_of(const Particles& p) {
  return parallel_sum(p.size(), [&](std::size_t begin, std::size_t end) {
    Moments m;
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 x(p.position[i].x, p.position[i].y, p.position[i].z);
      m.first += x;
      m.second += Vec3{x.x * x.x, x.y * x.y, x.z * x.z};
      const Vec3 u(p.velocity[i].x, p.velocity[i].y, p.velocity[i].z);
      m.velocity += u;
      m.fastest = std::max(m.fastest, squared_norm(u));
    }
    return m;
  });
}

Real radius_of_drop(const Liquid& liquid, Real particles) {
  return portable::cbrt(3 * particles * liquid.particle_mass / (4 * pi * liquid.kind.density));
}

// Whether each blob stays where it is, as far as one instant tells.
bool blobs_rest(const World& world, const LiquidFields& fields, Real waited) {
  const Liquid& liquid = world.liquid;
  const Real band = 0.05 * liquid.spacing();
  for (const Blob& blob : find_blobs(fields, liquid.particles)) {
    const Real speed = norm(blob.velocity);
    if (!blob.held) {
      if (squared_norm(world.gravity) > 0 || speed * waited > band) return false;
      continue;
    }
    const Real radius = radius_of_drop(liquid, static_cast<Real>(blob.particles));
    const Real capillary_speed = std::sqrt(liquid.kind.surface_tension / (liquid.kind.density * radius));
    if (blob.particles >= least_sliding_particles && speed > sliding_share * capillary_speed) return false;
  }
  return true;
}

}  // namespace

std::vector<Blob> find_blobs(const LiquidFields& f, const Particles& particles) {
  std::vector<Index> parent;
  separate_all(parent, f.count);
  const float reach = connected_spacings * f.spacing;
  for (std::size_t first = 0; first < f.count; first += simd::lanes) {
    const Slice slice = f.neighbours.slice(first);
    for (std::size_t slot = 0; slot < slice.slots; ++slot)
      for (std::size_t lane = 0; lane < simd::lanes; ++lane) {
        const auto i = static_cast<Index>(first + lane), j = slice.index[simd::lanes * slot + lane];
        if (j >= i || i >= f.count) continue;  // each pair once; padding is behind the last particle
        const Float4 &a = f.position[i], &b = f.position[j];
        const float x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
        if (x * x + y * y + z * z > reach * reach) continue;
        unite(parent, i, j);
      }
  }
  std::vector<Blob> blobs;
  std::vector<Index> blob_of(f.count);
  for (Index i = 0; i < f.count; ++i) {
    const Index root = root_of(parent, i);  // the smallest of the blob, so it has its number already
    if (root == i) blob_of[i] = static_cast<Index>(blobs.size()), blobs.emplace_back();
    else blob_of[i] = blob_of[root];
    Blob& blob = blobs[blob_of[i]];
    ++blob.particles;
    const Float4& v = particles.velocity[i];
    blob.velocity += Vec3(v.x, v.y, v.z);
    for (const WallSample& wall : f.boundary.samples(i)) blob.held = blob.held || wall.distance < f.spacing;
  }
  for (Blob& blob : blobs) blob.velocity = blob.velocity / static_cast<Real>(blob.particles);
  return blobs;
}

void judge_rest(World& world, const LiquidFields& fields) {
  Pace& pace = world.pace;
  const Particles& p = world.liquid.particles;
  if (p.size() == 0) return;
  const Moments sum = moments_of(p);
  const auto n = static_cast<Real>(p.size());
  const Vec3 centre = sum.first / n, square = sum.second / n, velocity = sum.velocity / n;
  const auto spread = [](Real mean_square, Real mean) { return std::sqrt(std::max(mean_square - mean * mean, 0.0)); };
  const Vec3 extent{spread(square.x, centre.x), spread(square.y, centre.y), spread(square.z, centre.z)};
  const auto begin_window = [&] {
    pace.calm_since = world.time;
    pace.calm_centre = centre;
    pace.calm_extent = extent;
    pace.calm_velocity = velocity;
  };

  const LiquidKind& kind = world.liquid.kind;
  const Real radius = radius_of_drop(world.liquid, n);
  const Real band = 0.05 * world.liquid.spacing();
  if (pace.calm_since < 0 || norm(centre - pace.calm_centre) > band || norm(extent - pace.calm_extent) > band)
    return begin_window();
  // In the window what hangs free falls by twice the band: that of a few particles' own swing is too short to see them slip.
  const Real pull = norm(world.gravity);
  const Real window = std::max(0.5 * std::sqrt(kind.density * radius * radius * radius / kind.surface_tension),
                               pull > 0 ? std::sqrt(4 * band / pull) : 0);
  const Real waited = world.time - pace.calm_since;
  if (waited < window) return;
  // What has just been let go falls too little to leave the band, but gains g t; single fast particles are spray.
  const Real gained = norm(velocity - pace.calm_velocity);
  const Real capillary_speed = std::sqrt(kind.surface_tension / (kind.density * radius));
  if (gained > 0.3 * norm(world.gravity) * waited + 1e-3 * capillary_speed) return;
  if (sum.fastest > 4 * capillary_speed * capillary_speed) return;
  if (fields.count != p.size()) return;  // some died or were born since the lists were made: the next step tells
  if (!blobs_rest(world, fields, waited)) return begin_window();
  pace.resting = true;
  pace.particles_at_rest = p.size();
}

void wake_when_changed(World& world) {
  Pace& pace = world.pace;
  const Real gone = static_cast<Real>(pace.particles_at_rest) - static_cast<Real>(world.liquid.particles.size());
  if (gone <= share_taken_before_moving * static_cast<Real>(pace.particles_at_rest) && gone >= 0) return;
  pace.resting = false;
  pace.calm_since = -1;
}

}  // namespace imbibe
