#include "imbibe/wetting/transport_laws.h"

#include <algorithm>

#include "imbibe/core/parallel.h"
#include "imbibe/wetting/capillary.h"
#include "imbibe/wetting/crossing.h"
#include "imbibe/wetting/entry.h"

namespace imbibe {
namespace {

using Work = TransportWorkspace;

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
  if (local.kind != EdgeKind::along_yarn && !m.edges[local.edge].same_material) {
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
  const Real along = (supply.from_below ? 1 : -1) * input.across(supply.node) * m.liquid.density * m.thickness;
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

}  // namespace

void evaluate_nodes(const WettingModel& m, TransportWorkspace& w) {
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
    const Sloped open = valve(p.value + w.face_head[i], m.open[node]);
    const Real conductance = w.face_share[i] * m.release_conductance[node];
    w.release[i] = conductance * open.value;
    w.release_slope[i] = conductance * open.slope * p.slope;
  }, transport_tile);
}

void evaluate_edges(const WettingModel& m, TransportWorkspace& w) {
  parallel_for(w.edges.size(), [&](std::size_t e) {
    auto& local = w.edges[e];
    if (m.params.model == TransportModel::as_printed) return printed_edge(w, local);
    if (local.kind == EdgeKind::segment_pore) return segment_pore_edge(m, w, local);
    if (local.kind == EdgeKind::pore_pore) return pore_edge(local.entry, w, local);
    yarn_edge(m, w, local);
  }, transport_tile);
}

void evaluate_supplies(const TransportInput& input, TransportWorkspace& w) {
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

}  // namespace imbibe
