#include "imbibe/liquid/boundary.h"

#include <algorithm>
#include <array>
#include <optional>

#include "imbibe/core/error.h"
#include "imbibe/core/parallel.h"
#include "imbibe/core/portable.h"
#include "imbibe/geometry/bounds.h"
#include "imbibe/geometry/mesh_distance.h"
#include "imbibe/liquid/neighbours.h"
#include "imbibe/liquid/wall_push.h"

namespace imbibe {

namespace {

Vec3 place(const Float4& p) { return {p.x, p.y, p.z}; }

struct SolidSum {
  Real lambda = 0;
  Vec3 gradient{};
};

// The part of the kernel inside a convex solid that is an intersection of slabs: the product of the parts inside each
// slab. Exact on faces, and on an edge's line by symmetry (1/4, 1/8); W is not a product, so not exact between.
class SlabProduct {
 public:
  void add(const SolidIntegral& part, const Vec3& outward) {
    gradient_ = gradient_ * part.lambda + outward * (lambda_ * part.slope);
    lambda_ *= part.lambda;
  }
  SolidSum sum() const { return {lambda_, gradient_}; }

 private:
  Real lambda_ = 1;
  Vec3 gradient_{};
};

Real sign(Real x) { return x < 0 ? -1.0 : 1.0; }

SolidSum solid_sum(const Plane& s, const Vec3& p, Real h) {
  SlabProduct product;
  product.add(half_space_integral(dot(p - s.point, s.normal), h), s.normal);
  return product.sum();
}

SolidSum solid_sum(const Box& s, const Vec3& p, Real h) {
  const Vec3 from = s.from_centre(p);
  SlabProduct product;
  product.add(half_space_integral(std::abs(from.x) - 0.5 * s.size.x, h), sign(from.x) * s.axes[0]);
  product.add(half_space_integral(std::abs(from.y) - 0.5 * s.size.y, h), sign(from.y) * s.axes[1]);
  product.add(half_space_integral(std::abs(from.z) - 0.5 * s.size.z, h), sign(from.z) * s.axes[2]);
  return product.sum();
}

SolidSum solid_sum(const Sphere& s, const Vec3& p, Real h) {
  const Vec3 from = p - s.centre;
  SlabProduct product;
  product.add(solid_integral(norm(from) - s.radius, 2 / s.radius, h), normalized(from));
  return product.sum();
}

// A point in the coordinates of a body of revolution: height above the base, distance from the axis, and its direction.
struct AxialPoint {
  Real height, radius;
  Vec3 outward;
};

AxialPoint axial(const Vec3& base, const Vec3& axis, const Vec3& p) {
  const Vec3 from = p - base;
  const Real height = dot(from, axis);
  const Vec3 across = from - axis * height;
  return {height, norm(across), normalized(across)};
}

SolidSum solid_sum(const Cylinder& s, const Vec3& p, Real h) {
  const AxialPoint a = axial(s.base, s.axis, p);
  const Real above = a.height - 0.5 * s.height;
  SlabProduct product;
  product.add(solid_integral(a.radius - s.radius, 1 / s.radius, h), a.outward);
  product.add(half_space_integral(std::abs(above) - 0.5 * s.height, h), s.axis * sign(above));
  return product.sum();
}

SolidSum solid_sum(const Cone& s, const Vec3& p, Real h) {
  const AxialPoint a = axial(s.base, s.axis, p);
  const Real slant = portable::hypot(s.radius, s.height);
  const Real radial = s.height / slant, axial_part = s.radius / slant;  // outward normal of the side
  const Real distance = (a.radius - s.radius) * radial + a.height * axial_part;
  // Curved like a circle of the foot point's distance from the axis; near the apex no more than a ball of radius H/2.
  const Real foot = std::max(a.radius - distance * radial, 0.0);
  const Real curvature = std::min(radial / std::max(foot, 1e-3 * h), 4 / h);
  SlabProduct product;
  product.add(solid_integral(distance, curvature, h), a.outward * radial + s.axis * axial_part);
  product.add(half_space_integral(-a.height, h), -s.axis);
  return product.sum();
}

// A half-space behind the nearest point.
SolidSum solid_sum(const SurfaceSample& nearest, Real h) {
  SlabProduct product;
  product.add(half_space_integral(nearest.distance, h), nearest.normal);
  return product.sum();
}

SolidSum sum_of(const Shape& shape, const Vec3& p, Real h) {
  return std::visit([&](const auto& s) {
    if constexpr (std::is_same_v<std::decay_t<decltype(s)>, MeshShape>) return solid_sum(nearest_surface(shape, p), h);
    else return solid_sum(s, p, h);
  }, shape);
}

// A thin box as a sheet: its thin axis, and half its lengths.
struct Sheet {
  Box box;
  Real half[3];
  int axis = 2;
  Vec3 normal(Real side) const { return side * box.axes[static_cast<std::size_t>(axis)]; }
};

Sheet sheet_of(const Box& b) {
  Sheet s{b, {0.5 * b.size.x, 0.5 * b.size.y, 0.5 * b.size.z}, 2};
  for (int a = 0; a < 2; ++a) {
    if (s.half[a] < s.half[s.axis]) s.axis = a;
  }
  return s;
}

// Where a point lies relative to a sheet: how far over the face of its side, and whether over or under the sheet rather
// than beside it.
struct SheetPlace {
  Real side = 1;      // +1 above the middle, -1 below
  Real distance = 0;  // m from the face of that side
  bool facing = false;
};

SheetPlace place_at(const Sheet& s, const Vec3& p) {
  const Vec3 d = s.box.from_centre(p);
  const Real from[3] = {d.x, d.y, d.z};
  SheetPlace r;
  r.facing = true;
  for (int a = 0; a < 3; ++a) {
    if (a == s.axis) {
      r.side = sign(from[a]);
      r.distance = std::abs(from[a]) - s.half[a];
    } else {
      r.facing = r.facing && std::abs(from[a]) <= s.half[a];
    }
  }
  return r;
}

// One wall made ready for many queries.
struct PreparedWall {
  const Wall* wall;
  Index index;
  Bounds reach;                // a particle outside sees nothing of it
  bool everywhere;             // no bounds (a plane)
  std::optional<Sheet> sheet;  // two-sided
  int sheet_bit = 0;
};

std::vector<PreparedWall> prepared(std::span<const Wall> walls, Real support) {
  std::vector<PreparedWall> result;
  int sheets = 0;
  for (std::size_t k = 0; k < walls.size(); ++k) {
    if (walls[k].sheet != nullptr) {
      if (walls[k].sheet->surface->empty()) continue;
      PreparedWall soft{&walls[k], static_cast<Index>(k), walls[k].sheet->surface->at_end.nodes[0].bounds, false, {}, 0};
      soft.reach.grow(support + walls[k].sheet->half_thickness);
      IMBIBE_ASSERT(sheets < 16);
      soft.sheet_bit = sheets++;
      result.push_back(soft);
      continue;
    }
    IMBIBE_ASSERT(walls[k].shape != nullptr);
    const bool plane = std::holds_alternative<Plane>(*walls[k].shape);
    PreparedWall w{&walls[k], static_cast<Index>(k), plane ? Bounds{} : bounds_of(*walls[k].shape), plane, {}, 0};
    w.reach.grow(support);
    const Box* box = std::get_if<Box>(walls[k].shape);
    if (walls[k].two_sided && box != nullptr) {
      IMBIBE_ASSERT(sheets < 16);
      w.sheet = sheet_of(*box);
      w.sheet_bit = sheets++;
    }
    result.push_back(w);
  }
  return result;
}

// A sheet seen by a particle: all the solid behind the face on the particle's side, ending at the sheet's edges.
SolidSum sheet_sum(const Sheet& s, const SheetPlace& at, const Vec3& p, Real h) {
  const Vec3 d = s.box.from_centre(p);
  const Real from[3] = {d.x, d.y, d.z};
  SlabProduct product;
  for (int a = 0; a < 3; ++a) {
    const Real distance = a == s.axis ? at.distance : std::abs(from[a]) - s.half[a];
    product.add(half_space_integral(distance, h),
                (a == s.axis ? at.side : sign(from[a])) * s.box.axes[static_cast<std::size_t>(a)]);
  }
  return product.sum();
}

// A soft sheet near a particle: a half-space behind its nearest point, on the particle's own side. Beside its outline
// there is nothing of it.
bool sample_soft(const PreparedWall& w, const Vec3& p, Real support, SurfaceSample& nearest, SolidSum& sum,
                 std::uint32_t& side, SheetFoot& foot) {
  const SheetWall& sheet = *w.wall->sheet;
  const NearestOnSheet near = nearest_on(*sheet.surface, p, support + sheet.half_thickness);
  if (near.at.triangle == no_index || near.on_border) return false;
  nearest = {near.distance - sheet.half_thickness, near.normal};
  if (nearest.distance >= support) return false;
  side |= (near.side > 0 ? 1u : 1u << 16) << w.sheet_bit;
  SlabProduct product;
  product.add(half_space_integral(nearest.distance, support), near.normal);
  sum = product.sum();
  foot = {};
  foot.wall = w.index;
  foot.node = sheet.surface->mesh.triangles[near.at.triangle];
  Vec3 velocity{};
  for (std::size_t c = 0; c < 3; ++c) {
    foot.weight[c] = static_cast<float>(near.at.weight[c]);
    velocity += near.at.weight[c] * sheet.velocity[foot.node[c]];
  }
  foot.velocity = Vec3f(velocity);
  return true;
}

std::optional<SurfaceSample> nearest_of_mesh(const MeshDistance& mesh, const Vec3& p, Real support,
                                             Boundary::MeshMemory& memory) {
  if (squared_norm(p - memory.clear_centre) <= memory.clear_squared) return std::nullopt;
  const Real searched = 3 * support;
  const std::optional<SurfaceSample> nearest = mesh.nearest_within(p, searched);
  const Real clear = (nearest ? std::abs(nearest->distance) : searched) - support;
  // Inside the solid nothing is clear, however far its surface.
  if (clear > 0 && !(nearest && nearest->distance < 0)) memory = {p, clear * clear};
  return nearest;
}

bool sample_wall(const PreparedWall& w, const Vec3& p, Real support, Boundary::MeshMemory& memory, WallSample& out,
                 std::uint32_t& side, SheetFoot& foot) {
  if (!w.everywhere && !w.reach.contains(p)) return false;
  SurfaceSample nearest;
  SolidSum sum;
  if (w.wall->sheet != nullptr) {
    if (!sample_soft(w, p, support, nearest, sum, side, foot)) return false;
  } else if (w.sheet) {
    const SheetPlace at = place_at(*w.sheet, p);
    if (at.facing && at.distance < support) side |= (at.side > 0 ? 1u : 1u << 16) << w.sheet_bit;
    if (at.facing) {
      nearest = {at.distance, w.sheet->normal(at.side)};
    } else {
      nearest = nearest_surface(*w.wall->shape, p);
    }
    if (nearest.distance >= support) return false;
    sum = sheet_sum(*w.sheet, at, p, support);
  } else if (const MeshShape* mesh = std::get_if<MeshShape>(w.wall->shape)) {
    const std::optional<SurfaceSample> found = nearest_of_mesh(**mesh, p, support, memory);
    if (!found || found->distance >= support) return false;
    nearest = *found;
    sum = solid_sum(nearest, support);
  } else {
    nearest = nearest_surface(*w.wall->shape, p);
    if (nearest.distance >= support) return false;
    sum = sum_of(*w.wall->shape, p, support);
  }
  out.distance = static_cast<float>(nearest.distance);
  out.normal = Vec3f(nearest.normal);
  out.lambda = static_cast<float>(sum.lambda);
  out.gradient = Vec3f(sum.gradient);
  const Wall& wall = *w.wall;
  // A quarter of a spacing is where the outermost layer rests; nearer the rate would grow without bound.
  const Real nearest_layer = 0.25 * support / support_over_spacing;
  out.shear = static_cast<float>(wall.material.friction *
                                 half_space_shear(std::max(nearest.distance, nearest_layer), support));
  out.friction = static_cast<float>(wall.material.friction);
  const Vec3f velocity(wall.material.velocity);
  out.velocity = velocity - dot(velocity, out.normal) * out.normal;
  out.wall = w.index;
  out.foot = no_index;
  return true;
}

// The nearest walls first, at most walls_per_particle.
struct NearestSamples {
  std::array<WallSample, walls_per_particle> sample;
  int count = 0;

