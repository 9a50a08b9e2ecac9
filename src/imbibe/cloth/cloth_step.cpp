#include "imbibe/cloth/cloth_step.h"

#include <fmt/format.h>

#include <algorithm>

#include "imbibe/cloth/air.h"
#include "imbibe/cloth/cloth_work.h"
#include "imbibe/cloth/solid_contact.h"
#include "imbibe/cloth/thread_answer.h"
#include "imbibe/core/error.h"
#include "imbibe/core/parallel.h"

namespace imbibe {

ClothScratch::ClothScratch() : work_(std::make_unique<Work>()) {}
ClothScratch::~ClothScratch() = default;
ClothScratch::ClothScratch(ClothScratch&&) noexcept = default;
ClothScratch& ClothScratch::operator=(ClothScratch&&) noexcept = default;

void ClothScratch::Work::build(const Sheet& sheet) {
  topology = make_topology(sheet);
  topology_key = sheet.topology_key;
  built = true;
  first_triangle.assign(sheet.size() + 1, 0);
  for (const auto& t : sheet.triangles) {
    for (const Index i : t) ++first_triangle[i + 1];
  }
  for (std::size_t i = 0; i < sheet.size(); ++i) first_triangle[i + 1] += first_triangle[i];
  node_triangles.resize(first_triangle.back());
  std::vector<std::size_t> next(first_triangle.begin(), first_triangle.end() - 1);
  for (std::size_t k = 0; k < sheet.triangles.size(); ++k) {
    for (const Index i : sheet.triangles[k]) node_triangles[next[i]++] = static_cast<Index>(k);
  }
  node_area = node_areas(sheet);
  self.owners = make_owners(sheet);
}

void ClothScratch::Work::prepare(const Sheet& sheet, const ClothParams& params) {
  if (!built || topology_key != sheet.topology_key) build(sheet);
  const std::size_t n = sheet.size();
  held.resize(n), normal.resize(n), inverse_mass.resize(n);
  for (std::size_t i = 0; i < n; ++i) inverse_mass[i] = 1 / sheet.mass(i);
  for (const Pin& pin : sheet.pins) {
    if (sheet.time < pin.until) inverse_mass[pin.node] = 0;
  }
  update_materials(sheet, topology, params, elastic);
}

void ClothScratch::Work::update_normals(const Sheet& sheet) {
  parallel_for(sheet.size(), [&](std::size_t i) {
    Vec3 sum;
    for (std::size_t k = first_triangle[i]; k < first_triangle[i + 1]; ++k) {
      const auto& t = sheet.triangles[node_triangles[k]];
      sum += cross(sheet.position[t[1]] - sheet.position[t[0]], sheet.position[t[2]] - sheet.position[t[0]]);
    }
    normal[i] = normalized(sum);
  });
}

namespace {

constexpr std::size_t node_tile = 1024;
constexpr int contact_passes = 4;
constexpr Real most_effort = 6;  // of a substep, in passes over the whole sheet; the closing one comes on top
constexpr int slow_passes = 5;
// Of the strain error. What is left is energy, k times its square, and seen where liquid lies on stiff threads; springs are soft,
// and passes beyond their fifth give them energy.
constexpr Real converged_threads = 0.005, converged_springs = 0.1;

struct Step {
  Sheet& sheet;
  const ClothParams& params;
  const ClothLoads& loads;
  ClothScratch& scratch;
  ClothScratch::Work& work;
  ClothStepReport& report;
  Real elapsed = 0;  // s since the start of the step

