#include "imbibe/wetting/transport.h"

#include <algorithm>
#include <limits>

#include "imbibe/core/error.h"
#include "imbibe/core/parallel.h"
#include "imbibe/wetting/solved_set.h"
#include "imbibe/wetting/transport_laws.h"

namespace imbibe {
namespace {

constexpr int most_newton = 25;
constexpr int undamped_newton = 12;       // iterations in Y before the damped ones in s
constexpr Real straight_change = 1e-3;    // of a saturation, relative: up to here Y is a straight line
constexpr int most_linear = 400;
constexpr Real infinity = std::numeric_limits<Real>::infinity();

using Work = TransportWorkspace;

// ---- Newton --------------------------------------------------------------------------------------------------------

void evaluate_all(const TransportInput& input, Work& w) {
  evaluate_nodes(*input.model, w);
  evaluate_links(*input.model, w);
  evaluate_supplies(input, w);
}

// Residuals in units of saturation; returns the largest.
Real assemble(const TransportInput& input, Work& w, bool with_matrix) {
  const std::size_t n = w.active.size();
  const Real dt = input.dt;
  GraphMatrix& matrix = w.matrix;
  parallel_for(n, [&](std::size_t i) {
    auto [flow, slope] = release_law(*input.model, w, i);
    const Real scale = dt / w.volume[i];
    for (Index k = matrix.row_start[i]; k < matrix.row_start[i + 1]; ++k) {
      const auto& link = w.links[w.row_link[k]];
      const bool first = w.active[i] < w.active[matrix.column[k]];
      flow += first ? link.flow : -link.flow;
      slope += first ? link.slope_a : -link.slope_b;
      if (with_matrix) matrix.value[k] = first ? link.slope_b : -link.slope_a;
    }
    w.residual[i] = w.saturation[i] - w.old_saturation[i] + scale * flow;
    if (with_matrix) matrix.diagonal[i] = 1 + scale * slope, matrix.scale[i] = scale;
  }, transport_tile);
  for (const auto& supply : w.supplies) {
    const Real scale = dt / w.volume[supply.node];
    w.residual[supply.node] -= scale * supply.flow;
    if (with_matrix) matrix.diagonal[supply.node] -= scale * supply.slope;
  }
  return parallel_max(n, Real(0), [&](std::size_t begin, std::size_t end) {
    Real largest = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const Real size = std::abs(w.residual[i]);
      if (!(size <= largest)) largest = size < infinity ? size : infinity;  // so that one that is no number is seen
    }
    return largest;
  }, transport_tile);
}

// Newton's unknown of a node is the left side of its own equation, its neighbours held,
//   Y(s) = s + (dt/V) C u(s),   C = sum of its links' conductances, u its potential:
// the saturation where storage rules, the potential where flow rules (a full yarn's p(s) is 260 times steeper than a
// nearly full one's). In Y each equation is close to a straight line on both sides of s = 1, so the iteration needs
// neither a limit nor a landing there. Any growing Y leads to the same solution; a rough u costs iterations only.
Sloped own_side(const WettingModel& m, const Work& w, std::size_t i) {
  const Real s = w.saturation[i];
  Sloped u;
  if (m.params.model == TransportModel::kunzel && w.active[i] < m.segments) {
    u = kunzel_potential(s);
  } else {
    const NodeKind& kind = m.kinds[w.kind[i]];
    const Real index = kind.pore() ? m.params.yarn_size_index : kind.size_index;  // a pore's links are its yarns'
    u = YarnPotential{m.params.model, w.own_entry[i], index}(w.pressure[i]);
    u.slope *= w.pressure_slope[i];
  }
  return {s + w.own_share[i] * u.value, 1 + w.own_share[i] * u.slope};
}

// Moves a saturation by Newton's `change` of it, taken in Y; to at least a tenth of what it was, so it stays above 0.
void move_saturation(const WettingModel& m, Work& w, std::size_t i, Real change) {
  const Real s = w.saturation[i], straight = s + change;
  const bool same_side = (s < 1) == (straight < 1);
  if (std::abs(change) <= straight_change * s && same_side) return set_saturation(m, w, i, straight);
  const Sloped here = own_side(m, w, i);
  const Real wanted = here.value + here.slope * change;
  const Real tolerance = straight_change * std::abs(here.slope * change);
  // Upwards Y may bend down (a pore that fills): then more than the straight step is needed, up to the top of the range.
  const Real least = 0.1 * s, most = std::max<Real>(2, straight);
  Real low = change > 0 ? s : least, high = change > 0 ? most : s;
  Real next = std::clamp(straight, low, high);
  for (int k = 0;; ++k) {
    set_saturation(m, w, i, next);
    const Sloped y = own_side(m, w, i);
    const bool beyond = y.value > wanted;
    if (std::abs(y.value - wanted) <= tolerance || (beyond ? next <= least : next >= most)) return;
    (beyond ? high : low) = next;
    if (k == 40 || high - low <= 1e-12 * high) return;
    const Real better = next - (y.value - wanted) / y.slope;
    if (better > low && better < high) next = better;
    else next = beyond && low == least ? least : low > 0 ? std::sqrt(low * high) : 0.5 * (low + high);
  }
}

bool newton(const TransportInput& input, Work& w, TransportResult& result) {
  const WettingModel& m = *input.model;
  const Real wanted = m.params.residual;
  w.previous = w.saturation;
  Real last = 1e-3;
  for (int iteration = 0; iteration < most_newton; ++iteration) {
    evaluate_all(input, w);
    const Real largest = assemble(input, w, true);
    if (!std::isfinite(largest)) return false;
    if (largest <= wanted) return true;
    ++result.newton_iterations;
    // As exact as the iteration can use: its residuals fall to a hundredth or a tenth each time (decision 13).
    const Real forcing = std::clamp<Real>(0.1 * largest / last, 1e-3, 5e-3);
    last = largest;
    const LinearSolve solve = solve_bicgstab(w.matrix, w.residual, w.change, forcing, 0.5 * wanted,
                                             most_linear, w.linear);
    result.linear_iterations += solve.iterations;
    if (!std::isfinite(solve.residual)) return false;
    const bool damped = iteration >= undamped_newton || m.params.model == TransportModel::as_printed;
    parallel_for(w.active.size(), [&](std::size_t i) {
      const Real s = w.saturation[i];
      if (damped) set_saturation(m, w, i, damped_saturation(s, -w.change[i], w.previous[i]));
      else move_saturation(m, w, i, -w.change[i]);
      w.previous[i] = s;
    }, transport_tile);
  }
  return false;
}

// A residual that is no number is the farthest of all.
Index hardest_node(const Work& w) {
  std::size_t worst = 0;
  for (std::size_t i = 1; i < w.active.size() && std::isfinite(w.residual[worst]); ++i) {
    if (!(std::abs(w.residual[i]) <= std::abs(w.residual[worst]))) worst = i;
  }
  return w.active[worst];
}

// ---- masses --------------------------------------------------------------------------------------------------------

// Per node, m3/s that leaves through its faces. Newton's potentials are done with by now.
std::vector<Real>& releases(Work& w) { return w.potential; }

// m3/s that leaves local node i over entry k of its row.
Real flow_away(const Work& w, std::size_t i, Index k) {
  const Real flow = w.links[w.row_link[k]].flow;
  return w.active[i] < w.active[w.matrix.column[k]] ? flow : -flow;
}

// Cuts the outflows of nodes that the flows would leave below zero (by the tolerance of Newton's method). What is left in an
// emptied node is more than the rounding of the sums over its links, a dozen flows of 1e-16 each, so that no content is negative.
void limit_outflows(const TransportInput& input, const Contents& contents, Work& w) {
  constexpr Real all_but_rounding = 1 - 2e-15, emptied = 1 - 6e-15;  // a cut node is not cut again for rounding
  const Real dt = input.dt;
  std::vector<Real>& scale = w.previous;
  auto &supply_in = w.residual, &supply_out = w.change, &release = releases(w);
  parallel_for(w.active.size(), [&](std::size_t i) { release[i] = release_law(*input.model, w, i).value; }, transport_tile);
  for (int pass = 0; pass < 50; ++pass) {
    std::fill(supply_in.begin(), supply_in.end(), 0);
    std::fill(supply_out.begin(), supply_out.end(), 0);
    for (const auto& supply : w.supplies) {
      (supply.flow > 0 ? supply_in : supply_out)[supply.node] += std::abs(supply.flow);
    }
    const char cut = parallel_max(w.active.size(), char{0}, [&](std::size_t begin, std::size_t end) {
      char cut_here = 0;
      for (std::size_t i = begin; i < end; ++i) {
        Real in = supply_in[i], out = release[i] + supply_out[i];
        for (Index k = w.matrix.row_start[i]; k < w.matrix.row_start[i + 1]; ++k) {
          const Real away = flow_away(w, i, k);
          (away > 0 ? out : in) += std::abs(away);
        }
        scale[i] = 1;
        const Real held = contents.liquid_kg[w.active[i]] / input.model->liquid.density + dt * in;
        if (out > 0 && dt * out > all_but_rounding * held) scale[i] = std::max<Real>(0, emptied * held / (dt * out)), cut_here = 1;
      }
      return cut_here;
    }, transport_tile);
    if (!cut) return;
    parallel_for(w.active.size(), [&](std::size_t i) {
      for (Index k = w.matrix.row_start[i]; k < w.matrix.row_start[i + 1]; ++k) {
        const Index other = w.matrix.column[k];
        if (other > i) w.links[w.row_link[k]].flow *= scale[flow_away(w, i, k) > 0 ? i : other];
      }
      release[i] *= scale[i];
    }, transport_tile);
    for (auto& supply : w.supplies) {
      if (supply.flow < 0) supply.flow *= scale[supply.node];
    }
  }
}

void update_masses(const TransportInput& input, Contents& contents, Work& w, TransportResult& result,
                   std::vector<ReleasedLiquid>& released) {
  const WettingModel& m = *input.model;
  const Real mass = m.liquid.density * input.dt;
  parallel_for(w.active.size(), [&](std::size_t i) {
    Real flow = 0;
    for (Index k = w.matrix.row_start[i]; k < w.matrix.row_start[i + 1]; ++k) flow += flow_away(w, i, k);
    contents.liquid_kg[w.active[i]] -= mass * flow;
  }, transport_tile);
  w.supply_kg.assign(input.supplies.size(), 0);
  for (const auto& supply : w.supplies) {
    const Real taken = std::min(mass * supply.flow, std::max<Real>(0, input.available_kg[supply.supply]));
    contents.liquid_kg[w.active[supply.node]] += taken;
    w.supply_kg[supply.supply] = taken;
  }
  Real moved = 0, all = 0;
  for (std::size_t i = 0; i < w.active.size(); ++i) {
    const Index node = w.active[i];
    Real& held = contents.liquid_kg[node];
    const Real most = m.liquid.density * w.volume[i] * (1 + m.overfill(node));
    const Real release = releases(w)[i], surplus = std::max(mass * release, held - most);
    if (surplus > 0) {
      const Real kg = std::min(surplus, held);
      held -= kg;
      const Real excess = std::max<Real>(0, w.pressure[i] + w.face_head[i] - m.open(node));
      released.push_back({node, kg, excess, release});
    }
    const Real after = held / (m.liquid.density * w.volume[i]);
    result.largest_change = std::max(result.largest_change, std::abs(after - w.old_saturation[i]));
    moved += std::abs(after - w.old_saturation[i]) * w.volume[i];
    all += std::max(after, w.old_saturation[i]) * w.volume[i];
    if (contents.reached_saturation.empty()) continue;
    Real& reached = contents.reached_saturation[node];
    reached = after < 1e-4 ? 0 : std::max(reached, after);
  }
  result.moved_share = all > 0 ? moved / all : 0;
}

}  // namespace

TransportResult advance_transport(const TransportInput& input, Contents& contents, TransportWorkspace& work,
                                  std::vector<ReleasedLiquid>& released) {
  TransportResult result;
  work.saturation.clear();
  work.supply_kg.assign(input.supplies.size(), 0);
  choose_active(input, contents, work);
  if (work.active.empty()) {
    result.converged = true;
    return result;
  }
  do {
    gather(input, contents, work);
    if (!newton(input, work, result)) {
      result.hardest_node = hardest_node(work);
      return result;
    }
  } while (widen_active(*input.model, work));
  result.active_nodes = work.saturation.size();
  limit_outflows(input, contents, work);
  update_masses(input, contents, work, result, released);
  result.converged = true;
  return result;
}

Real largest_saturation_rate(const TransportInput& input, const Contents& contents, TransportWorkspace& work) {
  work.saturation.clear();
  choose_active(input, contents, work);
  if (work.active.empty()) return 0;
  gather(input, contents, work);
  evaluate_all(input, work);
  assemble(input, work, false);
  Real largest = 0;
  for (const Real value : work.residual) largest = std::max(largest, std::abs(value) / input.dt);
  return largest;
}

}  // namespace imbibe