  void add(const WallSample& s) {
    int k = count < walls_per_particle ? count++ : walls_per_particle;
    for (; k > 0 && s.distance < sample[static_cast<std::size_t>(k - 1)].distance; --k) {
      if (k < walls_per_particle) sample[static_cast<std::size_t>(k)] = sample[static_cast<std::size_t>(k - 1)];
    }
    if (k < walls_per_particle) sample[static_cast<std::size_t>(k)] = s;
  }

  // Weights each gradient by the liquid's part at the other walls; G and lambda together into `all`, P into push.
  void combine(Float4& all, Float4& push, float support) {
    constexpr std::array<float, walls_per_particle> touching{1, 1, 1};
    float open = 1;
    for (int k = 0; k < count; ++k) {
      float others = 1;
      for (int l = 0; l < count; ++l) {
        if (l != k) others *= 1 - sample[static_cast<std::size_t>(l)].lambda;
      }
      WallSample& s = sample[static_cast<std::size_t>(k)];
      open *= 1 - s.lambda;
      s.gradient *= others;
      all.x += s.gradient.x, all.y += s.gradient.y, all.z += s.gradient.z;
    }
    all.w = 1 - open;
    const std::span<WallSample> samples{sample.data(), static_cast<std::size_t>(count)};
    set_pushes(samples, touching, support);
    for (const WallSample& s : samples) push.x += s.push.x, push.y += s.push.y, push.z += s.push.z;
  }
};

}  // namespace

WallAngles angles_at(const Wall& wall, const Vec3& place) {
  const auto cosine = [](Real angle) { return static_cast<float>(portable::cos(angle)); };
  const WallMaterial& m = wall.material;
  WallAngles angles;
  if (wall.angles_at) angles = wall.angles_at(place);
  else angles = {cosine(m.contact_angle), cosine(m.receding_angle < 0 ? m.contact_angle : m.receding_angle)};
  angles.cos_receding = std::max(angles.cos_advancing, angles.cos_receding);
  return angles;
}

void sample_walls(Boundary& boundary, std::span<const Float4> position, std::size_t count, std::span<const Wall> walls,
                  const Kernel& kernel) {
  static_assert(Boundary::default_tile_size == default_tile);
  const std::vector<PreparedWall> ready = prepared(walls, kernel.support);
  const bool sheets = std::any_of(ready.begin(), ready.end(), [](const PreparedWall& w) {
    return w.sheet.has_value() || w.wall->sheet != nullptr;
  });
  boundary.tiles.resize((count + default_tile - 1) / default_tile);
  boundary.wall.assign(padded_size(count), Float4{});
  boundary.push.assign(padded_size(count), Float4{});
  boundary.side.resize(sheets ? count : 0);
  boundary.near_walls = parallel_sum(count, [&](std::size_t begin, std::size_t end) {
    Boundary::Tile& tile = boundary.tiles[begin / default_tile];
    tile.samples.clear(), tile.feet.clear();
    tile.first.assign(1, 0);
    std::size_t near = 0;
    std::vector<Boundary::MeshMemory>& memory = tile.mesh_memory;
    memory.assign(ready.size(), {});
    for (std::size_t i = begin; i < end; ++i) {
      NearestSamples found;
      std::uint32_t side = 0;
      WallSample sample;
      SheetFoot foot;
      for (std::size_t k = 0; k < ready.size(); ++k) {
        const PreparedWall& w = ready[k];
        if (!sample_wall(w, place(position[i]), kernel.support, memory[k], sample, side, foot)) continue;
        if (w.wall->sheet != nullptr) {
          foot.particle = static_cast<Index>(i);
          sample.foot = static_cast<Index>(tile.feet.size());
          tile.feet.push_back(foot);
        }
        found.add(sample);
      }
      if (found.count > 0) found.combine(boundary.wall[i], boundary.push[i], kernel.support), ++near;
      if (sheets) boundary.side[i] = side;
      tile.samples.insert(tile.samples.end(), found.sample.begin(), found.sample.begin() + found.count);
      tile.first.push_back(static_cast<std::uint16_t>(tile.samples.size()));
    }
    return near;
  });
}

void collect_feet(Boundary& boundary, std::vector<SheetFoot*>& feet) {
  feet.clear();
  for (Boundary::Tile& tile : boundary.tiles)
    for (const WallSample& sample : tile.samples) {
      if (sample.foot == no_index || squared_norm(sample.push) == 0) continue;
      SheetFoot& foot = tile.feet[sample.foot];
      foot.push = sample.push;
      feet.push_back(&foot);
    }
}

void give_feet_impulses(const Boundary& boundary, std::span<const Wall> walls, std::vector<Vec3>& wall_impulse) {
  for (std::size_t k = 0; k < walls.size(); ++k)
    if (walls[k].sheet != nullptr) wall_impulse[k] = {};
  for (const Boundary::Tile& tile : boundary.tiles)
    for (const SheetFoot& foot : tile.feet) {
      std::vector<Vec3>& nodes = walls[foot.wall].sheet->impulse;
      // The parts of a foot make its whole, which weights of single precision alone do not.
      const Vec3 first = static_cast<Real>(foot.weight[0]) * foot.impulse, second = static_cast<Real>(foot.weight[1]) * foot.impulse;
      nodes[foot.node[0]] += first, nodes[foot.node[1]] += second;
      nodes[foot.node[2]] += foot.impulse - first - second;
      wall_impulse[foot.wall] += foot.impulse;
    }
}

void add_wall_impulse(const Boundary& boundary, std::span<const float> coefficient, Real scale,
                      std::vector<Vec3>& impulse) {
  // Serial: only the particles near walls take part, and the order of the sum is fixed.
  for (std::size_t t = 0; t < boundary.tiles.size(); ++t) {
    const Boundary::Tile& tile = boundary.tiles[t];
    for (std::size_t k = 0; k + 1 < tile.first.size() && !tile.samples.empty(); ++k) {
      const Real c = scale * static_cast<Real>(coefficient[t * default_tile + k]);
      for (std::size_t s = tile.first[k]; s < tile.first[k + 1]; ++s) {
        impulse[tile.samples[s].wall] += c * Vec3(tile.samples[s].push);
      }
    }
  }
}

namespace {

// Where a particle that moved lies relative to a wall it was sampled on; for a sheet relative to the face it came from.
SurfaceSample place_after(const Wall& wall, const Vec3& before, const Vec3& now) {
  const Box* box = wall.two_sided ? std::get_if<Box>(wall.shape) : nullptr;
  if (box == nullptr) return nearest_surface(*wall.shape, now);
  const Sheet sheet = sheet_of(*box);
  const SheetPlace was = place_at(sheet, before), is = place_at(sheet, now);
  if (!is.facing) return {std::numeric_limits<Real>::infinity(), {}};
  if (!was.facing || was.side == is.side) return {is.distance, sheet.normal(is.side)};
  return {-is.distance - 2 * sheet.half[sheet.axis], sheet.normal(was.side)};  // through the sheet
}

}  // namespace

std::size_t keep_outside(const Boundary& boundary, std::span<const Float4> before, std::span<Float4> position,
                         std::span<Float4> velocity, std::size_t count, std::span<const Wall> walls, Real spacing,
                         Real particle_mass, std::vector<Vec3>& impulse) {
  const Real gap = 1e-3 * spacing;  // far above the rounding of a single-precision position
  struct Part {
    std::size_t put_back = 0;
    std::vector<Vec3> impulse;  // empty while nothing was put back
  };
  std::vector<Part> parts((count + default_tile - 1) / default_tile);
  parallel_tiles(count, [&](std::size_t begin, std::size_t end) {
    Part& part = parts[begin / default_tile];
    for (std::size_t i = begin; i < end; ++i) {
      bool moved = false;
      for (const WallSample& sample : boundary.samples(i)) {
        if (sample.foot != no_index) continue;  // soft sheets: swept after they have moved too (coupling)
        const Vec3 was = place(before[i]), p = place(position[i]);
        const Real distance = static_cast<Real>(sample.distance) - gap;
        if (distance > 0 && squared_norm(p - was) < distance * distance) continue;  // cannot have reached it
        const SurfaceSample now = place_after(walls[sample.wall], was, p);
        if (now.distance >= 0) continue;
        moved = true;
        store(position[i], p + now.normal * (gap - now.distance));
        const Vec3 v = place(velocity[i]);
        const Real into = dot(v, now.normal);
        if (into >= 0) continue;
        store(velocity[i], v - now.normal * into);
        if (part.impulse.empty()) part.impulse.resize(impulse.size());
        part.impulse[sample.wall] += now.normal * (into * particle_mass);
      }
      part.put_back += moved ? 1 : 0;
    }
  });
  std::size_t put_back = 0;
  for (const Part& part : parts) {
    put_back += part.put_back;
    for (std::size_t k = 0; k < part.impulse.size(); ++k) impulse[k] += part.impulse[k];
  }
  return put_back;
}

}  // namespace imbibe
