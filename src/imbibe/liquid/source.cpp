#include "imbibe/liquid/source.h"

#include <algorithm>
#include <vector>

#include "imbibe/core/error.h"
#include "imbibe/core/portable.h"
#include "imbibe/core/random.h"
#include "imbibe/geometry/direction.h"
#include "imbibe/liquid/drop_shape.h"
#include "imbibe/liquid/kernel.h"

namespace imbibe {

namespace {

// New particles nearer than this to old ones, in spacings, would start with a pressure burst.
constexpr Real free_distance = 0.8;

Real volume_of(const Source& s) {
  if (s.volume > 0 || s.form == SourceForm::drop) return s.volume;
  return s.size.x * s.size.y * s.size.z;
}

std::size_t rounded_count(Real volume, Real particle_volume) {
  return static_cast<std::size_t>(std::max(0.0, std::round(volume / particle_volume)));
}

// Half axes of the unit ball stretched at constant volume.
Vec3 unit_axes(const Source& s) {
  const Real mean = portable::cbrt(s.stretch.x * s.stretch.y * s.stretch.z);
  return s.stretch / mean;
}

Real cap_radius(const Source& s) { return imbibe::cap_radius(s.volume, portable::cos(s.cap_angle)); }

// The `count` points of a cubic lattice that lie deepest in the ball, ellipsoid or cap of the source. The lattice's
// corner lies in the centre, so that all eight octants of a ball are equal. A drop's motion breaks this lattice up at once; a
// body-centred one, which is stable, holds out and keeps the surface as rough as it was cut.
std::vector<Vec3> drop_lattice(const Source& s, std::size_t count, Real spacing) {
  const bool cap = s.cap_angle > 0;
  const Vec3 axes = unit_axes(s);
  const Real foot = cap ? -cap_radius(s) * portable::cos(s.cap_angle) / spacing : 0;  // height of the sphere's centre
  struct Point {
    Real square;
    Vec3 at;
  };
  const Real radius = cap ? cap_radius(s) / spacing : portable::cbrt(3.0 / (4 * pi) * static_cast<Real>(count));
  const int reach = static_cast<int>(std::ceil(radius * std::max({axes.x, axes.y, axes.z}))) + 2;
  std::vector<Point> points;
  for (int z = cap ? 0 : -reach; z < (cap ? static_cast<int>(radius + std::max(foot, -radius)) + 3 : reach); ++z) {
    for (int y = -reach; y < reach; ++y) {
      for (int x = -reach; x < reach; ++x) {
        const Vec3 p{x + 0.5, y + 0.5, z + 0.5};
        const Real square = squared_norm(Vec3{p.x / axes.x, p.y / axes.y, (p.z - foot) / axes.z});
        if (square <= (radius + 2) * (radius + 2)) points.push_back({square, p});
      }
    }
  }
  // The outermost points are a choice among equals: spread them by a fixed mixing of the coordinates.
  const auto mix = [](const Vec3& p) {
    const Real m = p.x * 0.8191725 + p.y * 0.6710436 + p.z * 0.5497005;
    return m - std::floor(m);
  };
  std::sort(points.begin(), points.end(), [&](const Point& a, const Point& b) {
    return a.square != b.square ? a.square < b.square : mix(a.at) < mix(b.at);
  });
  IMBIBE_ASSERT(points.size() >= count);
  std::vector<Vec3> result;
  for (std::size_t k = 0; k < count; ++k) result.push_back(spacing * points[k].at);
  return result;
}

// Edge of the cell of a body-centred lattice, in spacings: two points per cell.
const Real cell_edge = portable::cbrt(2.0);

// `count` points of a body-centred lattice that fills the box from below: whole cells along x and y, stretched to the
// box, and layers of half a cell whose height keeps the density: that of liquid that has flowed (disorder_excess), or the box
// would shrink by 0.6 % at once and the larger it is the longer. Its viscosity is nearly the same in all directions; on a
// simple cubic lattice it is 15 % less along the axes, and a slow flow between walls keeps its lattice.
std::vector<Vec3> box_lattice(std::size_t count, const Vec3& size, Real spacing) {
  const auto fit = [&](Real length) {
    return std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(length / (cell_edge * spacing))));
  };
  const std::size_t nx = fit(size.x), ny = fit(size.y), layer = nx * ny;
  const Real width = size.x / static_cast<Real>(nx), depth = size.y / static_cast<Real>(ny);
  const Real height = spacing * spacing * spacing / (width * depth * (1 + disorder_excess));
  std::vector<Vec3> result;
  for (std::size_t k = 0; k < count; ++k) {
    // What is left for the last layer is spread evenly over its places, and is as much thinner.
    const std::size_t level = k / layer, left = std::min(layer, count - level * layer), place = k % layer * layer / left;
    const Real half = level % 2 == 0 ? 0.25 : 0.75, middle = 0.5 * static_cast<Real>(left) / static_cast<Real>(layer);
    result.push_back({width * (static_cast<Real>(place % nx) + half) - 0.5 * size.x,
                      depth * (static_cast<Real>(place / nx) + half) - 0.5 * size.y,
                      height * (static_cast<Real>(level) + middle) - 0.5 * size.z});
  }
  return result;
}