  NodeMotion nodes() const {
    return {sheet.position.data(), sheet.velocity.data(), work.inverse_mass.data(), work.held.data()};
  }
  Vec3 load(std::size_t i) const { return loads.force.empty() ? Vec3{} : loads.force[i]; }
};

// Weight, loads and air on the free nodes.
void apply_loads(Step& s, Real h) {
  const bool air = s.params.air.density > 0;
  struct Given {
    Vec3 load{}, weight{}, air{};
    Given& operator+=(const Given& o) { return load += o.load, weight += o.weight, air += o.air, *this; }
  };
  const Given given = parallel_sum(s.sheet.size(), [&](std::size_t begin, std::size_t end) {
    Given sum;
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 load = h * s.load(i), weight = (h * s.sheet.mass(i)) * s.loads.gravity;
      sum.load += load, sum.weight += weight;
      const Real w = s.work.inverse_mass[i];
      if (w == 0) continue;
      Vec3& v = s.sheet.velocity[i];
      v += h * s.loads.gravity + w * load;
      if (!air) continue;
      const Vec3 drag = air_impulse(s.params.air, v, s.work.normal[i], s.work.node_area[i], w, h);
      v += w * drag;
      sum.air += drag;
    }
    return sum;
  }, node_tile);
  s.report.load_impulse += given.load;
  s.report.weight_impulse += given.weight;
  s.report.air_impulse += given.air;
}

// Pinned nodes go where their pins will be at the end of the substep. What the pin gave is what the change of the node's
// momentum takes beyond weight, load and what the cloth gave; the first part is booked here, the cloth's in end_pins.
void move_pins(Step& s, Real h) {
  for (std::size_t k = 0; k < s.sheet.pins.size(); ++k) {
    const Pin& pin = s.sheet.pins[k];
    if (s.work.inverse_mass[pin.node] > 0) continue;
    const Vec3 place = pin.path == no_index
                           ? pin.anchor
                           : pin.anchor + displacement_at(s.sheet.pin_paths[pin.path], s.sheet.time + s.elapsed + h);
    const Vec3 velocity = (place - s.sheet.position[pin.node]) / h;
    const Real mass = s.sheet.mass(pin.node);
    s.scratch.pin_impulse[k] += mass * (velocity - s.sheet.velocity[pin.node]) - (h * mass) * s.loads.gravity -
                                h * s.load(pin.node);
    s.sheet.velocity[pin.node] = velocity;
    s.work.held[pin.node] = {};
  }
}

void end_pins(Step& s) {
  for (std::size_t k = 0; k < s.sheet.pins.size(); ++k) {
    const Index node = s.sheet.pins[k].node;
    if (s.work.inverse_mass[node] == 0) s.scratch.pin_impulse[k] -= s.work.held[node];
  }
}

void touch_solids(Step& s, Real h, Real pull_part) {
  s.report.solid_contacts = 0;
  const std::size_t solids = s.loads.solids.size();
  for (std::size_t k = 0; k < solids; ++k) {
    const ClothSolid& solid = s.loads.solids[k];
    const Vec3 moved = s.elapsed * solid.velocity;
    const Real reach = 0.5 * s.params.hand.thickness + rise_between_nodes(solid.shape, s.work.topology.shortest_edge);
    struct Given {
      Vec3 impulse{};
      std::size_t contacts = 0;
      Given& operator+=(const Given& o) { return impulse += o.impulse, contacts += o.contacts, *this; }
    };
    const Given given = parallel_sum(s.sheet.size(), [&](std::size_t begin, std::size_t end) {
      Given sum;
      for (std::size_t i = begin; i < end; ++i) {
        const Real w = s.work.inverse_mass[i];
        Real& clearance = s.work.clearance[i * solids + k];
        Vec3& v = s.sheet.velocity[i];
        if (w == 0 || clearance > h * norm(v - solid.velocity)) continue;
        const SolidTouch touch = touch_solid(solid, moved,
                                             {.position = s.sheet.position[i], .velocity = v, .inverse_mass = w,
                                              .half_thickness = reach,
                                              .pull = pull_part * s.sheet.cling[i] * s.work.node_area[i]}, h);
        clearance = touch.clearance;
        if (!touch.touches) continue;
        v += w * touch.impulse;
        sum.impulse += touch.impulse;
        ++sum.contacts;
      }
      return sum;
    }, node_tile);
    s.scratch.solid_impulse[k] += given.impulse;
    s.report.solid_contacts += given.contacts;
  }
}

SelfContactRules self_rules(const Step& s) {
  return {.thickness = s.params.hand.thickness, .friction = s.params.contact.friction, .cling = s.sheet.cling.data(),
          .area = s.work.node_area.data()};
}

void find_contacts(Step& s, Real h) {
  SelfContact& self = s.work.self;
  self.hits.clear();
  s.report.self_contacts = 0;
  if (!s.params.contact.self) return;
  reserve_near_pairs(s.sheet, s.nodes(), s.params.hand.thickness, h, self);
  find_near_pairs(self_rules(s), s.nodes(), h, self);
  s.report.self_contacts = self.touching;
}

void prevent_self_crossings(Step& s, Real h) {
  if (!s.params.contact.self) return;
  SelfContact& self = s.work.self;
  reserve_near_pairs(s.sheet, s.nodes(), s.params.hand.thickness, h, self);
  const SweptReport swept = prevent_crossings(s.sheet, s.nodes(), h, self);
  s.report.swept_hits += swept.hits;
  s.report.rigid_zones += swept.zones;
  s.report.unresolved_crossings += swept.unresolved;
  note_motion(s.sheet, s.nodes(), h, self);
}

struct SubstepErrors {
  Real strain = 0;
  Real turn = 0;
};

// Cloth, its layers and the solids push on each other in turn until a pass changes the strain by little: threads stay as
// long as they are where contacts stop them, and a pile rests on what is below it. After the first passes only the pieces are
// solved that the pass before still changed, and all of them once more at the end.
SubstepErrors solve_together(Step& s, Real h) {
  const bool contacts = !s.work.self.hits.empty() || !s.loads.solids.empty();
  const bool springs = s.params.model == ClothModel::provot;
  const int least = contacts ? contact_passes : 1;
  const Real settled = (springs ? converged_springs : converged_threads) * s.params.strain_error;
  SubstepErrors errors;
  begin_in_plane(s.work.topology, s.params, s.work.elastic);
  Real effort = 0;
  bool everywhere = true, closing = false;
  for (int pass = 1; ; ++pass) {
    const InPlaneOutcome outcome =
        solve_in_plane(s.work.topology, s.params, s.nodes(), h, {everywhere, settled}, s.work.elastic);
    effort += outcome.part;
    errors.turn = std::max(errors.turn, outcome.threads.turn);
    // Relaxation closes a gap ever more slowly: what is left is some times the last change.
    errors.strain = std::max(outcome.threads.change(), std::min(pass, slow_passes) * outcome.relaxed.change());
    if (pass <= contact_passes || closing) {
      constexpr Real pull_part = 1.0 / (contact_passes + 1);  // the closing one too
      repel_near_pairs(self_rules(s), s.nodes(), h, pull_part, s.work.self);
      touch_solids(s, h, pull_part);
    }
    const bool converged = errors.strain < settled && !outcome.threads.tightened;
    const bool last = outcome.part == 0 || (springs ? pass >= slow_passes - 1 : effort >= most_effort);
    const bool solved_all = everywhere || outcome.part == 1;
    if (solved_all && pass >= least && (converged || last || closing)) break;
    closing = !solved_all && (converged || last);
    everywhere = pass < least || closing;
  }
  return errors;
}

void move_nodes(Step& s, Real h) {
  const std::size_t solids = s.loads.solids.size();
  parallel_for(s.sheet.size(), [&](std::size_t i) {
    const Vec3 v = s.sheet.velocity[i];
    s.sheet.position[i] += h * v;
    for (std::size_t k = 0; k < solids; ++k) {
      s.work.clearance[i * solids + k] -= h * norm(v - s.loads.solids[k].velocity);
    }
  }, node_tile);
}

SubstepErrors advance_substep(Step& s, Real h) {
  apply_loads(s, h);
  move_pins(s, h);
  find_contacts(s, h);
  solve_bending(s.work.topology, s.params, s.nodes(), h, s.work.elastic);
  const SubstepErrors errors = solve_together(s, h);
  prevent_self_crossings(s, h);
  end_pins(s);
  move_nodes(s, h);
  return errors;
}

// A fifth of the longest substep at which the transverse waves of a sheet hanging by its own weight are resolved: it finds
// its own length in a few substeps, whatever the sheet is doing at the start.
Real first_substep(const Step& s) {
  const Real edge = s.work.topology.shortest_edge, length = edge * std::sqrt(static_cast<Real>(s.sheet.size()));
  const Real g = std::max(norm(s.loads.gravity), Real{1});
  return std::clamp(0.05 * edge / std::sqrt(g * length), s.params.shortest_substep, s.params.longest_substep);
}

// Errors and turn go as the square of the substep.
Real next_substep(const ClothParams& params, Real last, Real taken, const SubstepErrors& errors) {
  constexpr Real greatest_turn = 0.25;  // an eighth of the bound in threads.h, which holds for straight threads
  // Half of the error that is allowed: near the whole of it passes stop before they converge, which jolts cloth at rest.
  const Real target = params.model == ClothModel::provot ? params.strain_error : 0.5 * params.strain_error;
  const Real part = std::max(errors.strain / target, errors.turn / greatest_turn);
  const Real allowed = part > 0 ? 0.9 * taken / std::sqrt(part) : 2 * last;
  return std::clamp(std::clamp(allowed, 0.25 * last, 1.25 * last), params.shortest_substep, params.longest_substep);
}

void require_finite(const Step& s) {
  const std::size_t wrong = parallel_sum(s.sheet.size(), [&](std::size_t begin, std::size_t end) {
    std::size_t count = 0;
    for (std::size_t i = begin; i < end; ++i) count += is_finite(s.sheet.position[i]) ? 0 : 1;
    return count;
  }, node_tile);
  if (wrong == 0) return;
  std::size_t first = 0;
  while (is_finite(s.sheet.position[first])) ++first;
  throw NumericalError(s.sheet.time, 0, "cloth", fmt::format("node {} of the sheet is not finite", first));
}

void measure(Step& s) {
  s.report.greatest_strain = greatest_strain(s.sheet, s.work.topology, s.params);
  s.report.elastic_energy = stored_energy(s.sheet, s.work.topology, s.work.elastic, s.params);
  s.report.kinetic_energy = kinetic_energy(s.sheet);
  for (std::size_t i = 0; i < s.sheet.size(); ++i) {
    s.report.potential_energy -= s.sheet.mass(i) * dot(s.loads.gravity, s.sheet.position[i]);
  }
}

}  // namespace

