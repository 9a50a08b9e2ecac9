#include "imbibe/sim/step.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <numeric>

#include "imbibe/core/error.h"
#include "imbibe/core/parallel.h"
#include "imbibe/coupling/absorption.h"
#include "imbibe/coupling/film.h"
#include "imbibe/coupling/hem_drops.h"
#include "imbibe/coupling/release.h"
#include "imbibe/coupling/wet_wall.h"
#include "imbibe/sim/cloth_stage.h"
#include "imbibe/sim/measures.h"
#include "imbibe/sim/rest.h"
#include "imbibe/sim/solid_at.h"

namespace imbibe {
namespace {

// The network follows moving liquid this often: uptake is slow against it (about 6 uL/s for cotton), so 2 ms moves less
// than a particle. It cuts its own steps where it must (pores fill in some 0.3 ms at first).
constexpr Real interval_with_moving_liquid = 2e-3;           // s
constexpr Real longest_interval_with_resting_liquid = 5e-2;  // s
constexpr Real interval_with_moving_cloth = 2e-2;            // s, while no liquid moves: heights change by millimetres
constexpr Real due_slack = 1e-9;                             // s, a drop this near is due: times are rounded sums
constexpr Real force_averaging_time = 2e-3;                  // s, about ten SPH steps and more

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

Real next_drop(const World& world) {
  Real next = std::numeric_limits<Real>::infinity();
  for (const Source& source : world.sources) next = std::min(next, next_emission(source));
  return next;
}

void emit_sources(World& world, StepReport& report) {
  for (Source& source : world.sources) {
    // Only what is due now: later drops of the step have their own.
    const EmitReport emitted = emit(source, world.liquid, world.time, world.time + due_slack);
    world.ledger.supplied_kg += emitted.kg;
    report.emitted += emitted.particles;
  }
  if (report.emitted > 0) world.pace.resting = false, world.pace.calm_since = -1;
}

void show_saturations(const Textile& textile, const Air& air, std::vector<float>& shown) {
  const std::vector<Real> saturations = node_saturations(textile, air);
  shown.assign(saturations.begin(), saturations.end());
}

void build_walls(const World& world, StepScratch& scratch) {
  scratch.walls.clear();
  for (const SolidBody& solid : world.solids) {
    Wall wall;
    wall.shape = &solid.shape;
    wall.material = solid.material;
    scratch.walls.push_back(std::move(wall));
  }
  scratch.sheets.clear();
  for (const Textile& textile : world.textiles)  // of soft ones not used
    scratch.sheets.push_back(sheet_shape(textile.fabric->network, textile.placement));
  if (scratch.saturation.size() != world.textiles.size()) scratch.saturation.assign(world.textiles.size(), {});
  for (std::size_t t = 0; t < world.textiles.size(); ++t) {
    const Textile& textile = world.textiles[t];
    std::vector<float>& s = scratch.saturation[t];
    if (s.size() != textile.fabric->network.nodes()) {  // new scratch; kept current by exchange()
      s.resize(textile.fabric->network.nodes());
      show_saturations(textile, world.air, s);
    }
    if (textile.cloth) {
      SoftSheetScratch& own = sheet_of(world, t, scratch);
      Wall wall = sheet_as_wall(textile.cloth->soft, own);
      own.wall.half_thickness = 0.5 * textile.fabric->network.thickness;
      wall.angles_at = wet_angles(place_of(world, t, scratch), *textile.faces, s);
      scratch.walls.push_back(std::move(wall));
      continue;
    }
    scratch.walls.push_back(wet_wall(scratch.sheets[t], textile.placement, *textile.faces, s));
  }
}

// What the liquid gives fixed sheets is booked (soft ones take it themselves); the part by pressure is averaged for the
// uptake law (the pull of a contact line lifts the sheet but does not hold liquid off its pores).
void book_impulses(World& world, const LiquidStepReport& liquid, StepScratch& scratch) {
  const Real blend = std::min(1.0, liquid.step_s / force_averaging_time);
  for (std::size_t t = 0; t < world.textiles.size(); ++t) {
    Textile& textile = world.textiles[t];
    const std::size_t wall = world.solids.size() + t;
    if (!textile.cloth) textile.exchange.impulse += liquid.wall_impulse[wall];
    const Real force = textile.cloth ? sheet_of(world, t, scratch).wall.pressing / liquid.step_s
                                     : -dot(liquid.wall_pressure_impulse[wall], textile.placement.n) / liquid.step_s;
    textile.exchange.normal_force += blend * (force - textile.exchange.normal_force);
  }
}

// The first particle whose numbers are none, or "".
std::string lost_particle(const Particles& p) {
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Float4 &x = p.position[i], &u = p.velocity[i];
    const float square = u.x * u.x + u.y * u.y + u.z * u.z;
    if (std::isfinite(x.x + x.y + x.z) && std::isfinite(square)) continue;
    return fmt::format("particle {} at ({:.6g}, {:.6g}, {:.6g}) m with velocity ({:.6g}, {:.6g}, {:.6g}) m/s", p.id[i],
                       x.x, x.y, x.z, u.x, u.y, u.z);
  }
  return "";
}

// "segment 12 of warp yarn 3", "pore 7"; with its place in the sheet.
std::string node_text(const YarnNetwork& network, std::size_t node) {
  const bool pore = node >= network.segment_yarn.size();
  const std::size_t index = pore ? node - network.segment_yarn.size() : node;
  const Vec3& at = pore ? network.pore_centre[index] : network.segment_centre[index];
  const std::string place = fmt::format("({:.4g}, {:.4g}) mm in the sheet", at.x * 1e3, at.y * 1e3);
  if (pore) return fmt::format("pore {} at {}", index, place);
  const Index yarn = network.segment_yarn[index];
  return fmt::format("segment {} of {} yarn {} at {}", index - network.yarn_first_segment[yarn],
                     network.yarn_family[yarn] == Family::warp ? "warp" : "weft", yarn, place);
}

void move_liquid(World& world, Real max_step, StepScratch& scratch, StepReport& report) {
  const auto start = Clock::now();
  build_walls(world, scratch);
  add_sheet_walls(world, scratch);
  LiquidStepReport liquid;
  try {
    liquid = step_liquid(world.liquid, world.liquid_params, scratch.walls, world.gravity, max_step, scratch.liquid);
  } catch (const NumericalError& error) {  // the liquid knows neither the world's time nor its step
    const std::string lost = lost_particle(world.liquid.particles);
    throw NumericalError(world.time, world.step, error.stage, error.where + (lost.empty() ? "" : ": " + lost));
  }
  book_impulses(world, liquid, scratch);
  report.liquid_moved = true;
  report.step_s = liquid.step_s;
  report.step_bound = liquid.bound;
  report.density_error = liquid.density_error;
  report.peak_density_error = liquid.peak_density_error;
  DensityRecord& density = world.density;
  ++density.steps;
  density.sum_of_means += liquid.density_error;
  density.worst_mean = std::max(density.worst_mean, liquid.density_error);
  density.sum_of_compressions += liquid.compression;
  density.worst_mean_compression = std::max(density.worst_mean_compression, liquid.compression);
  density.worst_particle = std::max(density.worst_particle, liquid.peak_density_error);
  report.surface_force = liquid.surface_force;
  report.pressure_iterations = liquid.pressure_iterations;
  report.divergence_iterations = liquid.divergence_iterations;
  report.converged = liquid.converged;
  report.liquid_wall_s = seconds_since(start);
}

// A bounce off a yarn of a soft sheet, whose nodes are as light as a particle may be.
void bounce_off_moving_yarn(Textile& textile, const ClothPlace& place, const ParticleHit& hit, const SoftSheetScratch& own,
                            Real mass, Float4& velocity) {
  SoftSheet& soft = textile.cloth->soft;
  const SurfacePoint at = place.surface_point(hit.sheet_point);
  const Vec3 before(velocity.x, velocity.y, velocity.z), sheet_v = velocity_at(soft.sheet, at);
  const Bounce held = hit.hit.resting ? rest(before - sheet_v, mass)
                                      : bounce(before - sheet_v, hit.hit.normal, mass, textile.contact.restitution,
                                               textile.contact.friction);
  const Real inverse = inverse_mass_at(soft.sheet, own.held, at);
  const Vec3 after = before - held.impulse_on_textile / (mass * (1 + mass * inverse));
  store(velocity, after);
  give_impulse(soft, own.held, at, mass * (before - Vec3(velocity.x, velocity.y, velocity.z)));
  ++textile.exchange.bounces;
}

// Swept contact (seed A 5.1): a particle whose predicted path of the next step enters a yarn bounces now, so nothing
// tunnels at any speed. The slab wall of the sheet holds slow liquid off already; this is for what is too fast for it.
void bounce_off_yarns(World& world, StepScratch& scratch, StepReport& report) {
  Particles& p = world.liquid.particles;
  for (std::size_t t = 0; t < world.textiles.size(); ++t) {
    Textile& textile = world.textiles[t];
    const ClothPlace place = place_of(world, t, scratch);
    find_hits(*textile.yarn_boxes, textile.fabric->network, place, p.position, p.velocity, report.step_s, 0,
              textile.contact, scratch.hits, scratch.contact, &report.contact);
    for (const ParticleHit& hit : scratch.hits) {
      Float4& v = p.velocity[hit.particle];
      const Vec3 before(v.x, v.y, v.z);
      if (textile.cloth) {
        bounce_off_moving_yarn(textile, place, hit, sheet_of(world, t, scratch), world.liquid.particle_mass, v);
        continue;
      }
      const Bounce after =
          hit.hit.resting ? rest(before, world.liquid.particle_mass)
                          : bounce(before, hit.hit.normal, world.liquid.particle_mass, textile.contact.restitution,
                                   textile.contact.friction);
      store(v, after.velocity);
      textile.exchange.impulse += world.liquid.particle_mass * (before - Vec3(v.x, v.y, v.z));  // as stored
      ++textile.exchange.bounces;
    }
    report.hits += scratch.hits.size();
    textile.exchange.contacts += scratch.hits.size();
  }
}

Real owed(const Liquid& liquid) {
  return std::accumulate(liquid.particles.owed_kg.begin(), liquid.particles.owed_kg.end(), Real{0});
}

// Particles that the network has taken whole join its sheet with their momentum, where they were.
void join_cloth(const Liquid& liquid, const Footprint& footprint, std::span<const std::uint8_t> dead,
                const ClothPlace& place, const SoftSheetScratch& own, SoftSheet& soft) {
  for (const Index i : footprint.particle) {
    if (!dead[i]) continue;
    const Float4 &x = liquid.particles.position[i], &v = liquid.particles.velocity[i];
    join_sheet(soft, own.held, place.surface_point(place.to_sheet({x.x, x.y, x.z})), liquid.particle_mass, {v.x, v.y, v.z});
  }
}

// The newest particles came out of the sheet.
MassLeft leave_cloth(const Liquid& liquid, const ReleaseReport& released, const ClothPlace& place,
                     const SoftSheetScratch& own, SoftSheet& soft) {
  MassLeft left;
  const std::size_t first = liquid.particles.size() - released.particles;
  for (std::size_t i = 0; i < released.particles; ++i) {
    const Float4& v = liquid.particles.velocity[first + i];
    const Vec3& centre = released.places[i];
    leave_sheet(soft, own.held, place.surface_point(centre), liquid.particle_mass, {v.x, v.y, v.z}, left);
  }
  return left;
}

Real hem_neck_of(const World& world) {
  const LiquidKind& kind = world.liquid.kind;
  return hem_neck(kind.surface_tension, kind.density, norm(world.gravity));
}

// Liquid that has run down to a hem (scratch.hem) joins the drop that hangs there.
std::size_t stop_at_hem(World& world, std::size_t index, StepScratch& scratch) {
  if (world.liquid.particles.size() == 0) return 0;
  Textile& textile = world.textiles[index];
  const YarnNetwork& network = textile.fabric->network;
  const ClothPlace place = place_of(world, index, scratch);
  const Real neck = hem_neck_of(world);
  scratch.dead.assign(world.liquid.particles.size(), 0);
  const CaughtAtHem caught =
      catch_at_hem(network, place, scratch.hem, world.gravity, neck, textile.cloth->soft, sheet_of(world, index, scratch).held,
                   textile.exchange, world.liquid, scratch.dead);
  // A particle may owe to two cloths that it touches: this one is given no more than it lent (its weight, not the books).
  textile.cloth->borrowed_kg = std::max(0.0, textile.cloth->borrowed_kg - caught.owed_kg);
  if (caught.particles > 0) remove_particles(world.liquid.particles, scratch.dead);
  return caught.particles;
}

// What a soft cloth gives off: drops at its hem, and elsewhere particles on the faces as from a flat one.
ReleaseReport release_from_cloth(World& world, std::size_t index, std::span<const ReleasedLiquid> released,
                                 const SolidAt& taken, StepScratch& scratch) {
  Textile& textile = world.textiles[index];
  const YarnNetwork& network = textile.fabric->network;
  const ClothPlace place = place_of(world, index, scratch);
  const Real neck = hem_neck_of(world);
  const Hem& hem = scratch.hem;
  std::vector<Real>& waiting = textile.exchange.waiting_kg;
  std::vector<Real>& hem_kg = scratch.hem_kg;
  hem_kg.assign(waiting.size(), 0);
  for (const Index k : hem.nodes) std::swap(hem_kg[k], waiting[k]);
  std::vector<ReleasedLiquid>& elsewhere = scratch.released_elsewhere;
  elsewhere.clear();
  for (const ReleasedLiquid& r : released) {
    if (hem.holds[r.node]) hem_kg[r.node] += r.kg;
    else elsewhere.push_back(r);
  }
  ReleaseReport report = release_particles(network, place, *textile.faces, elsewhere, world.gravity, taken,
                                           textile.exchange, world.liquid);
  for (const Index k : hem.nodes) waiting[k] += hem_kg[k];
  const ReleaseReport drops =
      release_hem_drops(network, place, hem, world.gravity, neck, taken, textile.exchange, world.liquid);
  report.particles += drops.particles, report.kg += drops.kg, report.momentum += drops.momentum;
  report.places.insert(report.places.end(), drops.places.begin(), drops.places.end());
  return report;
}

// The network's step, fed by the footprint and by reservoirs; scratch.taken_kg: what the footprint's supplies gave.
WettingReport advance_network(World& world, std::size_t index, Real dt, StepScratch& scratch) {
  Textile& textile = world.textiles[index];
  const YarnNetwork& network = textile.fabric->network;
  const std::size_t of_footprint = scratch.footprint.supplies.size();
  // Taken from `world.time`, the beginning of the interval or (moving liquid) a time within it: step() lands on the
  // times at which reservoirs change.
  scratch.supplies = scratch.footprint.supplies;
  append_supplies(textile.reservoirs, world.time, scratch.supplies);
  scratch.taken_kg.assign(scratch.supplies.size(), 0);
  const Vec3 gravity{dot(world.gravity, textile.placement.u), dot(world.gravity, textile.placement.v),
                     dot(world.gravity, textile.placement.n)};
  GravityField bent;
  if (textile.cloth) {
    update(scratch.embeddings[index], *textile.cloth->embedding, textile.cloth->soft.sheet, network, world.gravity);
    bent = scratch.embeddings[index].gravity();
  }
  TextileScratch& own = scratch.textiles[index];
  if (own.model != textile.model) own = {textile.model, {}, {}};
  WettingReport wetting = step_wetting(*textile.model, textile.contents, scratch.supplies, scratch.taken_kg, world.air,
                                       gravity, dt, own.wetting, textile.cloth ? &bent : nullptr);
  if (!wetting.converged)
    throw NumericalError(world.time, world.step, "wetting",
                         fmt::format("textile {}: the network came {:.3g} s of {:.3g} s far; its hardest node is {}",
                                     textile.name, wetting.advanced_s, dt, node_text(network, wetting.hardest_node)));
  world.ledger.evaporated_kg += wetting.evaporated_kg;
  world.ledger.supplied_kg += book_supplied(textile.reservoirs, world.time, scratch.taken_kg, of_footprint);
  scratch.taken_kg.resize(of_footprint);
  return wetting;
}

// The saturations that the next step's walls show; one that is not finite ends the run.
void show_on_walls(const World& world, std::size_t index, StepScratch& scratch) {
  if (index >= scratch.saturation.size()) return;
  const Textile& textile = world.textiles[index];
  std::vector<float>& shown = scratch.saturation[index];
  show_saturations(textile, world.air, shown);
  const auto lost = std::find_if(shown.begin(), shown.end(), [](float s) { return !std::isfinite(s); });
  if (lost == shown.end()) return;
  const auto node = static_cast<std::size_t>(lost - shown.begin());
  throw NumericalError(world.time, world.step, "wetting",
                       fmt::format("textile {}: {} has no finite saturation", textile.name,
                                   node_text(textile.fabric->network, node)));
}

// Textile step of dt: supply by the liquid on the faces, the network, then whole particles die or are born.
void exchange(World& world, std::size_t index, Real dt, StepScratch& scratch, StepReport& report, Real& next_interval) {
  Textile& textile = world.textiles[index];
  const YarnNetwork& network = textile.fabric->network;
  const ClothPlace place = place_of(world, index, scratch);
  if (textile.cloth) {
    find_hem(network, place, world.gravity, hem_neck_of(world), scratch.hem);
    report.absorbed += stop_at_hem(world, index, scratch);
  }
  Footprint& footprint = scratch.footprint;
  find_footprint(world.liquid, network, place, *textile.faces, world.gravity, textile.exchange, footprint);
  spread_films(world.liquid, *textile.faces, *textile.model, textile.contents, textile.exchange, footprint);
  const WettingReport wetting = advance_network(world, index, dt, scratch);
  report.wetting_iterations += wetting.newton_iterations;
  next_interval = std::min(next_interval, wetting.suggested_step);

  const Real owed_before = owed(world.liquid);
  book_taken(footprint, scratch.taken_kg, world.liquid.particles, textile.exchange);
  scratch.dead.assign(world.liquid.particles.size(), 0);
  report.absorbed += absorb_particles(world.liquid, footprint, textile.exchange, scratch.dead).particles;
  if (textile.cloth) {
    textile.cloth->borrowed_kg += owed(world.liquid) - owed_before;
    join_cloth(world.liquid, footprint, scratch.dead, place, sheet_of(world, index, scratch), textile.cloth->soft);
  }
  remove_particles(world.liquid.particles, scratch.dead);
  const SolidAt taken = [&](const Vec3& at) { return solid_at(world, index, at); };
  const ReleaseReport released =
      textile.cloth ? release_from_cloth(world, index, wetting.released, taken, scratch)
                    : release_particles(network, place, *textile.faces, wetting.released, world.gravity, taken,
                                        textile.exchange, world.liquid);
  report.released += released.particles;
  if (released.particles > 0) world.pace.resting = false;
  if (textile.cloth) {
    const SoftSheetScratch& sheet = sheet_of(world, index, scratch);
    const MassLeft left = leave_cloth(world.liquid, released, place, sheet, textile.cloth->soft);
    weigh(*textile.cloth, sheet.held, network, *textile.model, textile.contents, textile.exchange, left,
          scratch.textiles[index].weigh);
  }
  show_on_walls(world, index, scratch);
}

void exchange_all(World& world, Real dt, StepScratch& scratch, StepReport& report) {
  const auto start = Clock::now();
  scratch.textiles.resize(world.textiles.size());
  Real next = std::numeric_limits<Real>::infinity();
  for (std::size_t t = 0; t < world.textiles.size(); ++t) exchange(world, t, dt, scratch, report, next);
  world.pace.since_wetting = 0;
  if (!report.liquid_moved) world.pace.wetting_interval = next;
  report.wetting_ran = true;
  report.wetting_wall_s += seconds_since(start);
}

// Particles outside the domain have left; the ledger keeps their mass.
void leave(World& world, StepScratch& scratch, StepReport& report) {
  if (world.domain.empty()) return;
  const std::size_t n = world.liquid.particles.size();
  scratch.dead.assign(n, 0);
  bool any = false;
  for (std::size_t i = 0; i < n; ++i) {
    const Float4& x = world.liquid.particles.position[i];
    if (world.domain.contains({x.x, x.y, x.z})) continue;
    if (!std::isfinite(x.x + x.y + x.z))  // lost, not left
      throw NumericalError(world.time, world.step, "leave", lost_particle(world.liquid.particles));
    scratch.dead[i] = 1, any = true;
    world.ledger.left_kg += world.liquid.particle_mass - world.liquid.particles.owed_kg[i];
  }
  if (!any) return;
  report.left = remove_particles(world.liquid.particles, scratch.dead);
}

// The step of the textiles that the liquid above allows.
Real textile_interval(const World& world, bool moving) {
  if (moving) return interval_with_moving_liquid;
  const Real longest = world.liquid.particles.size() > 0 ? longest_interval_with_resting_liquid
                                                         : std::numeric_limits<Real>::infinity();
  return std::clamp(world.pace.wetting_interval, interval_with_moving_liquid, longest);
}

// s, the liquid's own step, of which a soft sheet takes its own as well. The sheet moves first, as if there were no liquid; what it
// does too much the liquid undoes against the threads. So beside threads liquid moves half as far in a step as elsewhere: with the
// whole way liquid on a hammock had a density error of 9.8 % in its worst step, with half of it 1.5 % (decision 7).
Real step_beside_sheets(const World& world) {
  const Real own = liquid_step_bound(world.liquid, world.liquid_params, world.gravity).step_s;
  if (!any_threads_resist(world)) return own;
  LiquidParams of_motion = world.liquid_params;
  of_motion.surface_tension = false;
  return std::min(own, 0.5 * liquid_step_bound(world.liquid, of_motion, world.gravity).step_s);
}

}  // namespace