// Whether liquid lies nearer than free_distance to any of the new particles.
bool occupied(const Source& s, const std::vector<Vec3>& points, const Liquid& liquid) {
  const Real gap = free_distance * liquid.spacing();
  Bounds box;
  Real farthest = 0;
  for (const Vec3& p : points) box.include(p), farthest = std::max(farthest, squared_norm(p));
  box.grow(gap);
  const Real reach = std::sqrt(farthest) + gap;
  return std::any_of(liquid.particles.position.begin(), liquid.particles.position.end(), [&](const Float4& f) {
    const Vec3 p = Vec3{f.x, f.y, f.z} - s.centre;
    return box.contains(p) && (s.form == SourceForm::box || squared_norm(p) < reach * reach);
  });
}

// Particles of a pipe come in small batches, so that a rich jet does not cut the step to its own rhythm.
constexpr Real pipe_batch = 4e-3;  // s
constexpr int random_places = 8;
// The narrowest gap, in spacings, that a submerged pipe pushes a particle into.
constexpr Real pushed_distance = 0.4;

Vec3 place_in_pipe(const Source& s, std::uint64_t number, int attempt) {
  const RandomCounter id{s.seed, number, static_cast<std::uint64_t>(attempt)};
  const Vec3 axis = normalized(s.velocity), a = any_perpendicular(axis), b = cross(axis, a);
  const Real r = s.radius * std::sqrt(uniform(id, 0)), angle = 2 * pi * uniform(id, 1);
  return s.centre + r * portable::cos(angle) * a + r * portable::sin(angle) * b - s.length * uniform(id, 2) * axis;
}

EmitReport emit_from_pipe(Source& source, Liquid& liquid, Real t1) {
  EmitReport report;
  const Real gap = free_distance * liquid.spacing();
  const auto due = [&] { return source.start + source.interval * source.emitted; };
  if (source.emitted >= source.count || next_emission(source) >= t1) return report;
  Bounds region = bounds_of(source);
  region.include(region.upper + source.velocity * (t1 - due()));
  region.include(region.lower + source.velocity * (t1 - due()));
  region.grow(gap);
  std::vector<Vec3> taken;
  for (const Float4& f : liquid.particles.position)
    if (const Vec3 p{f.x, f.y, f.z}; region.contains(p)) taken.push_back(p);
  while (source.emitted < source.count && due() < t1) {
    Vec3 place{};
    Real widest = 0;  // squared gap around it
    for (int attempt = 0; attempt < random_places && widest < gap * gap; ++attempt) {
      const Vec3 at = place_in_pipe(source, static_cast<std::uint64_t>(source.emitted), attempt) +
                      std::max(0.0, std::min(t1 - due(), pipe_batch)) * source.velocity;
      Real nearest = gap * gap;
      for (const Vec3& p : taken) nearest = std::min(nearest, squared_norm(p - at));
      if (nearest > widest) widest = nearest, place = at;
    }
    const Real least = source.submerged ? pushed_distance * liquid.spacing() : gap;
    if (widest < least * least) {
      report.waiting = true;
      break;
    }
    add_particle(liquid, place, source.velocity);
    taken.push_back(place);
    ++source.emitted, ++report.particles;
    source.supplied_kg += liquid.particle_mass;
    report.kg += liquid.particle_mass;
  }
  return report;
}

