#include "imbibe/wetting/wetting_step.h"

#include <algorithm>

#include "imbibe/core/error.h"
#include "imbibe/wetting/evaporation.h"
#include "imbibe/wetting/fibre_exchange.h"
#include "imbibe/wetting/swelling.h"
#include "imbibe/wetting/transport.h"

namespace imbibe {
namespace {

constexpr Real first_step = 1e-4;     // s
constexpr int easy_newton = 8;        // iterations of a step that may grow
constexpr int hard_newton = 14;       // of one that should have been shorter
constexpr Real moved_in_step = 0.05;   // share of the liquid that should change its node in one step
constexpr Real growth = 3;            // the most from step to step
constexpr Real dried_in_step = 0.02;  // saturation that evaporation, taken before transport, may cost a node in one step
constexpr Real shrink = 0.3;
// Of one call. Uptake by an opened pore takes tens, the hardest of the tests' random states some 2e4; numbers far from any
// cloth's have needed steps that shrink for ever.
constexpr int most_attempts = 50000;
constexpr int most_rejections = 30;   // one after the other: 0.3^30 of the step

struct Substep {
  TransportResult transport;
  Real evaporated = 0;
};

// One pass of the stages over `dt` on `contents`; false leaves contents half-way, the caller restores them.
Substep attempt(const TransportInput& input, Contents& contents, const Air& air, TransportWorkspace& work,
                std::vector<ReleasedLiquid>& released) {
  const WettingModel& m = *input.model;
  Substep result;
  sorb_liquid(m, contents, 0.5 * input.dt);
  result.evaporated = exchange_vapour(m, contents, air, input.dt);
  result.transport = advance_transport(input, contents, work, released);
  if (result.transport.converged) sorb_liquid(m, contents, 0.5 * input.dt);
  return result;
}

// Fibres that swelled after the last transport may have left a full pore less room: the surplus comes out.
void release_surplus(const WettingModel& m, Contents& contents, Real dt, std::vector<ReleasedLiquid>& released) {
  if (!m.params.swelling) return;
  for (std::size_t node = m.segments; node < m.nodes(); ++node) {
    Real& held = contents.liquid_kg[node];
    if (held <= m.liquid.density * m.volume(node) * least_pore) continue;
    const Real most = m.liquid.density * current_volume(m, contents, node) * (1 + m.overfill(node));
    if (held <= most) continue;
    const Real excess = filling_pressure(m, node, held / most * (1 + m.overfill(node))).value - m.open(node);
    const Real surplus = held - most;
    released.push_back({static_cast<Index>(node), surplus, excess, surplus / (m.liquid.density * dt)});
    held = most;
  }
}

// The step follows what moves; Newton's method only says when it was too long.
Real next_step(Real dt, const Substep& substep) {
  const TransportResult& t = substep.transport;
  const Real wanted = t.moved_share > 0 ? std::clamp<Real>(moved_in_step / t.moved_share, 0.5, growth) : growth;
  if (t.newton_iterations > hard_newton) return 0.5 * dt;
  return dt * (t.newton_iterations > easy_newton ? std::min<Real>(1, wanted) : wanted);
}

// The longest step with liquid in the cloth. Evaporation is local and comes before transport: in longer steps a node
// would run dry and stop giving off vapour while its neighbours could still feed it.
Real longest_drying_step(const WettingModel& m, const Air& air) {
  if (!m.params.evaporation) return longest_wetting_step;
  const bool wet_bulb = m.params.surface_temperature == SurfaceTemperature::wet_bulb;
  const Real rate = evaporation_rate(air, 1, wet_bulb ? wet_bulb_temperature(air) : air.temperature);
  if (rate <= 0) return longest_wetting_step;
  const Real per_second = rate * m.greatest_vapour_area / m.liquid.density;
  return per_second > 0 ? std::min(longest_wetting_step, dried_in_step / per_second) : longest_wetting_step;
}

}  // namespace

struct WettingScratch::Parts {
  TransportWorkspace work;
  Contents saved;
  std::vector<Real> available;
};

WettingScratch::WettingScratch() : parts(std::make_unique<Parts>()) {}
WettingScratch::~WettingScratch() = default;
WettingScratch::WettingScratch(WettingScratch&&) noexcept = default;
WettingScratch& WettingScratch::operator=(WettingScratch&&) noexcept = default;

WettingReport step_wetting(const WettingModel& model, Contents& contents, std::span<const FaceSupply> supplies,
                           std::span<Real> taken_kg, const Air& air, const Vec3& gravity, Real dt,
                           const GravityField* field) {
  WettingScratch scratch;
  return step_wetting(model, contents, supplies, taken_kg, air, gravity, dt, scratch, field);
}

WettingReport step_wetting(const WettingModel& model, Contents& contents, std::span<const FaceSupply> supplies,
                           std::span<Real> taken_kg, const Air& air, const Vec3& gravity, Real dt,
                           WettingScratch& scratch, const GravityField* field) {
  IMBIBE_ASSERT(taken_kg.size() == supplies.size());
  WettingReport report;
  std::fill(taken_kg.begin(), taken_kg.end(), 0);
  report.suggested_step = dt;
  if (!(dt > 0)) return report;
  auto& [work, saved, available] = *scratch.parts;
  available.assign(supplies.size(), 0);
  const Real longest = longest_drying_step(model, air);
  Real step = dt;
  int rejected_in_a_row = 0;
  while (report.advanced_s < dt) {
    if (report.substeps + report.rejected >= most_attempts) {
      report.converged = false;
      break;
    }
    const Real left = dt - report.advanced_s;
    // The last piece takes all that is left, so the pieces add up to dt and no sliver remains.
    const bool last = step >= left * (1 - 1e-9);
    const Real now = last ? left : step;
    for (std::size_t i = 0; i < supplies.size(); ++i) available[i] = supplies[i].available_kg - taken_kg[i];
    saved = contents;
    const std::size_t released_before = report.released.size();
    const TransportInput input{.model = &model, .supplies = supplies, .available_kg = available, .gravity = gravity,
                               .field = field, .dt = now};
    const Substep substep = attempt(input, contents, air, work, report.released);
    report.newton_iterations += substep.transport.newton_iterations;
    report.linear_iterations += substep.transport.linear_iterations;
    report.active_nodes = std::max(report.active_nodes, substep.transport.active_nodes);
    if (!substep.transport.converged) {
      contents = saved;
      report.released.resize(released_before);
      step = shrink * now;
      report.suggested_step = step;
      ++report.rejected;
      report.hardest_node = substep.transport.hardest_node;
      if (++rejected_in_a_row <= most_rejections) continue;
      report.converged = false;
      break;
    }
    ++report.substeps;
    rejected_in_a_row = 0;
    report.evaporated_kg += substep.evaporated;
    report.largest_change = std::max(report.largest_change, substep.transport.largest_change);
    for (std::size_t i = 0; i < supplies.size(); ++i) {
      taken_kg[i] += work.supply_kg[i];
      report.taken_kg += work.supply_kg[i];
    }
    step = std::min(next_step(now, substep), substep.transport.active_nodes > 0 ? longest : longest_wetting_step);
    // A sliver at the end of dt says nothing about the step that would be right.
    if (!last || report.substeps == 1) report.suggested_step = step;
    report.advanced_s = last ? dt : report.advanced_s + now;
  }
  release_surplus(model, contents, dt, report.released);
  report.suggested_step = std::clamp(report.suggested_step, 1e-9, longest_wetting_step);
  return report;
}

Real suggested_wetting_step(const WettingModel& model, const Contents& contents, const Air& air, const Vec3& gravity) {
  TransportWorkspace work;
  const TransportInput input{.model = &model, .supplies = {}, .available_kg = {}, .gravity = gravity, .dt = first_step};
  const Real rate = largest_saturation_rate(input, contents, work);
  if (work.active.empty()) return longest_wetting_step;
  return std::clamp(rate > 0 ? 0.3 / rate : longest_wetting_step, first_step, longest_drying_step(model, air));
}

}  // namespace imbibe
