#include "imbibe/liquid/drop_measure.h"

#include <algorithm>
#include <array>

#include "imbibe/core/error.h"
#include "imbibe/core/parallel.h"
#include "imbibe/core/portable.h"
#include "imbibe/liquid/kernel.h"

namespace imbibe {

namespace {

constexpr Real level_depth = 0.0347;  // of H^2 kappa: M(0)/(2 A(0)) of kernel.h

// A solid seen in the frame of its axis: z along it, from the solid's top.
class Ground {
 public:
  Ground(const Shape& solid, const Plane& frame) : solid_(solid), frame_(frame) {
    const Vec3 up = frame.normal;
    first_ = normalized(cross(up, std::abs(up.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
    second_ = cross(up, first_);
  }
  bool plane() const { return std::holds_alternative<Plane>(solid_); }
  Vec3 to_frame(const Vec3& world) const {
    const Vec3 x = world - frame_.point;
    return {dot(x, first_), dot(x, second_), dot(x, frame_.normal)};
  }
  Real distance(const Vec3& x) const { return plane() ? x.z : sample(x).distance; }
  // Cosine between the wall's normal and the outward normal of a profile of this slope there.
  Real cosine(Real radius, Real height, Real slope) const {
    const Vec3 m = sample({radius, 0, height}).normal;
    return portable::sin(slope) * dot(m, first_) + portable::cos(slope) * dot(m, frame_.normal);
  }
  // Height of the surface at this distance from the axis, from above: steps of the distance never pass it.
  Real height(Real radius) const {
    Real z = 0;
    for (int i = 0; i < 200; ++i) z -= sample({radius, 0, z}).distance;
    return z;
  }

 private:
  SurfaceSample sample(const Vec3& x) const {
    return nearest_surface(solid_, frame_.point + first_ * x.x + second_ * x.y + frame_.normal * x.z);
  }
  const Shape& solid_;
  Plane frame_;
  Vec3 first_{}, second_{};
};

// Particles in the frame of the wall, in bins of the kernel's support.
class ColourField {
 public:
  ColourField(const Liquid& liquid, const Ground& ground)
      : ground_(ground), kernel_(kernel_for(liquid.spacing())), volume_(liquid.particle_mass / liquid.kind.density) {
    for (const Float4& p : liquid.particles.position) {
      particles_.push_back({ground.to_frame({p.x, p.y, p.z}), 0});
      particles_.back().bin = bin(particles_.back().place);
    }
    std::sort(particles_.begin(), particles_.end(), [](const auto& a, const auto& b) { return a.bin < b.bin; });
  }

  Vec3 centre() const {
    Vec3 sum{};
    for (const Particle& p : particles_) sum += p.place;
    return sum / static_cast<Real>(particles_.size());
  }

  // Liquid's share of the kernel at x, of the part outside the wall.
  Real at(const Vec3& x) const {
    Real sum = 0;
    for (int dz = -1; dz <= 1; ++dz)
      for (int dy = -1; dy <= 1; ++dy) {
        // The three bins along x follow each other.
        const std::uint64_t middle = bin(x + Vec3{0, static_cast<Real>(dy), static_cast<Real>(dz)} * kernel_.support);
        auto p = std::lower_bound(particles_.begin(), particles_.end(), middle - 1,
                                  [](const Particle& a, std::uint64_t b) { return a.bin < b; });
        for (; p != particles_.end() && p->bin <= middle + 1; ++p)
          sum += kernel_.value(static_cast<float>(norm(x - p->place)));
      }
    return volume_ * sum / (1 - half_space_integral(std::max(0.0, ground_.distance(x)), kernel_.support).lambda);
  }

  // Distance along the unit direction where the liquid ends; < 0: no liquid at the start. Steps of a quarter spacing.
  Real end_of_liquid(const Vec3& start, const Vec3& direction) const {
    const Real step = 0.1 * kernel_.support;
    if (at(start) < 0.5) return -1;
    Real inside = 0, outside = step;
    while (at(start + direction * outside) >= 0.5) inside = outside, outside += step;
    for (int i = 0; i < 12; ++i) {
      const Real middle = 0.5 * (inside + outside);
      (at(start + direction * middle) >= 0.5 ? inside : outside) = middle;
    }
    return inside;
  }

  Real support() const { return kernel_.support; }
  const Ground& ground() const { return ground_; }

 private:
  struct Particle {
    Vec3 place;
    std::uint64_t bin;
  };
  std::uint64_t bin(const Vec3& x) const {
    const auto part = [&](Real v) {
      return static_cast<std::uint64_t>(std::floor(v * static_cast<Real>(kernel_.inverse)) + (1 << 20)) & 0x1fffff;
    };
    return part(x.z) << 42 | part(x.y) << 21 | part(x.x);
  }
  const Ground& ground_;
  Kernel kernel_;
  Real volume_;
  std::vector<Particle> particles_;
};

struct SurfacePoint {
  Real radius, height, weight;
  Real radial, up;  // the ray's direction, along which the level's depth is put back
};

constexpr int azimuths = 32;

std::vector<SurfacePoint> surface_points(const ColourField& field, const Vec3& centre, Real nearest) {
  constexpr int polars = 60;
  std::vector<std::vector<SurfacePoint>> rings(polars);
  parallel_for(polars, [&](std::size_t k) {
    const Real polar = pi * (static_cast<Real>(k) + 0.5) / polars;
    for (int a = 0; a < azimuths; ++a) {
      const Real turn = 2 * pi * (a + 0.5 * static_cast<Real>(k % 2)) / azimuths;
      const Vec3 way{portable::sin(polar) * portable::cos(turn), portable::sin(polar) * portable::sin(turn), portable::cos(polar)};
      // A ray that ends at the wall finds no surface; do not follow it there.
      if (way.z < 0 && (field.ground().distance(centre) - nearest) / -way.z < field.support()) continue;
      const Real length = field.end_of_liquid(centre, way);
      const Vec3 x = centre + way * length;
      if (length < 0 || field.ground().distance(x) < nearest) continue;
      rings[k].push_back({portable::hypot(x.x - centre.x, x.y - centre.y), x.z,
                          portable::sin(polar) * length * length, portable::sin(polar), way.z});
    }
  }, 1);
  std::vector<SurfacePoint> all;
  for (const auto& ring : rings) all.insert(all.end(), ring.begin(), ring.end());
  return all;
}

// Signed distance of (r, depth) from the profile, > 0 outside, and the curvature of the surface there.
struct Deviation {
  Real distance, curvature;
};

Deviation deviation(const SessileShape& shape, Real c, Real r, Real depth) {
  Real best = std::numeric_limits<Real>::infinity();
  Deviation d{};
  for (const ProfilePoint& p : shape.profile) {
    const Real dr = r - p.radius, dz = depth - p.depth, square = dr * dr + dz * dz;
    if (square >= best) continue;
    best = square;
    d = {dr * portable::sin(p.slope) - dz * portable::cos(p.slope), 2 * shape.apex_curvature + c * p.depth};
  }
  return d;
}

// Least squares over b and h (Gauss-Newton, derivatives by differences).
class ProfileFit {
 public:
  // below: how far profiles are followed under the frame's level.
  ProfileFit(std::vector<SurfacePoint> points, Real c, Real support, Real step, Real below)
      : points_(std::move(points)), c_(c), support_(support), step_(step), below_(below) {}

  SessileShape fit(Real b, Real h) {
    for (int i = 0; i < 12; ++i) {
      const std::vector<Real> here = residuals(b, h);
      const Real db = 1e-3 * b, dh = 1e-3 * h;
      const std::vector<Real> at_b = residuals(b + db, h), at_h = residuals(b, h + dh);
      Real bb = 0, bh = 0, hh = 0, rb = 0, rh = 0;
      for (std::size_t k = 0; k < points_.size(); ++k) {
        const Real w = points_[k].weight, jb = (at_b[k] - here[k]) / db, jh = (at_h[k] - here[k]) / dh;
        bb += w * jb * jb, bh += w * jb * jh, hh += w * jh * jh, rb += w * jb * here[k], rh += w * jh * here[k];
      }
      const Real determinant = bb * hh - bh * bh;
      if (!(determinant > 0)) break;
      const Real change_b = (bh * rh - hh * rb) / determinant, change_h = (bh * rb - bb * rh) / determinant;
      b = std::clamp(b + change_b, 0.5 * b, 2 * b), h = std::clamp(h + change_h, 0.7 * h, 1.4 * h);
      if (std::abs(change_b) < 1e-6 * b && std::abs(change_h) < 1e-6 * h) break;
    }
    Real sum = 0, weights = 0;
    const std::vector<Real> here = residuals(b, h);
    for (std::size_t k = 0; k < points_.size(); ++k)
      sum += points_[k].weight * here[k] * here[k], weights += points_[k].weight;
    rms_ = std::sqrt(sum / weights), height_ = h;
    return sessile_profile(b, c_, pi, h + below_, step_);
  }
  Real rms() const { return rms_; }
  Real height() const { return height_; }  // of the fitted apex

 private:
  std::vector<Real> residuals(Real b, Real h) const {
    const SessileShape shape = sessile_profile(b, c_, pi, h + below_, step_);
    std::vector<Real> result(points_.size());
    parallel_for(points_.size(), [&](std::size_t k) {
      const Deviation d = deviation(shape, c_, points_[k].radius, h - points_[k].height);
      result[k] = d.distance + level_depth * support_ * support_ * d.curvature;
    }, 64);
    return result;
  }
  std::vector<SurfacePoint> points_;
  Real c_, support_, step_, below_, rms_ = 0, height_ = 0;
};

// The straight line y = first + second x through points (x, y).
std::array<Real, 2> line_through(const std::vector<std::array<Real, 2>>& points) {
  Real n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const auto& p : points) n += 1, x += p[0], y += p[1], xx += p[0] * p[0], xy += p[0] * p[1];
  const Real slope = (n * xy - x * y) / (n * xx - x * x);
  return {(y - slope * x) / n, slope};
}

// The profile at one height over the wall.
ProfilePoint profile_at(const SessileShape& shape, Real height) {
  const Real depth = shape.height - height;
  const auto after = std::lower_bound(shape.profile.begin() + 1, shape.profile.end() - 1, depth,
                                      [](const ProfilePoint& p, Real d) { return p.depth < d; });
  const ProfilePoint &a = *(after - 1), &b = *after;
  const Real t = b.depth > a.depth ? (depth - a.depth) / (b.depth - a.depth) : 0;
  return {a.radius + t * (b.radius - a.radius), depth, a.slope + t * (b.slope - a.slope)};
}

// The angle at the wall by the slope of the surface near it.
Real slope_angle(const ColourField& field, const Vec3& centre, const SessileShape& shape, Real c, Real spacing) {
  constexpr int levels = 13;
  const Real low = spacing, high = std::min(4 * spacing, std::max(0.6 * shape.height, 2 * spacing));
  std::vector<std::array<Real, 2>> differences(levels);  // height, r^2 - r_fit^2
  parallel_for(levels, [&](std::size_t k) {
    const Real z = low + (high - low) * static_cast<Real>(k) / (levels - 1);
    Real sum = 0, found = 0;
    for (int a = 0; a < azimuths; ++a) {
      const Real turn = 2 * pi * a / azimuths;
      const Real r = field.end_of_liquid({centre.x, centre.y, z}, {portable::cos(turn), portable::sin(turn), 0});
      if (r > 0) sum += r, found += 1;
    }
    const ProfilePoint fitted = profile_at(shape, z);
    // The level lies inside along the normal; along the horizontal that is longer by 1/sin(phi).
    const Real inside =
        level_depth * field.support() * field.support() * (2 * shape.apex_curvature + c * fitted.depth);
    const Real r = sum / std::max(found, 1.0) + inside / std::max(0.2, portable::sin(fitted.slope));
    differences[k] = {z, r * r - fitted.radius * fitted.radius};
  }, 1);
  const auto [difference, difference_slope] = line_through(differences);
  const Real base = std::sqrt(std::max(shape.base_radius * shape.base_radius + difference, 0.0));
  // d(r^2)/dz = 2 r dr/dz, and dr/dz = -cot(theta) with z upwards.
  const Real fitted_slope = -2 * shape.base_radius / portable::tan(shape.angle);
  return portable::atan2(2 * base, -(fitted_slope + difference_slope));
}

}  // namespace

namespace {

// Where the profile with its apex at this height meets the wall, into m.
void meet_wall(const SessileShape& shape, const Ground& ground, Real apex, DropMeasure& m) {
  m.height = apex;
  const auto clear = [&](const ProfilePoint& p) { return ground.distance({p.radius, 0, apex - p.depth}); };
  std::size_t k = 1;
  while (k < shape.profile.size() && clear(shape.profile[k]) > 0) ++k;
  if (k == shape.profile.size()) throw NumericalError(0, 0, "drop measure", "the drop's profile does not meet the wall");
  const ProfilePoint &a = shape.profile[k - 1], &b = shape.profile[k];
  const Real t = clear(a) / (clear(a) - clear(b));
  m.base_radius = a.radius + t * (b.radius - a.radius), m.base_slope = a.slope + t * (b.slope - a.slope);
  const Real level = apex - a.depth - t * (b.depth - a.depth);
  m.fit_angle = portable::acos(std::clamp(ground.cosine(m.base_radius, level, m.base_slope), -1.0, 1.0));
  // The liquid above the base's level, frustum by frustum, less the solid above it.
  for (std::size_t i = 1; i <= k; ++i) {
    const ProfilePoint& above = shape.profile[i - 1];
    const Real radius = i < k ? shape.profile[i].radius : m.base_radius, depth = i < k ? shape.profile[i].depth : apex - level;
    m.volume += pi / 3 * (depth - above.depth) * (above.radius * above.radius + above.radius * radius + radius * radius);
  }
  constexpr int rings = 100;
  for (int i = 0; i < rings; ++i) {
    const Real r = (i + 0.5) / rings * m.base_radius;
    m.volume -= 2 * pi * r * (ground.height(r) - level) * m.base_radius / rings;
  }
}

// The colour of one drop, with what every measure of it begins with.
struct MeasuredDrop {
  MeasuredDrop(const Liquid& liquid, const Ground& ground, Real gravity)
      : dx(liquid.spacing()), c(liquid.kind.density * gravity / liquid.kind.surface_tension),
        nominal(liquid.mass() / liquid.kind.density), field(liquid, ground), centre(field.centre()) {
    for (const Float4& p : liquid.particles.position)
      m.centre += Vec3(p.x, p.y, p.z) / static_cast<Real>(liquid.particles.size());
  }
  void look(const Vec3& from) {
    points = surface_points(field, from, dx);
    m.points = points.size();
    if (points.size() < 50) throw NumericalError(0, 0, "drop measure", "the liquid is not one drop on the wall");
  }
  // The profile that fits best, from a first guess; below: as of ProfileFit.
  SessileShape fit(Real apex_curvature, Real height, Real below) {
    ProfileFit fitted(points, c, field.support(), 0.01 * portable::cbrt(nominal), below);
    const SessileShape shape = fitted.fit(apex_curvature, height);
    m.apex_curvature = shape.apex_curvature, m.fit_deviation = fitted.rms(), m.height = fitted.height();
    return shape;
  }
  Real dx, c, nominal;
  ColourField field;
  Vec3 centre;  // of mass, in the frame
  std::vector<SurfacePoint> points;
  DropMeasure m;
};

void refuse_nothing(const Liquid& liquid) {
  if (liquid.particles.size() == 0) throw NumericalError(0, 0, "drop measure", "there is no liquid");
}

}  // namespace

DropMeasure measure_sessile_drop(const Liquid& liquid, const Plane& wall, Real gravity) {
  refuse_nothing(liquid);
  const Shape solid = wall;
  const Ground ground(solid, wall);
  MeasuredDrop drop(liquid, ground, gravity);
  drop.look(drop.centre);
  DropMeasure& m = drop.m;
  m.centre_angle = angle_of_centre_height(drop.centre.z, drop.nominal, drop.c);
  const SessileShape start = sessile_shape(drop.nominal, m.centre_angle, drop.c);
  const SessileShape shape = drop.fit(start.apex_curvature, start.height, 0);
  m.fit_angle = m.base_slope = shape.angle, m.base_radius = shape.base_radius, m.height = shape.height, m.volume = shape.volume;
  m.slope_angle = slope_angle(drop.field, drop.centre, shape, drop.c, drop.dx);
  return m;
}

DropMeasure measure_drop_on(const Liquid& liquid, const Shape& solid, const Plane& frame, Real gravity) {
  if (const Plane* plane = std::get_if<Plane>(&solid)) return measure_sessile_drop(liquid, *plane, gravity);
  refuse_nothing(liquid);
  const Ground ground(solid, frame);
  MeasuredDrop drop(liquid, ground, gravity);
  // A flat drop's centre of mass may lie in the solid that it surrounds.
  drop.look({drop.centre.x, drop.centre.y, std::max(drop.centre.z, 2 * drop.dx)});
  Real top = 0, wide = 0;
  for (const SurfacePoint& p : drop.points) top = std::max(top, p.height), wide = std::max(wide, p.radius);
  const SessileShape shape = drop.fit(1 / wide, top, 3 * portable::cbrt(drop.nominal));
  meet_wall(shape, ground, drop.m.height, drop.m);
  return drop.m;
}

}  // namespace imbibe