ClothStepReport step_cloth(Sheet& sheet, const ClothParams& params, const ClothLoads& loads, Real dt,
                           ClothScratch& scratch) {
  ClothStepReport report;
  scratch.pin_impulse.assign(sheet.pins.size(), Vec3{});
  scratch.solid_impulse.assign(loads.solids.size(), Vec3{});
  if (sheet.fixed) {
    sheet.time += dt;
    return report;
  }
  IMBIBE_ASSERT(loads.force.empty() || loads.force.size() == sheet.size());
  ClothScratch::Work& work = scratch.work();
  Step s{sheet, params, loads, scratch, work, report};
  work.prepare(sheet, params);
  if (params.air.density > 0) work.update_normals(sheet);
  work.clearance.assign(sheet.size() * loads.solids.size(), 0);
  if (work.self.position != sheet.position) work.self.room.clear();
  if (sheet.substep == 0) sheet.substep = first_substep(s);
  report.substep = dt;
  while (s.elapsed < dt) {
    const Real left = dt - s.elapsed, count = std::max(Real{1}, std::ceil(left / sheet.substep));
    const Real h = left / count;
    const SubstepErrors errors = advance_substep(s, h);
    s.elapsed = count == 1 ? dt : s.elapsed + h;
    ++report.substeps;
    report.substep = std::min(report.substep, h);
    report.strain_error = std::max(report.strain_error, errors.strain);
    sheet.substep = next_substep(params, sheet.substep, h, errors);
  }
  sheet.time += dt;
  for (const Vec3& impulse : scratch.pin_impulse) report.pin_impulse += impulse;
  for (const Vec3& impulse : scratch.solid_impulse) report.solid_impulse += impulse;
  require_finite(s);
  if (params.contact.self) work.self.position = sheet.position;
  if (loads.measure) measure(s);
  return report;
}