// Velocity at place x of a box (from its middle) by its vortex.
Vec3 vortex_velocity(const Source& s, const Vec3& x) {
  const Real u = pi * (x.x / s.size.x + 0.5), v = pi * (x.y / s.size.y + 0.5);
  return s.vortex * Vec3{portable::sin(u) * portable::cos(v), -s.size.y / s.size.x * portable::cos(u) * portable::sin(v), 0};
}

}  // namespace

Real next_emission(const Source& source) {
  if (source.emitted >= source.count) return std::numeric_limits<Real>::infinity();
  if (source.form == SourceForm::pipe) {
    const int batch = std::clamp(static_cast<int>(pipe_batch / source.interval), 1, source.count - source.emitted);
    return source.start + source.interval * (source.emitted + batch - 1);
  }
  return source.start + source.interval * source.emitted;
}

std::size_t particle_count(const Source& source, const Liquid& liquid) {
  if (source.form == SourceForm::pipe) return static_cast<std::size_t>(source.count);
  return rounded_count(volume_of(source), liquid.particle_mass / liquid.kind.density);
}

Bounds bounds_of(const Source& source) {
  if (source.form == SourceForm::pipe) {
    Bounds b;
    const Vec3 axis = normalized(source.velocity);
    for (const Vec3& end : {source.centre, source.centre - source.length * axis}) b.include(end);
    const auto across = [&](Real a) { return source.radius * std::sqrt(std::max(0.0, 1 - a * a)); };
    const Vec3 half{across(axis.x), across(axis.y), across(axis.z)};
    return {b.lower - half, b.upper + half};
  }
  const Real radius = portable::cbrt(3 * source.volume / (4 * pi));
  if (source.form == SourceForm::drop && source.cap_angle > 0) {
    const Real r = cap_radius(source), wide = source.cap_angle > pi / 2 ? r : r * portable::sin(source.cap_angle);
    return {source.centre - Vec3{wide, wide, 0}, source.centre + Vec3{wide, wide, r * (1 - portable::cos(source.cap_angle))}};
  }
  const Vec3 half = source.form == SourceForm::box ? 0.5 * source.size : radius * unit_axes(source);
  return {source.centre - half, source.centre + half};
}

EmitReport emit(Source& source, Liquid& liquid, Real t0, Real t1) {
  IMBIBE_ASSERT(liquid.particle_mass > 0 && t1 >= t0);
  if (source.form == SourceForm::pipe) return emit_from_pipe(source, liquid, t1);
  EmitReport report;
  const Real particle_volume = liquid.particle_mass / liquid.kind.density;
  while (next_emission(source) < t1) {
    const Real wanted = volume_of(source) + source.carried;
    const std::size_t count = rounded_count(wanted, particle_volume);
    const std::vector<Vec3> points = source.form == SourceForm::box
                                         ? box_lattice(count, source.size, liquid.spacing())
                                         : drop_lattice(source, count, liquid.spacing());
    if (occupied(source, points, liquid)) {
      report.waiting = true;
      break;
    }
    for (const Vec3& p : points) {
      const bool turning = source.form == SourceForm::box && source.vortex != 0;
      add_particle(liquid, source.centre + p, turning ? source.velocity + vortex_velocity(source, p) : source.velocity);
    }
    const Real kg = static_cast<Real>(count) * liquid.particle_mass;
    source.carried = wanted - static_cast<Real>(count) * particle_volume;
    source.supplied_kg += kg;
    ++source.emitted;
    report.particles += count;
    report.kg += kg;
  }
  return report;
}

}  // namespace imbibe
