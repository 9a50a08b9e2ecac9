#include "imbibe/wetting/transport.h"

#include <algorithm>

#include "imbibe/core/error.h"
#include "imbibe/core/parallel.h"
#include "imbibe/wetting/capillary.h"
#include "imbibe/wetting/crossing.h"
#include "imbibe/wetting/entry.h"

namespace imbibe {
namespace {

constexpr Real wet_saturation = 1e-7;     // a node above it belongs to the solved set with its neighbours
constexpr Real residual_tolerance = 1e-9; // of saturation
constexpr int most_newton = 25;
constexpr int undamped_newton = 12;      // iterations in Y before the damped ones in s
constexpr Real straight_change = 1e-3;    // of a saturation, relative: up to here Y is a straight line
constexpr int most_linear = 400;
constexpr Real driest_wall = 1e-4;        // saturation whose corners wet the walls of a dry pore enough to begin
constexpr std::size_t loop_tile = 1024;

using Work = TransportWorkspace;

// The potential of a yarn's links at pressure p: Psi, or Kuenzel's Phi at the saturation the yarn would have.
struct YarnPotential {
  TransportModel model;
  Real entry, size_index;
  Sloped operator()(Real p) const {
    if (model == TransportModel::physical) return kirchhoff_potential(entry, size_index, p);
    if (p >= -entry) return {kunzel_potential(1).value, 0};
    const Real s = std::pow(entry / -p, size_index);
    const Sloped phi = kunzel_potential(s);
    return {phi.value, phi.slope * size_index * s / -p};
  }
};

// ---- the solved set ------------------------------------------------------------------------------------------------

void add_active(const WettingModel& m, Work& w, Index node) {
  if (w.local_of[node] != no_index || m.volume[node] <= 0) return;
  w.local_of[node] = 0;
  w.active.push_back(node);
}

void add_ring(const WettingModel& m, Work& w, std::size_t first, std::size_t last) {
  for (std::size_t i = first; i < last; ++i) {
    const Index node = w.active[i];
    for (Index k = m.row_start[node]; k < m.row_start[node + 1]; ++k) add_active(m, w, m.row_other[k]);
  }
}

void choose_active(const TransportInput& input, const Contents& contents, Work& w) {
  const WettingModel& m = *input.model;
  w.local_of.assign(m.nodes(), no_index);
  w.active.clear();
  for (std::size_t i = 0; i < m.nodes(); ++i) {
    if (m.volume[i] > 0 && contents.liquid_kg[i] > wet_saturation * m.liquid.density * m.volume[i]) {
      add_active(m, w, static_cast<Index>(i));
    }
  }
  for (std::size_t i = 0; i < input.supplies.size(); ++i) {
    if (input.supplies[i].wetted_share > 0) add_active(m, w, input.supplies[i].node);
  }
  const std::size_t seeds = w.active.size();
  add_ring(m, w, 0, seeds);
  const std::size_t ring = w.active.size();
  add_ring(m, w, seeds, ring);
}

// A node at the rim of the set got wet: one more pair of rings. False: the set was wide enough.
bool widen_active(const WettingModel& m, Work& w) {
  const std::size_t before = w.active.size();
  for (std::size_t i = 0; i < before; ++i) {
    if (w.saturation[i] <= wet_saturation) continue;
    const Index node = w.active[i];
    for (Index k = m.row_start[node]; k < m.row_start[node + 1]; ++k) add_active(m, w, m.row_other[k]);
  }
  if (w.active.size() == before) return false;
  for (int ring = 0; ring < 2; ++ring) add_ring(m, w, before, w.active.size());
  return true;
}

// Effective entry suction of the curve a node is on now: the filling branch's, or higher while it drains.
Real effective_entry(const WettingModel& m, const Work& w, Index local) {
  const Index node = w.active[local];
  const Real s = w.old_saturation[local];
  if (!m.params.hysteresis || s >= 1 || s <= driest) return m.entry[node];
  return -w.pressure[local] * std::pow(s, 1 / m.size_index[node]);
}

void evaluate_nodes(const WettingModel& m, Work& w);

// What the links of a node make of its potential (own_side).
void gather_own_sides(const TransportInput& input, Work& w) {
  const WettingModel& m = *input.model;
  parallel_for(w.active.size(), [&](std::size_t i) {
    Real conductance = 0, entry = 0;
    for (Index k = w.row_start[i]; k < w.row_start[i + 1]; ++k) {
      const auto& local = w.edges[w.row_edge[k]];
      if (local.kind == EdgeKind::pore_pore) continue;
      conductance += local.factor, entry += local.factor * local.entry;
    }
    const bool segment = w.active[i] < m.segments && !m.params.hysteresis;
    w.own_share[i] = input.dt / w.volume[i] * conductance;
    w.own_entry[i] = segment || conductance <= 0 ? m.entry[w.active[i]] : entry / conductance;
  }, loop_tile);
}

void order_active(const WettingModel& m, Work& w) {
  w.active.clear();
  for (const Index node : m.by_place) {
    if (w.local_of[node] == no_index) continue;
    w.local_of[node] = static_cast<Index>(w.active.size());
    w.active.push_back(node);
  }
}

// The set's edges and each node's entries in them. An edge belongs to the first of its nodes.
void build_rows(const WettingModel& m, Work& w) {
  if (w.rows_of == &m && w.rows_for == w.active) return;
  const std::size_t n = w.active.size();
  const auto each_link = [&](std::size_t i, auto&& call) {
    const Index node = w.active[i];
    for (Index k = m.row_start[node]; k < m.row_start[node + 1]; ++k) {
      const Index other = w.local_of[m.row_other[k]];
      if (other != no_index) call(m.row_edge[k], other);
    }
  };
  std::vector<Index>& edge_start = w.rows_for;  // until the end
  w.row_start.assign(n + 1, 0);
  edge_start.assign(n + 1, 0);
  parallel_for(n, [&](std::size_t i) {
    each_link(i, [&](Index, Index other) { ++w.row_start[i + 1], edge_start[i + 1] += other > i; });
  }, loop_tile);
  for (std::size_t i = 0; i < n; ++i) w.row_start[i + 1] += w.row_start[i], edge_start[i + 1] += edge_start[i];
  w.edges.resize(edge_start[n]);
  w.row_edge.resize(w.row_start[n]);
  w.row_other.resize(w.row_start[n]);
  w.edge_place.resize(m.edges.size());
  parallel_for(n, [&](std::size_t i) {
    Index next = edge_start[i];
    each_link(i, [&](Index e, Index other) {
      if (other < i) return;
      const WettingEdge& edge = m.edges[e];
      w.edges[next] = {.edge = e, .a = w.local_of[edge.a], .b = w.local_of[edge.b], .kind = edge.kind};
      w.edge_place[e] = next++;
    });
  }, loop_tile);
  parallel_for(n, [&](std::size_t i) {
    Index next = w.row_start[i];
    each_link(i, [&](Index e, Index other) { w.row_edge[next] = w.edge_place[e], w.row_other[next++] = other; });
  }, loop_tile);
  w.matrix.row_start = w.row_start;
  w.matrix.column = w.row_other;
  w.matrix.value.resize(w.row_other.size());
  w.matrix.diagonal.resize(n);
  ++w.matrix.pattern;
  w.rows_of = &m;
  w.rows_for = w.active;
}

// Puts the set in order, gathers its state and its edges. `guess`: saturations to start from, by node (empty: the old ones).
void gather(const TransportInput& input, const Contents& contents, Work& w) {
  const WettingModel& m = *input.model;
  w.guess.clear();
  if (!w.saturation.empty()) {
    w.guess.assign(m.nodes(), -1);
    for (std::size_t i = 0; i < w.saturation.size(); ++i) w.guess[w.active[i]] = w.saturation[i];
  }
  order_active(m, w);
  build_rows(m, w);
  const std::size_t n = w.active.size();
  for (auto* vector : {&w.volume, &w.old_content, &w.old_saturation, &w.saturation, &w.pressure, &w.pressure_slope,
                       &w.potential, &w.potential_slope, &w.release, &w.release_slope, &w.residual, &w.change,
                       &w.reached, &w.scale, &w.own_share, &w.own_entry}) {
    vector->assign(n, 0);
  }
  parallel_for(n, [&](std::size_t i) {
    const Index node = w.active[i];
    w.volume[i] = current_volume(m, contents, node);
    w.old_content[i] = contents.liquid_kg[node] / m.liquid.density;
    w.old_saturation[i] = w.old_content[i] / w.volume[i];
    w.saturation[i] = w.old_saturation[i];
    w.reached[i] = contents.reached_saturation.empty() ? 0 : contents.reached_saturation[node];
  }, loop_tile);
  evaluate_nodes(m, w);
  const bool kunzel = m.params.model == TransportModel::kunzel;
  const Real redistribution = kunzel && input.supplies.empty() ? m.params.redistribution_factor : 1;
  const Vec3 weight = m.liquid.density * input.gravity;
  parallel_for(w.edges.size(), [&](std::size_t e) {
    auto& local = w.edges[e];
    const WettingEdge& edge = m.edges[local.edge];
    local.factor = edge.conductance;
    local.head = dot(weight, edge.offset);
    if (edge.kind == EdgeKind::pore_pore || m.params.model == TransportModel::as_printed) return;
    const bool upper_is_a = w.pressure[local.a] >= w.pressure[local.b];
    const Index upstream = edge.kind == EdgeKind::segment_pore || upper_is_a ? local.a : local.b;
    local.entry = effective_entry(m, w, upstream);
    local.factor *= redistribution;
    if (edge.kind == EdgeKind::segment_pore) {
      local.factor *= std::sqrt(std::clamp<Real>(w.old_saturation[local.b], driest_wall, 1));
    }
  }, loop_tile);
  gather_own_sides(input, w);
  w.supplies.clear();
  for (std::size_t i = 0; i < input.supplies.size(); ++i) {
    const Index local = w.local_of[input.supplies[i].node];
    if (local != no_index && input.supplies[i].wetted_share > 0) w.supplies.push_back({.supply = i, .node = local});
  }
  if (!w.guess.empty()) {
    for (std::size_t i = 0; i < n; ++i) {
      if (w.guess[w.active[i]] >= 0) w.saturation[i] = w.guess[w.active[i]];
    }
  }
}

// ---- laws ----------------------------------------------------------------------------------------------------------

void evaluate_nodes(const WettingModel& m, Work& w) {
  const TransportModel law = m.params.model;
  parallel_for(w.active.size(), [&](std::size_t i) {
    const Index node = w.active[i];
    const Real s = w.saturation[i];
    if (law == TransportModel::as_printed) {
      const Sloped phi = node < m.segments ? printed_potential(s) : Sloped{s, 1};
      w.potential[i] = phi.value, w.potential_slope[i] = phi.slope;
      return;
    }
    const Sloped p = m.params.hysteresis ? hysteretic_pressure(m, node, s, w.reached[i]) : filling_pressure(m, node, s);
    w.pressure[i] = p.value, w.pressure_slope[i] = p.slope;
    if (node < m.segments) {
      if (law == TransportModel::kunzel) {
        const Sloped phi = kunzel_potential(s);
        w.potential[i] = phi.value, w.potential_slope[i] = phi.slope;
      } else {
        const Sloped psi = kirchhoff_potential(m.entry[node], m.size_index[node], p.value);
        w.potential[i] = psi.value, w.potential_slope[i] = psi.slope * p.slope;
      }
    }
    const Sloped open = valve(p.value, m.open[node]);
    w.release[i] = m.release_conductance[node] * open.value;
    w.release_slope[i] = m.release_conductance[node] * open.slope * p.slope;
  }, loop_tile);
}

void printed_edge(const Work& w, Work::LocalEdge& local) {
  const Index a = local.a, b = local.b;
  Sloped at_b{w.potential[b], w.potential_slope[b]};
  if (local.kind == EdgeKind::segment_pore) at_b = printed_potential(w.saturation[b]);
  local.flow = local.factor * (w.potential[a] - at_b.value);
  local.slope_a = local.factor * w.potential_slope[a];
  local.slope_b = -local.factor * at_b.slope;
}

void yarn_edge(const WettingModel& m, const Work& w, Work::LocalEdge& local) {
  const Index a = local.a, b = local.b;
  const Real head = local.head;
  const TransportModel law = m.params.model;
  if (local.kind == EdgeKind::crossing && !m.edges[local.edge].same_material) {
    const WettingEdge& edge = m.edges[local.edge];
    const Index na = w.active[a], nb = w.active[b];
    const Real share = local.factor / edge.conductance;
    const CrossingFlow x = crossing_flow(YarnPotential{law, m.entry[na], m.size_index[na]},
                                         YarnPotential{law, m.entry[nb], m.size_index[nb]}, local.factor,
                                         share * edge.conductance_b, w.pressure[a], w.pressure[b]);
    local.flow = x.flow;
    local.slope_a = x.slope_a * w.pressure_slope[a];
    local.slope_b = x.slope_b * w.pressure_slope[b];
    return;
  }
  // Both pressures are carried to the middle of the link, so that a hanging column comes to rest exactly. Kuenzel's
  // diffusivity knows no gravity.
  if (law == TransportModel::physical && (m.params.hysteresis || head != 0)) {
    const Real index = m.size_index[w.active[a]];
    const Sloped at_a = kirchhoff_potential(local.entry, index, w.pressure[a] + 0.5 * head);
    const Sloped at_b = kirchhoff_potential(local.entry, index, w.pressure[b] - 0.5 * head);
    local.flow = local.factor * (at_a.value - at_b.value);
    local.slope_a = local.factor * at_a.slope * w.pressure_slope[a];
    local.slope_b = -local.factor * at_b.slope * w.pressure_slope[b];
  } else {
    local.flow = local.factor * (w.potential[a] - w.potential[b]);
    local.slope_a = local.factor * w.potential_slope[a];
    local.slope_b = -local.factor * w.potential_slope[b];
  }
}

// a is the segment. The pore's pressure is carried to the segment's height.
void segment_pore_edge(const WettingModel& m, const Work& w, Work::LocalEdge& local) {
  const Index a = local.a, b = local.b, node = w.active[a];
  const YarnPotential psi{m.params.model, local.entry, m.size_index[node]};
  const Sloped at_b = psi(w.pressure[b] - local.head);
  Sloped at_a{w.potential[a], w.potential_slope[a]};
  if (m.params.hysteresis && m.params.model == TransportModel::physical) {
    at_a = psi(w.pressure[a]);
    at_a.slope *= w.pressure_slope[a];
  }
  local.flow = local.factor * (at_a.value - at_b.value);
  local.slope_a = local.factor * at_a.slope;
  local.slope_b = -local.factor * at_b.slope * w.pressure_slope[b];
}

void pore_edge(Real open, const Work& w, Work::LocalEdge& local) {
  const Sloped at_a = valve(w.pressure[local.a] + 0.5 * local.head, open);
  const Sloped at_b = valve(w.pressure[local.b] - 0.5 * local.head, open);
  local.flow = local.factor * (at_a.value - at_b.value);
  local.slope_a = local.factor * at_a.slope * w.pressure_slope[local.a];
  local.slope_b = -local.factor * at_b.slope * w.pressure_slope[local.b];
}

void evaluate_edges(const WettingModel& m, Work& w) {
  parallel_for(w.edges.size(), [&](std::size_t e) {
    auto& local = w.edges[e];
    if (m.params.model == TransportModel::as_printed) return printed_edge(w, local);
    if (local.kind == EdgeKind::segment_pore) return segment_pore_edge(m, w, local);
    if (local.kind == EdgeKind::pore_pore) return pore_edge(m.edges[local.edge].valve, w, local);
    yarn_edge(m, w, local);
  }, loop_tile);
}

// Flow from the face into a pore. A wetting one fills as a tube of its throat, the filled length taken at the middle of
// the step (exact for Washburn's law); one that does not wet opens at its breakthrough only.
Sloped pore_supply(const TransportInput& input, const Work& w, Index local, const FaceSupply& supply) {
  const WettingModel& m = *input.model;
  const std::size_t pore = w.active[local] - m.segments;
  const Real p = w.pressure[local], dp = w.pressure_slope[local];
  if (!m.pore_wets[pore]) {
    const Real conductance = m.release_conductance[w.active[local]];
    if (supply.pressure <= m.pore_breakthrough[pore] && p <= supply.pressure) return {};
    if (p < 0) return {conductance * supply.pressure, 0};
    return {conductance * (supply.pressure - p), -conductance * dp};
  }
  const Real s = w.saturation[local], entry = m.entry[w.active[local]];
  const Real filled = std::clamp<Real>(0.5 * (s + w.old_saturation[local]), 1e-6, 1);
  const Real conductance = tube_conductance(m.pore_throat[pore], m.liquid.viscosity, filled * m.thickness);
  // The meniscus stands at s t; a pore fed from below lifts its column.
  const Real along = (supply.from_below ? 1 : -1) * input.gravity.z * m.liquid.density * m.thickness;
  const Real column = std::min<Real>(s, 1) * along;
  const bool full = s > 1;
  const Real drive = supply.pressure + column - (full ? p : -entry);
  const Real drive_slope = full ? -dp : along;
  Sloped flow{conductance * drive, conductance * drive_slope};
  if (drive > 0 && filled > 1e-6 && filled < 1) flow.slope -= 0.5 * flow.value / filled;
  flow.slope = std::min<Real>(flow.slope, 0);
  const Real most = m.pore_mouth[pore] * inertial_speed(drive, m.liquid.density);
  if (flow.value > most) {
    flow.value = most;
    flow.slope = full && drive > 0 ? -0.5 * most / drive * dp : 0;
  }
  return flow;
}

Sloped supply_law(const TransportInput& input, const Work& w, Index local, const FaceSupply& supply) {
  const WettingModel& m = *input.model;
  const Index node = w.active[local];
  const Real conductance = m.supply_conductance[node];
  switch (m.params.model) {
    case TransportModel::as_printed: {
      const Real full = node < m.segments ? printed_potential(1).value : 1;
      return {conductance * (full - w.potential[local]), -conductance * w.potential_slope[local]};
    }
    case TransportModel::kunzel:
    case TransportModel::physical: break;
  }
  if (node >= m.segments) return pore_supply(input, w, local, supply);
  const Sloped face = YarnPotential{m.params.model, m.entry[node], m.size_index[node]}(supply.pressure);
  if (m.params.hysteresis && m.params.model == TransportModel::physical) {
    const Sloped inside = kirchhoff_potential(m.entry[node], m.size_index[node], w.pressure[local]);
    return {conductance * (face.value - inside.value), -conductance * inside.slope * w.pressure_slope[local]};
  }
  return {conductance * (face.value - w.potential[local]), -conductance * w.potential_slope[local]};
}

void evaluate_supplies(const TransportInput& input, Work& w) {
  const Real density = input.model->liquid.density;
  for (auto& local : w.supplies) {
    const FaceSupply& supply = input.supplies[local.supply];
    const Sloped law = supply_law(input, w, local.node, supply);
    const Real share = std::min<Real>(1, supply.wetted_share);
    local.flow = share * law.value;
    local.slope = share * law.slope;
    const Real most = std::max<Real>(0, input.available_kg[local.supply]) / (density * input.dt);
    local.limited = local.flow >= most;
    if (local.limited) local.flow = most, local.slope = 0;
  }
}

// ---- Newton --------------------------------------------------------------------------------------------------------

void evaluate_all(const TransportInput& input, Work& w) {
  evaluate_nodes(*input.model, w);
  evaluate_edges(*input.model, w);
  evaluate_supplies(input, w);
}

// Residuals in units of saturation; returns the largest.
Real assemble(const TransportInput& input, Work& w, bool with_matrix) {
  const std::size_t n = w.active.size();
  const Real dt = input.dt;
  GraphMatrix& matrix = w.matrix;
  parallel_for(n, [&](std::size_t i) {
    Real flow = w.release[i], slope = w.release_slope[i];
    const Real scale = dt / w.volume[i];
    for (Index k = w.row_start[i]; k < w.row_start[i + 1]; ++k) {
      const auto& edge = w.edges[w.row_edge[k]];
      const bool first = edge.a == i;
      flow += first ? edge.flow : -edge.flow;
      slope += first ? edge.slope_a : -edge.slope_b;
      if (with_matrix) matrix.value[k] = scale * (first ? edge.slope_b : -edge.slope_a);
    }
    w.residual[i] = w.saturation[i] - w.old_saturation[i] + scale * flow;
    if (with_matrix) matrix.diagonal[i] = 1 + scale * slope;
  }, loop_tile);
  for (const auto& supply : w.supplies) {
    const Real scale = dt / w.volume[supply.node];
    w.residual[supply.node] -= scale * supply.flow;
    if (with_matrix) matrix.diagonal[supply.node] -= scale * supply.slope;
  }
  Real largest = 0;
  for (const Real value : w.residual) {
    if (!(std::abs(value) <= largest)) largest = std::abs(value);
  }
  return largest;
}

// Newton's unknown of a node is the left side of its own equation, its neighbours held,
//   Y(s) = s + (dt/V) C u(s),   C = sum of its links' conductances, u its potential:
// the saturation where storage rules, the potential where flow rules (a full yarn's p(s) is 260 times steeper than a
// nearly full one's). In Y each equation is close to a straight line on both sides of s = 1, so the iteration needs
// neither a limit nor a landing there. Any growing Y leads to the same solution; a rough u costs iterations only.
Sloped own_side(const WettingModel& m, const Work& w, std::size_t i, Real s) {
  const Index node = w.active[i];
  if (m.params.model == TransportModel::as_printed) return {s, 1};
  if (node < m.segments && m.params.model == TransportModel::kunzel) {
    const Sloped phi = kunzel_potential(s);
    return {s + w.own_share[i] * phi.value, 1 + w.own_share[i] * phi.slope};
  }
  const Sloped p = m.params.hysteresis ? hysteretic_pressure(m, node, s, w.reached[i]) : filling_pressure(m, node, s);
  const Sloped psi = YarnPotential{m.params.model, w.own_entry[i], m.params.yarn_size_index}(p.value);
  return {s + w.own_share[i] * psi.value, 1 + w.own_share[i] * psi.slope * p.slope};
}

// The saturation after Newton's `change` of it, taken in Y; at least a tenth of what it was, so it stays above 0.
Real moved_saturation(const WettingModel& m, const Work& w, std::size_t i, Real change) {
  const Real s = w.saturation[i], straight = s + change;
  const bool same_side = (s < 1) == (straight < 1);
  if (std::abs(change) <= straight_change * s && same_side) return straight;
  const Sloped here = own_side(m, w, i, s);
  const Real wanted = here.value + here.slope * change;
  const Real tolerance = straight_change * straight_change * std::abs(here.slope * change);
  Real low = change > 0 ? s : 0.1 * s, high = change > 0 ? straight : s;
  // Upwards Y may bend down (a pore that fills): then more than the straight step is needed, up to the top of the range.
  if (change > 0) {
    while (high < 2 && own_side(m, w, i, high).value < wanted) low = high, high = std::min<Real>(2, 2 * high);
  } else if (own_side(m, w, i, low).value >= wanted) {
    return low;
  }
  Real next = std::clamp(straight, low, high);
  for (int k = 0; k < 40; ++k) {
    const Sloped y = own_side(m, w, i, next);
    if (std::abs(y.value - wanted) <= tolerance) break;
    (y.value > wanted ? high : low) = next;
    Real better = next - (y.value - wanted) / y.slope;
    if (!(better > low && better < high)) better = low > 0 ? std::sqrt(low * high) : 0.5 * (low + high);
    if (high - low <= 1e-12 * high) break;
    next = better;
  }
  return next;
}

bool newton(const TransportInput& input, Work& w, TransportResult& result) {
  const WettingModel& m = *input.model;
  w.previous = w.saturation;
  Real last = 1e-3;
  for (int iteration = 0; iteration < most_newton; ++iteration) {
    evaluate_all(input, w);
    const Real largest = assemble(input, w, true);
    if (!std::isfinite(largest)) return false;
    if (largest <= residual_tolerance) return true;
    ++result.newton_iterations;
    // As exact as the iteration can use (Eisenstat and Walker's second choice): Newton is far from its parabola at first.
    const Real ratio = largest / last;
    last = largest;
    const Real forcing = std::clamp<Real>(ratio * ratio, 1e-4, 1e-2);
    const LinearSolve solve = solve_bicgstab(w.matrix, w.residual, w.change, forcing, 0.1 * residual_tolerance,
                                             most_linear, w.linear);
    result.linear_iterations += solve.iterations;
    if (!std::isfinite(solve.residual)) return false;
    const bool damped = iteration >= undamped_newton || m.params.model == TransportModel::as_printed;
    parallel_for(w.active.size(), [&](std::size_t i) {
      const Real s = w.saturation[i];
      w.saturation[i] = damped ? damped_saturation(s, -w.change[i], w.previous[i])
                               : moved_saturation(m, w, i, -w.change[i]);
      w.previous[i] = s;
    }, loop_tile);
  }
  return false;
}

// ---- masses --------------------------------------------------------------------------------------------------------

// Cuts the outflows of nodes that the flows would leave below zero (by the tolerance of Newton's method).
void limit_outflows(const TransportInput& input, Work& w) {
  const Real dt = input.dt;
  auto &supply_in = w.residual, &supply_out = w.change;
  for (int pass = 0; pass < 50; ++pass) {
    std::fill(supply_in.begin(), supply_in.end(), 0);
    std::fill(supply_out.begin(), supply_out.end(), 0);
    for (const auto& supply : w.supplies) {
      (supply.flow > 0 ? supply_in : supply_out)[supply.node] += std::abs(supply.flow);
    }
    const char cut = parallel_max(w.active.size(), char{0}, [&](std::size_t begin, std::size_t end) {
      char cut_here = 0;
      for (std::size_t i = begin; i < end; ++i) {
        Real in = supply_in[i], out = w.release[i] + supply_out[i];
        for (Index k = w.row_start[i]; k < w.row_start[i + 1]; ++k) {
          const auto& edge = w.edges[w.row_edge[k]];
          const Real away = edge.a == i ? edge.flow : -edge.flow;
          (away > 0 ? out : in) += std::abs(away);
        }
        w.scale[i] = 1;
        const Real held = w.old_content[i] + dt * in;
        if (out > 0 && dt * out > held * (1 + 1e-15)) w.scale[i] = std::max<Real>(0, held / (dt * out)), cut_here = 1;
      }
      return cut_here;
    }, loop_tile);
    if (!cut) return;
    for (auto& edge : w.edges) edge.flow *= w.scale[edge.flow > 0 ? edge.a : edge.b];
    for (auto& supply : w.supplies) {
      if (supply.flow < 0) supply.flow *= w.scale[supply.node];
    }
    for (std::size_t i = 0; i < w.release.size(); ++i) w.release[i] *= w.scale[i];
  }
}

void update_masses(const TransportInput& input, Contents& contents, Work& w, TransportResult& result,
                   std::vector<ReleasedLiquid>& released) {
  const WettingModel& m = *input.model;
  const Real mass = m.liquid.density * input.dt;
  parallel_for(w.active.size(), [&](std::size_t i) {
    Real flow = 0;
    for (Index k = w.row_start[i]; k < w.row_start[i + 1]; ++k) {
      const auto& edge = w.edges[w.row_edge[k]];
      flow += edge.a == i ? edge.flow : -edge.flow;
    }
    contents.liquid_kg[w.active[i]] -= mass * flow;
  }, loop_tile);
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
    const Real most = m.liquid.density * w.volume[i] * (1 + m.overfill[node]);
    const Real surplus = std::max(mass * w.release[i], held - most);
    if (surplus > 0) {
      const Real kg = std::min(surplus, held);
      held -= kg;
      released.push_back({node, kg});
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
    if (!newton(input, work, result)) return result;
  } while (widen_active(*input.model, work));
  result.active_nodes = work.saturation.size();
  limit_outflows(input, work);
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