PushReport push_cloth(Sheet& sheet, const ClothParams& params, std::span<const Real> inverse_mass,
                      std::span<const Vec3> impulse, Real dt, ClothScratch& scratch, ThreadAnswer* threads) {
  IMBIBE_ASSERT(impulse.size() == sheet.size() && inverse_mass.size() == sheet.size());
  PushReport report;
  ClothScratch::Work& work = scratch.work();
  if (!work.built || work.topology_key != sheet.topology_key) work.build(sheet);
  work.push.resize(sheet.size());
  work.held.assign(sheet.size(), Vec3{});
  for (std::size_t i = 0; i < sheet.size(); ++i) {
    work.push[i] = inverse_mass[i] * impulse[i];
    if (inverse_mass[i] == 0) report.pin_impulse -= impulse[i];
  }
  if (threads != nullptr) threads->resist(work.push, work.held);
  const NodeMotion nodes{sheet.position.data(), work.push.data(), inverse_mass.data(), work.held.data()};
  SelfContact& self = work.self;
  if (params.contact.self) {
    if (self.position != sheet.position) self.room.clear();
    reserve_near_pairs(sheet, nodes, params.hand.thickness, dt, self);
    const SweptReport swept = prevent_crossings(sheet, nodes, dt, self);
    report.swept_hits = swept.hits;
    report.unresolved_crossings = swept.unresolved;
    note_motion(sheet, nodes, dt, self);
  }
  for (std::size_t i = 0; i < sheet.size(); ++i) {
    report.pin_impulse -= work.held[i];
    if (inverse_mass[i] == 0) continue;
    sheet.velocity[i] += work.push[i];
    sheet.position[i] += dt * work.push[i];
  }
  if (params.contact.self) self.position = sheet.position;
  return report;
}

Real elastic_energy(const Sheet& sheet, const ClothParams& params, ClothScratch& scratch) {
  scratch.work().prepare(sheet, params);
  return stored_energy(sheet, scratch.work().topology, scratch.work().elastic, params);
}

}  // namespace imbibe
