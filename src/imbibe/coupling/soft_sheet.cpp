#include "imbibe/coupling/soft_sheet.h"

#include <algorithm>

#include "imbibe/core/parallel.h"
#include "imbibe/core/portable.h"
#include "imbibe/geometry/direction.h"

namespace imbibe {
namespace {

// A sheet that has kept its shape so long rests. Speeds are no measure: what the cloth's passes leave flickers by some mm/s
// from substep to substep (cells of shear beside tense threads) while no node goes anywhere.
constexpr Real calm_drift = 1e-4;  // m, root mean square over its mass
constexpr Real calm_time = 0.5;    // s
constexpr Real least_waking_share = 0.01;  // of its weight: a change of load that moves a resting sheet again
constexpr Real load_averaging_time = 0.05;  // s: some hundred steps of the liquid, whose pressure flickers by a few per cent

Vec3 xyz(const Float4& f) { return {f.x, f.y, f.z}; }

// d turned by a random angle up to `most` about a random axis square to it.
Vec3 turned(const Vec3& d, Real most, const RandomCounter& random) {
  const Real angle = most * uniform(random, 0), around = 2 * pi * uniform(random, 1);
  const Vec3 a = any_perpendicular(d), b = cross(d, a);
  return portable::cos(angle) * d + portable::sin(angle) * (portable::cos(around) * a + portable::sin(around) * b);
}

bool may_rest(const SoftSheet& soft) {
  const ClothParams& c = soft.cloth;
  if (c.air.density > 0 && squared_norm(c.air.wind) > 0) return false;
  for (const PinPath& path : soft.sheet.pin_paths)
    if (!path.keys.empty() && path.keys.back().time > soft.sheet.time) return false;
  for (const Pin& pin : soft.sheet.pins)
    if (std::isfinite(pin.until) && pin.until > soft.sheet.time) return false;
  return true;
}

// m, root mean square, from where it was when the calm began; infinite when none has.
Real drift(const SoftSheet& soft) {
  const Sheet& sheet = soft.sheet;
  if (soft.calm_place.size() != sheet.size()) return std::numeric_limits<Real>::infinity();
  Real sum = 0;
  for (std::size_t n = 0; n < sheet.size(); ++n) sum += sheet.mass(n) * squared_norm(sheet.position[n] - soft.calm_place[n]);
  return std::sqrt(sum / total_mass(sheet));
}

void judge_rest(SoftSheet& soft, Real dt) {
  soft.calm_s += dt;
  if (!may_rest(soft) || drift(soft) > calm_drift) soft.calm_s = 0, soft.calm_place = soft.sheet.position;
  if (soft.calm_s < calm_time) return;
  soft.at_rest = true;
  soft.mass_at_rest = total_mass(soft.sheet);
  soft.load_at_rest = soft.load;
  soft.support_impulse -= momentum(soft.sheet);  // what holds it from now on stops it
  std::fill(soft.sheet.velocity.begin(), soft.sheet.velocity.end(), Vec3{});
}

void wake(SoftSheet& soft) {
  soft.at_rest = false;
  soft.calm_s = 0;
}

void book_liquid_impulse(SoftSheet& soft, const Vec3& place, const Vec3& impulse) {
  soft.liquid_impulse += impulse;
  soft.given.force += impulse;
  soft.given.moment += cross(place, impulse);
}

// Half the diagonal of the sheet's box: the lever at which a force turns it.
Real half_extent(const Sheet& sheet) {
  Bounds box;
  for (const Vec3& x : sheet.position) box.include(x);
  return 0.5 * norm(box.size());
}

// The running mean of what the liquid gives, and whether it is another load than the one the sheet rests under.
void judge_load(SoftSheet& soft, const Vec3& gravity, Real dt) {
  const Real blend = std::min(1.0, dt / load_averaging_time);
  soft.load.force += blend * (soft.given.force / dt - soft.load.force);
  soft.load.moment += blend * (soft.given.moment / dt - soft.load.moment);
  soft.given = {};
  if (!soft.at_rest) return;
  // Without gravity: what would move it as far as a sheet at rest may drift.
  const Real least = total_mass(soft.sheet) * std::max(least_waking_share * norm(gravity), 2 * calm_drift / (calm_time * calm_time));
  if (norm(soft.load.force - soft.load_at_rest.force) > least ||
      norm(soft.load.moment - soft.load_at_rest.moment) > least * half_extent(soft.sheet))
    wake(soft);
}

// Whether `surface` is the sheet as it is, standing still.
bool shows_standing(const MovingMesh& surface, const Sheet& sheet) {
  return surface.mesh.vertices == sheet.position && surface.start == sheet.position;
}

}  // namespace

void find_held(const SoftSheet& soft, std::vector<std::uint8_t>& held) {
  held.assign(soft.sheet.size(), soft.moves() ? 0 : 1);
  for (const Pin& pin : soft.sheet.pins)
    if (pin.until > soft.sheet.time) held[pin.node] = 1;
}

Vec3 velocity_at(const Sheet& sheet, const SurfacePoint& at) {
  const auto& t = sheet.triangles[at.triangle];
  return at.weight[0] * sheet.velocity[t[0]] + at.weight[1] * sheet.velocity[t[1]] + at.weight[2] * sheet.velocity[t[2]];
}

Real inverse_mass_at(const Sheet& sheet, std::span<const std::uint8_t> held, const SurfacePoint& at) {
  Real sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Index node = sheet.triangles[at.triangle][k];
    if (!held[node]) sum += at.weight[k] * at.weight[k] / sheet.mass(node);
  }
  return sum;
}

