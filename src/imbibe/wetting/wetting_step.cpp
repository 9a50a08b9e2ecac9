#include "imbibe/wetting/wetting_step.h"

#include <algorithm>

#include "imbibe/core/error.h"
#include "imbibe/wetting/fibre_exchange.h"
#include "imbibe/wetting/swelling.h"
#include "imbibe/wetting/transport.h"

namespace imbibe {
namespace {

constexpr Real first_step = 1e-4;     // s
constexpr Real longest_step = 300;    // s
constexpr int easy_newton = 5;        // iterations of a step that may grow
constexpr Real growth = 1.3;
constexpr Real quiet_growth = 2;      // hardly anything moves
constexpr Real quiet_change = 0.05;   // of saturation
constexpr Real shrink = 0.3;
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
void release_surplus(const WettingModel& m, Contents& contents, std::vector<ReleasedLiquid>& released) {
  if (!m.params.swelling) return;
  for (std::size_t node = m.segments; node < m.nodes(); ++node) {
    Real& held = contents.liquid_kg[node];
    if (held <= m.liquid.density * m.volume[node] * least_pore) continue;
    const Real most = m.liquid.density * current_volume(m, contents, node) * (1 + m.overfill[node]);
    if (held <= most) continue;
    released.push_back({static_cast<Index>(node), held - most});
    held = most;
  }
}

Real next_step(Real dt, const Substep& substep) {
  const bool easy = substep.transport.newton_iterations <= easy_newton;
  if (!easy) return substep.transport.newton_iterations > 2 * easy_newton ? 0.7 * dt : dt;
  return dt * (substep.transport.largest_change < quiet_change ? quiet_growth : growth);
}

}  // namespace

WettingReport step_wetting(const WettingModel& model, Contents& contents, std::span<const FaceSupply> supplies,
                           std::span<Real> taken_kg, const Air& air, const Vec3& gravity, Real dt) {
  IMBIBE_ASSERT(taken_kg.size() == supplies.size());
  WettingReport report;
  std::fill(taken_kg.begin(), taken_kg.end(), 0);
  report.suggested_step = dt;
  if (!(dt > 0)) return report;
  std::vector<Real> available(supplies.size());
  TransportWorkspace work;
  Contents saved;
  Real step = dt;
  int rejected_in_a_row = 0;
  while (report.advanced_s < dt) {
    const Real left = dt - report.advanced_s;
    // The last piece takes all that is left, so the pieces add up to dt and no sliver remains.
    const bool last = step >= left * (1 - 1e-9);
    const Real now = last ? left : step;
    for (std::size_t i = 0; i < supplies.size(); ++i) available[i] = supplies[i].available_kg - taken_kg[i];
    saved = contents;
    const std::size_t released_before = report.released.size();
    const TransportInput input{.model = &model, .supplies = supplies, .available_kg = available, .gravity = gravity,
                               .dt = now};
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
    step = next_step(now, substep);
    // A sliver at the end of dt says nothing about the step that would be right.
    if (!last || report.substeps == 1) report.suggested_step = step;
    report.advanced_s = last ? dt : report.advanced_s + now;
  }
  release_surplus(model, contents, report.released);
  report.suggested_step = std::clamp(report.suggested_step, 1e-9, longest_step);
  return report;
}

Real suggested_wetting_step(const WettingModel& model, const Contents& contents, const Air& air, const Vec3& gravity) {
  TransportWorkspace work;
  const TransportInput input{.model = &model, .supplies = {}, .available_kg = {}, .gravity = gravity, .dt = first_step};
  (void)air;
  const Real rate = largest_saturation_rate(input, contents, work);
  return std::clamp(rate > 0 ? 0.3 / rate : longest_step, first_step, longest_step);
}

}  // namespace imbibe
