#include "imbibe/scene/placement_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "imbibe/core/quantity.h"
#include "imbibe/geometry/closest.h"

namespace imbibe {
namespace {

// A drop may touch what it is laid on: this share of its radius is forgiven, for rounded numbers in scene files.
constexpr Real forgiven_share = 0.01;

std::string mm(Real metres) { return fmt::format("{:.3g} mm", metres * 1e3); }

Vec3 half_size(const Source& s) {
  const Bounds b = bounds_of(s);
  return 0.5 * b.size();
}

Real volume_of(const Source& s) {
  return s.form == SourceForm::box ? s.size.x * s.size.y * s.size.z : s.volume;
}

Vec3 half_extent(const Textile& textile) {
  const YarnNetwork& n = textile.fabric->network;
  return {0.5 * n.size_x, 0.5 * n.size_y, 0.5 * n.thickness};
}

// Signed distance of a point to a box about the origin.
Real distance_to_box(const Vec3& p, const Vec3& half) {
  const Vec3 q{std::abs(p.x) - half.x, std::abs(p.y) - half.y, std::abs(p.z) - half.z};
  const Vec3 outside{std::max(q.x, 0.0), std::max(q.y, 0.0), std::max(q.z, 0.0)};
  return norm(outside) + std::min(std::max({q.x, q.y, q.z}), 0.0);
}

// How deep a source reaches into something whose signed distance is `distance(point)`. Exact for balls; other forms
// by their bounding box, tried at the points of a 5 x 5 x 5 lattice on and in them.
template <class Distance>
Real depth_inside(const Source& s, Distance&& distance) {
  const Vec3 half = half_size(s);
  const bool ball = s.form == SourceForm::drop && s.cap_angle <= 0 && s.stretch == Vec3{1, 1, 1};
  const Bounds bounds = bounds_of(s);
  const Vec3 middle = 0.5 * (bounds.lower + bounds.upper);
  if (ball) return (1 - forgiven_share) * half.x - distance(s.centre);
  Real deepest = -1e30;
  for (int i = -2; i <= 2; ++i)
    for (int j = -2; j <= 2; ++j)
      for (int k = -2; k <= 2; ++k) {
        const Vec3 p = middle + (0.5 - 0.5 * forgiven_share) * Vec3{i * half.x, j * half.y, k * half.z};
        deepest = std::max(deepest, -distance(p));
      }
  return deepest;
}

Real widest(const Source& s) {
  const Vec3 half = half_size(s);
  return std::max({half.x, half.y, half.z});
}

bool overlap(const Source& a, const Source& b) {
  if (a.form == SourceForm::drop && b.form == SourceForm::drop)
    return norm(a.centre - b.centre) < (1 - forgiven_share) * (widest(a) + widest(b));
  if (a.form == SourceForm::box && b.form == SourceForm::box) {
    const Vec3 d = a.centre - b.centre, sum = (1 - forgiven_share) * (half_size(a) + half_size(b));
    return std::abs(d.x) < sum.x && std::abs(d.y) < sum.y && std::abs(d.z) < sum.z;
  }
  const Source& drop = a.form == SourceForm::drop ? a : b;
  const Source& box = a.form == SourceForm::drop ? b : a;
  return distance_to_box(drop.centre - box.centre, half_size(box)) < (1 - forgiven_share) * widest(drop);
}

// Sources that start at the same time must not share room; a later one waits until its place is free. Sweep along x.
void check_overlaps(const Scene& scene, const std::vector<Source>& sources, std::vector<Problem>& problems) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < sources.size(); ++i)
    if (sources[i].form != SourceForm::pipe) order.push_back(i);
  const auto left = [&](std::size_t i) { return bounds_of(sources[i]).lower.x; };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return left(a) < left(b); });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Real right = bounds_of(sources[order[i]]).upper.x;
    for (std::size_t j = i + 1; j < order.size() && left(order[j]) < right; ++j) {
      const std::size_t first = std::min(order[i], order[j]), second = std::max(order[i], order[j]);
      if (sources[first].start != sources[second].start || !overlap(sources[first], sources[second])) continue;
      problems.push_back(scene_problem(scene, key_of_source(scene, second) + ".centre",
                                       fmt::format("'{}' overlaps '{}', which starts at the same time",
                                                   sources[second].name, sources[first].name)));
    }
  }
}