void give_impulse(SoftSheet& soft, std::span<const std::uint8_t> held, Index node, const Vec3& impulse) {
  book_liquid_impulse(soft, soft.sheet.position[node], impulse);
  if (held[node]) soft.support_impulse -= impulse;
  else soft.sheet.velocity[node] += impulse / soft.sheet.mass(node);
}

void give_impulse(SoftSheet& soft, std::span<const std::uint8_t> held, const SurfacePoint& at, const Vec3& impulse) {
  const Sheet& sheet = soft.sheet;
  for (std::size_t k = 0; k < 3; ++k) give_impulse(soft, held, sheet.triangles[at.triangle][k], at.weight[k] * impulse);
}

void merge_into_node(SoftSheet& soft, std::span<const std::uint8_t> held, Index node, Real kg, const Vec3& velocity) {
  Sheet& sheet = soft.sheet;
  Vec3& v = sheet.velocity[node];
  if (held[node]) {
    soft.support_impulse -= kg * (velocity - v);
    return;
  }
  const Real mass = sheet.mass(node);
  v = (mass * v + kg * velocity) / (mass + kg);
}

Vec3 velocity_after_impact(const Vec3& velocity, const Vec3& v_surface, const Vec3& n, Real particle_mass,
                           Real surface_inverse_mass, const ImpactParams& params, const RandomCounter& random) {
  const Vec3 relative = velocity - v_surface;
  const Real approach = -dot(relative, n);
  if (approach <= 0) return velocity;
  const Real effective = 1 / (1 / particle_mass + surface_inverse_mass);
  Vec3 wanted;
  if (approach < params.rest_speed) {
    const Vec3 along = relative + approach * n;
    const Real speed = norm(along);
    wanted = speed > 0 ? along * (1 - std::min(1.0, params.friction * approach / speed)) : Vec3{};
  } else {
    const Vec3 reflected = relative + 2 * approach * n;
    Vec3 d = turned(normalized(reflected), params.scatter, random);
    if (dot(d, n) < 0) d -= 2 * dot(d, n) * n;
    wanted = params.restitution * norm(relative) * d;
  }
  return velocity + (effective / particle_mass) * (wanted - relative);
}

void find_sheet_hits(const MovingMesh& surface, std::span<const Float4> before, std::span<const Float4> now,
                     std::vector<SheetHit>& hits, std::vector<std::vector<SheetHit>>& tiles) {
  hits.clear();
  if (surface.empty()) return;
  const std::size_t count = now.size();
  tiles.resize((count + default_tile - 1) / default_tile);
  Bounds all = surface.swept.nodes[0].bounds;
  all.grow(1e-9);
  parallel_tiles(count, [&](std::size_t begin, std::size_t end) {
    std::vector<SheetHit>& found = tiles[begin / default_tile];
    found.clear();
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 p0 = xyz(before[i]), p1 = xyz(now[i]);
      Bounds way;
      way.include(p0), way.include(p1);
      if (!all.overlaps(way)) continue;
      if (const auto crossing = first_crossing(surface, p0, p1)) found.push_back({static_cast<Index>(i), *crossing});
    }
  });
  for (const auto& tile : tiles) hits.insert(hits.end(), tile.begin(), tile.end());
}

Vec3 place_over(const MovingMesh& surface, const MovingCrossing& crossing, Real gap) {
  const auto& v = surface.mesh.triangles[crossing.at.triangle];
  const auto& x = surface.mesh.vertices;
  const auto& w = crossing.at.weight;
  const Vec3 at = w[0] * x[v[0]] + w[1] * x[v[1]] + w[2] * x[v[2]];
  Vec3 n = normalized(cross(x[v[1]] - x[v[0]], x[v[2]] - x[v[0]]));
  // The side it came from, as the triangle's own normal at the time of the crossing tells.
  const auto& s = surface.start;
  const Real t = crossing.time_fraction;
  const auto then = [&](std::size_t k) { return s[v[k]] + t * (x[v[k]] - s[v[k]]); };
  if (dot(crossing.normal, cross(then(1) - then(0), then(2) - then(0))) < 0) n = -n;
  return at + gap * n;
}