void emit_due(World& world) {
  StepReport report;
  if (next_drop(world) < world.time + due_slack) emit_sources(world, report);
}

StepReport step(World& world, const StepOptions& options, StepScratch& scratch) {
  StepReport report;
  Pace& pace = world.pace;
  const Real remaining = options.until - world.time;
  IMBIBE_ASSERT(remaining > 0);
  if (any_soft_sheet(world)) ready_cloths(world, scratch);
  const Real longest = std::min(remaining, options.max_step);
  if (next_drop(world) < world.time + due_slack) emit_sources(world, report);
  // A drop is born at its own time: no step passes over it. One that waits for its place tries again at every step.
  const Real drop_in = next_drop(world) - world.time;
  Real allowed = drop_in >= due_slack ? std::min(longest, drop_in) : longest;
  for (const Textile& textile : world.textiles)
    allowed = std::min(allowed, next_change(textile.reservoirs, world.time) - world.time);

  const bool moving = world.liquid.particles.size() > 0 && !pace.resting;
  if (moving) {
    Real max_step = allowed;
    const Real interval = textile_interval(world, true);
    if (!world.textiles.empty()) max_step = std::min(max_step, std::max(interval - pace.since_wetting, 1e-6));
    max_step = std::min(max_step, longest_cloth_step(world));
    Real beside_sheets = std::numeric_limits<Real>::infinity();
    if (any_soft_sheet(world)) {  // cloth and liquid make the same step
      beside_sheets = step_beside_sheets(world);
      max_step = std::min(max_step, beside_sheets);
      if (max_step > 0) advance_cloths(world, max_step, scratch, report);
    }
    move_liquid(world, max_step, scratch, report);
    if (report.step_bound == std::string_view("given") && max_step == beside_sheets) report.step_bound = "cloth";
    meet_cloths(world, report.step_s, scratch, report);
    bounce_off_yarns(world, scratch, report);
    pace.since_wetting += report.step_s;
    if (!world.textiles.empty() && pace.since_wetting >= interval * (1 - 1e-9))
      exchange_all(world, pace.since_wetting, scratch, report);
    leave(world, scratch, report);
    if (options.rest_allowed && !any_cloth_moves(world)) judge_rest(world, scratch.liquid.fields);
  } else {
    const bool cloth_moves = any_network_cloth_moves(world);
    if (pace.since_wetting > 0 && !world.textiles.empty() && !cloth_moves)
      exchange_all(world, pace.since_wetting, scratch, report);
    const Real waiting = cloth_moves ? pace.since_wetting : 0;
    report.step_s = world.textiles.empty() ? allowed : std::min(allowed, textile_interval(world, false));
    report.step_bound = report.step_s < allowed ? "wetting" : allowed < longest ? "drop" : "until";
    if (longest_cloth_step(world) < report.step_s) report.step_s = longest_cloth_step(world), report.step_bound = "cloth";
    advance_cloths(world, report.step_s, scratch, report);
    meet_cloths(world, report.step_s, scratch, report);
    pace.since_wetting = report.step_s + waiting;
    if (!world.textiles.empty() && (!any_network_cloth_moves(world) || pace.since_wetting >= interval_with_moving_cloth))
      exchange_all(world, pace.since_wetting, scratch, report);
    if (pace.resting) wake_when_changed(world);
  }
  if (!(report.step_s >= options.min_step) && report.step_s < remaining * (1 - 1e-12))
    throw NumericalError(world.time, world.step, "step",
                         fmt::format("the step fell to {:.3g} s by the bound '{}'", report.step_s, report.step_bound));
  // Landing on `until` exactly keeps output times free of summed rounding.
  world.time = report.step_s >= remaining * (1 - 1e-12) ? options.until : world.time + report.step_s;
  ++world.step;
  return report;
}

}  // namespace imbibe