// m, from a point to the faces of a cloth on that sheet; < 0 inside the cloth.
Real distance_to_cloth(const SoftSheet& soft, const Vec3& point) {
  const Sheet& sheet = soft.sheet;
  Real nearest = unlimited;
  for (const auto& t : sheet.triangles)
    nearest = std::min(nearest, norm(closest_on_triangle(point, sheet.position[t[0]], sheet.position[t[1]], sheet.position[t[2]]).point - point));
  return nearest - 0.5 * soft.cloth.hand.thickness;
}

// The soft sheet that the world's textile lies on in the running world; null: it lies flat.
const SoftSheet* bent_sheet(const World* running, std::size_t textile) {
  const bool known = running && textile < running->textiles.size() && running->textiles[textile].cloth;
  return known ? &running->textiles[textile].cloth->soft : nullptr;
}

void check_source(const Scene& scene, const World& world, const World* running, std::size_t i, std::vector<Problem>& problems) {
  const Source& s = world.sources[i];
  if (s.emitted >= s.count) return;  // it has fallen already, in a running world
  if (s.form == SourceForm::pipe) return;  // checked by check_pipes
  const std::string key = key_of_source(scene, i);
  const auto fail = [&](const std::string& message) {
    problems.push_back(scene_problem(scene, key + ".centre", message));
  };
  for (std::size_t t = 0; t < world.textiles.size(); ++t) {
    const Textile& textile = world.textiles[t];
    const SoftSheet* bent = bent_sheet(running, t);
    const Real depth = depth_inside(s, [&](const Vec3& p) { return bent ? distance_to_cloth(*bent, p) : distance_to_sheet(textile, p); });
    if (depth > 0) fail(fmt::format("'{}' reaches {} into textile '{}'; move it away by as much", s.name, mm(depth), textile.name));
  }
  for (const SolidBody& solid : world.solids) {
    const Real depth = depth_inside(s, [&](const Vec3& p) { return nearest_surface(solid.shape, p).distance; });
    if (depth > 0) fail(fmt::format("'{}' reaches {} into solid '{}'; move it away by as much", s.name, mm(depth), solid.name));
  }
  if (world.domain.lower.x < world.domain.upper.x) {
    const Bounds b = bounds_of(s);
    if (!world.domain.contains(b.lower) || !world.domain.contains(b.upper))
      fail(fmt::format("'{}' is not wholly inside the domain", s.name));
  }
  const Real particle = world.liquid.particle_mass / world.liquid.kind.density;
  if (volume_of(s) < particle)
    problems.push_back(scene_problem(
        scene, key + (s.form == SourceForm::box ? ".size" : ".volume"),
        fmt::format("{:.3g} uL is less than one particle ({:.3g} uL): lower liquid.particle_mass", volume_of(s) * 1e9,
                    particle * 1e9)));
}

}  // namespace

Bounds bounds_of_sheet(const Textile& textile) {
  const Vec3 half = half_extent(textile);
  Bounds b;
  for (int corner = 0; corner < 8; ++corner)
    b.include(textile.placement.to_world({(corner & 1 ? 1 : -1) * half.x, (corner & 2 ? 1 : -1) * half.y,
                                          (corner & 4 ? 1 : -1) * half.z}));
  return b;
}

Real distance_to_sheet(const Textile& textile, const Vec3& point) {
  return distance_to_box(textile.placement.to_sheet(point), half_extent(textile));
}

std::string key_of_source(const Scene& scene, std::size_t i) {
  const LiquidSpec& liquid = scene.liquid;
  if (i < liquid.drops.size()) return fmt::format("liquid.drops[{}]", i);
  i -= liquid.drops.size();
  if (i < liquid.boxes.size()) return fmt::format("liquid.boxes[{}]", i);
  i -= liquid.boxes.size();
  if (i < liquid.droppers.size()) return fmt::format("liquid.droppers[{}]", i);
  return fmt::format("liquid.pipes[{}]", i - liquid.droppers.size());
}

void check_placements(const Scene& scene, const World& world, const World* running, std::vector<Problem>& problems) {
  for (std::size_t i = 0; i < world.sources.size(); ++i) check_source(scene, world, running, i, problems);
  check_overlaps(scene, world.sources, problems);
}

}  // namespace imbibe