std::size_t throw_back(SoftSheet& soft, SoftSheetScratch& scratch, Liquid& liquid, std::span<const Float4> before,
                       Real gap, const ImpactParams& impact, std::uint64_t seed, std::uint64_t step) {
  Particles& p = liquid.particles;
  find_sheet_hits(scratch.surface, before.first(p.size()), p.position, scratch.hits, scratch.hit_tiles);
  for (const SheetHit& hit : scratch.hits) {
    const Index i = hit.particle;
    const SurfacePoint& at = hit.crossing.at;
    const Vec3 v = xyz(p.velocity[i]);
    const Real inverse = inverse_mass_at(soft.sheet, scratch.held, at);
    store(p.velocity[i], velocity_after_impact(v, velocity_at(soft.sheet, at), hit.crossing.normal, liquid.particle_mass,
                                               inverse, impact, {seed, p.id[i], step}));
    give_impulse(soft, scratch.held, at, liquid.particle_mass * (v - xyz(p.velocity[i])));
    store(p.position[i], place_over(scratch.surface, hit.crossing, gap));
  }
  return scratch.hits.size();
}

bool threads_resist(const SoftSheet& soft) {
  return soft.moves() && soft.cloth.model == ClothModel::xpbd && soft.sheet.is_grid();
}

void ThreadResistance::set(const SoftSheet& soft, std::span<const Real> inverse_mass, ClothScratch& scratch) {
  soft_ = &soft, inverse_mass_ = inverse_mass, scratch_ = &scratch;
  begin({}, 0);
}

void ThreadResistance::begin(std::span<const Index> pushed, Real dt) {
  threads.begin(soft_->sheet, soft_->cloth, inverse_mass_, pushed, dt, *scratch_);
}

Wall sheet_as_wall(const SoftSheet& soft, SoftSheetScratch& scratch) {
  const Sheet& sheet = soft.sheet;
  find_held(soft, scratch.held);
  scratch.inverse_mass.resize(sheet.size());
  for (std::size_t n = 0; n < sheet.size(); ++n) scratch.inverse_mass[n] = scratch.held[n] ? 0 : 1 / sheet.mass(n);
  scratch.wall.surface = &scratch.surface;
  scratch.wall.velocity = scratch.wall_velocity;
  scratch.wall.inverse_mass = scratch.inverse_mass;
  scratch.resistance.set(soft, scratch.inverse_mass, scratch.cloth);
  scratch.wall.resistance = threads_resist(soft) ? &scratch.resistance : nullptr;
  scratch.wall.half_thickness = 0.5 * soft.cloth.hand.thickness;
  scratch.wall.impulse.assign(sheet.size(), Vec3{});
  scratch.wall.pressing = 0;
  Wall wall;
  wall.two_sided = true;
  wall.sheet = &scratch.wall;
  wall.material.contact_angle = soft.contact_angle;
  return wall;
}

void take_wall_impulse(SoftSheet& soft, SoftSheetScratch& scratch, const Vec3& gravity, Real dt) {
  const std::vector<Vec3>& impulse = scratch.wall.impulse;
  Vec3 sum{};
  for (std::size_t n = 0; n < impulse.size(); ++n) {
    if (impulse[n] == Vec3{}) continue;
    book_liquid_impulse(soft, soft.sheet.position[n], impulse[n]);
    sum += impulse[n];
  }
  if (!soft.moves()) soft.support_impulse -= sum;
  else if (sum != Vec3{})
    soft.support_impulse +=
        push_cloth(soft.sheet, soft.cloth, scratch.inverse_mass, impulse, dt, scratch.cloth, &scratch.resistance.threads)
            .pin_impulse;
  judge_load(soft, gravity, dt);
}

ClothStepReport advance_sheet(SoftSheet& soft, SoftSheetScratch& scratch, const Vec3& gravity,
                              std::span<const ClothSolid> solids, Real dt) {
  ClothStepReport report;
  Sheet& sheet = soft.sheet;
  if (!soft.moves()) {
    sheet.time += dt;
    soft.support_impulse -= (total_mass(sheet) * dt) * gravity;
    if (shows_standing(scratch.surface, sheet) && scratch.wall_velocity.size() == sheet.size()) return report;
    set_step(scratch.surface, sheet.position, sheet.position, sheet.triangles);
    scratch.wall_velocity.assign(sheet.size(), Vec3{});
    return report;
  }
  if (scratch.surface.empty()) set_step(scratch.surface, sheet.position, sheet.position, sheet.triangles);
  scratch.before = sheet.position;
  report = step_cloth(sheet, soft.cloth, {.gravity = gravity, .solids = solids, .measure = false}, dt, scratch.cloth);
  soft.support_impulse += report.pin_impulse + report.solid_impulse;
  scratch.wall_velocity.resize(sheet.size());
  for (std::size_t n = 0; n < sheet.size(); ++n) scratch.wall_velocity[n] = (sheet.position[n] - scratch.before[n]) / dt;
  return report;
}

void finish_sheet(SoftSheet& soft, SoftSheetScratch& scratch, Real dt) {
  if (soft.moves()) judge_rest(soft, dt);
  if (!shows_standing(scratch.surface, soft.sheet))
    set_step(scratch.surface, scratch.before, soft.sheet.position, soft.sheet.triangles);
  find_held(soft, scratch.held);
}

void wake_if_heavier(SoftSheet& soft, Real share) {
  if (!soft.at_rest) return;
  const Real mass = total_mass(soft.sheet);
  if (std::abs(mass - soft.mass_at_rest) > share * soft.mass_at_rest) wake(soft);
}

}  // namespace imbibe
