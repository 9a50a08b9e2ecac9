#include "imbibe/wetting/transport_laws.h"

#include <algorithm>

#include "imbibe/core/parallel.h"
#include "imbibe/wetting/capillary.h"
#include "imbibe/wetting/crossing.h"
#include "imbibe/wetting/entry.h"
#include "imbibe/wetting/face_back.h"

namespace imbibe {
namespace {

using Work = TransportWorkspace;

using Flow = Work::LinkFlow;

constexpr Real opened_pore = 0.5;  // saturation from which a rejecting pore no longer holds liquid off

Flow flow_of(Real factor, const Sloped& at_a, const Sloped& at_b) {
  return {factor * (at_a.value - at_b.value), static_cast<float>(factor * at_a.slope),
          static_cast<float>(-factor * at_b.slope)};
}

// A potential over pressure, as one over saturation.
Sloped over_saturation(Sloped potential, const Work& w, Index local) {
  potential.slope *= w.pressure_slope[local];
  return potential;
}

Flow printed_link(const WettingModel& m, const Work& w, const LinkKind& link, Index a, Index b) {
  Sloped at_b{w.potential[b], w.potential_slope[b]};
  if (link.kind == EdgeKind::segment_pore) at_b = printed_potential(w.saturation[b]);
  return flow_of(link_factor(m, w, link, a, b), {w.potential[a], w.potential_slope[a]}, at_b);
}

Flow yarn_link(const WettingModel& m, const Work& w, const LinkKind& link, Index a, Index b, Real head) {
  const TransportModel law = m.params.model;
  const Real factor = link_factor(m, w, link, a, b);
  if (link.kind != EdgeKind::along_yarn && !link.same_material) {
    const Real share = factor / link.conductance;
    const NodeKind &at_a = m.kinds[w.kind[a]], &at_b = m.kinds[w.kind[b]];
    const CrossingFlow x = crossing_flow(YarnPotential{law, at_a.entry, at_a.size_index},
                                         YarnPotential{law, at_b.entry, at_b.size_index}, factor,
                                         share * link.conductance_b, w.pressure[a], w.pressure[b]);
    return {x.flow, static_cast<float>(x.slope_a * w.pressure_slope[a]),
            static_cast<float>(x.slope_b * w.pressure_slope[b])};
  }
  // Both pressures are carried to the middle of the link, so that a hanging column comes to rest exactly. Kuenzel's
  // diffusivity knows no gravity.
  if (law == TransportModel::physical && (m.params.hysteresis || head != 0)) {
    const Real index = m.kinds[w.kind[a]].size_index, entry = link_entry(m, w, link, a, b);
    return flow_of(factor, over_saturation(kirchhoff_potential(entry, index, w.pressure[a] + 0.5 * head), w, a),
                   over_saturation(kirchhoff_potential(entry, index, w.pressure[b] - 0.5 * head), w, b));
  }
  return flow_of(factor, {w.potential[a], w.potential_slope[a]}, {w.potential[b], w.potential_slope[b]});
}

// a is the segment. The pore's pressure is carried to the segment's height.
Flow segment_pore_link(const WettingModel& m, const Work& w, const LinkKind& link, Index a, Index b, Real head) {
  const YarnPotential psi{m.params.model, link_entry(m, w, link, a, b), m.kinds[w.kind[a]].size_index};
  const bool shifted = m.params.hysteresis && m.params.model == TransportModel::physical;
  return flow_of(link_factor(m, w, link, a, b),
                 shifted ? over_saturation(psi(w.pressure[a]), w, a) : Sloped{w.potential[a], w.potential_slope[a]},
                 over_saturation(psi(w.pressure[b] - head), w, b));
}

// What the valve between two pores opens at: between layers a rejecting pore that is still empty must be broken through.
Real valve_opening(const WettingModel& m, const Work& w, const LinkKind& link, Index a, Index b) {
  if (!link.between_layers) return link.valve;
  const auto opening = [&](Index local) {
    const NodeKind& pore = m.kinds[w.kind[local]];
    const bool shut = !pore.wets && w.old_saturation[local] < opened_pore;
    return shut ? std::max(link.valve, pore.breakthrough) : link.valve;
  };
  return std::max(opening(a), opening(b));
}

Flow pore_link(Real open, const Work& w, const LinkKind& link, Index a, Index b, Real head) {
  return flow_of(link.conductance, over_saturation(valve(w.pressure[a] + 0.5 * head, open), w, a),
                 over_saturation(valve(w.pressure[b] - 0.5 * head, open), w, b));
}

Flow flow_over(const WettingModel& m, const Work& w, const LinkKind& link, Index a, Index b) {
  if (m.params.model == TransportModel::as_printed) return printed_link(m, w, link, a, b);
  const Real head = w.height[b] - w.height[a];
  if (link.kind == EdgeKind::segment_pore) return segment_pore_link(m, w, link, a, b, head);
  if (link.kind == EdgeKind::pore_pore) return pore_link(valve_opening(m, w, link, a, b), w, link, a, b, head);
  return yarn_link(m, w, link, a, b, head);
}

// Flow from the face into a pore. A wetting one fills as a tube of its throat, the filled length taken at the middle of
// the step (exact for Washburn's law); one that does not wet opens at its breakthrough only.
Sloped pore_supply(const TransportInput& input, const Work& w, Index local, const FaceSupply& supply) {
  const WettingModel& m = *input.model;
  const std::size_t pore = w.active[local] - m.segments;
  const Real p = w.pressure[local], dp = w.pressure_slope[local];
  if (!m.pore_wets(pore)) {
    const Real conductance = m.release_conductance(w.active[local]);
    if (supply.pressure <= m.pore_breakthrough(pore) && p <= supply.pressure) return {};
    if (p < 0) return {conductance * supply.pressure, 0};
    return {conductance * (supply.pressure - p), -conductance * dp};
  }
  const Real s = w.saturation[local], entry = m.entry(w.active[local]);
  const Real filled = std::clamp<Real>(0.5 * (s + w.old_saturation[local]), 1e-6, 1);
  const Real conductance = tube_conductance(m.pore_throat(pore), m.liquid.viscosity, filled * m.thickness);
  // The meniscus stands at s t; a pore fed from below lifts its column.
  const Real along = (supply.from_below ? 1 : -1) * input.across(supply.node) * m.liquid.density * m.thickness;
  const Real column = std::min<Real>(s, 1) * along;
  const bool full = s > 1;
  const Real drive = supply.pressure + column - (full ? p : -entry);
  const Real drive_slope = full ? -dp : along;
  Sloped flow{conductance * drive, conductance * drive_slope};
  if (drive > 0 && filled > 1e-6 && filled < 1) flow.slope -= 0.5 * flow.value / filled;
  flow.slope = std::min<Real>(flow.slope, 0);
  const Real most = m.pore_mouth(pore) * inertial_speed(drive, m.liquid.density);
  if (flow.value > most) {
    flow.value = most;
    flow.slope = full && drive > 0 ? -0.5 * most / drive * dp : 0;
  }
  return flow;
}

Sloped supply_law(const TransportInput& input, const Work& w, Index local, const FaceSupply& supply) {
  const WettingModel& m = *input.model;
  const Index node = w.active[local];
  const Real conductance = m.supply_conductance(node);
  switch (m.params.model) {
    case TransportModel::as_printed: {
      const Real full = node < m.segments ? printed_potential(1).value : 1;
      return {conductance * (full - w.potential[local]), -conductance * w.potential_slope[local]};
    }
    case TransportModel::kunzel:
    case TransportModel::physical: break;
  }
  if (node >= m.segments) return pore_supply(input, w, local, supply);
  const Sloped face = YarnPotential{m.params.model, m.entry(node), m.size_index(node)}(supply.pressure);
  if (m.params.hysteresis && m.params.model == TransportModel::physical) {
    const Sloped inside = kirchhoff_potential(m.entry(node), m.size_index(node), w.pressure[local]);
    return {conductance * (face.value - inside.value), -conductance * inside.slope * w.pressure_slope[local]};
  }
  return {conductance * (face.value - w.potential[local]), -conductance * w.potential_slope[local]};
}

}  // namespace

Real link_factor(const WettingModel& m, const TransportWorkspace& w, const LinkKind& link, Index a, Index b) {
  if (link.kind == EdgeKind::pore_pore || m.params.model == TransportModel::as_printed) return link.conductance;
  Real factor = link.conductance;
  if (link.kind == EdgeKind::face_back) {
    const CrownBridge& bridge = m.bridges[link.contact];
    const Real height =
        bridged_height(m.liquid.surface_tension, bridge.cosines, std::max(w.old_pressure[a], w.old_pressure[b]));
    factor *= bridged_area(height, bridge.gap, bridge.area_per_height, bridge.most) / bridge.most;
  }
  factor *= w.redistribution;
  if (link.kind == EdgeKind::segment_pore) factor *= std::sqrt(std::clamp<Real>(w.old_saturation[b], driest_wall, 1));
  return factor;
}

Real link_entry(const WettingModel& m, const TransportWorkspace& w, const LinkKind& link, Index a, Index b) {
  const bool upstream_is_a = link.kind == EdgeKind::segment_pore || w.old_pressure[a] >= w.old_pressure[b];
  const Index upstream = upstream_is_a ? a : b;
  return m.params.hysteresis ? w.curve_entry[upstream] : m.kinds[w.kind[upstream]].entry;
}

void set_saturation(const WettingModel& m, TransportWorkspace& w, std::size_t i, Real s) {
  w.saturation[i] = s;
  if (m.params.model == TransportModel::as_printed) return;
  const Sloped p = m.params.hysteresis ? hysteretic_pressure(m, w.active[i], s, w.reached[i])
                                       : filling_pressure(m.kinds[w.kind[i]], s);
  w.pressure[i] = p.value, w.pressure_slope[i] = static_cast<float>(p.slope);
}

Sloped release_law(const WettingModel& m, const TransportWorkspace& w, std::size_t i) {
  if (m.params.model == TransportModel::as_printed) return {};
  const NodeKind& kind = m.kinds[w.kind[i]];
  const Sloped open = valve(w.pressure[i] + w.face_head[i], kind.open);
  const Real conductance = w.face_share[i] * kind.release_conductance;
  return {conductance * open.value, conductance * open.slope * w.pressure_slope[i]};
}

void evaluate_nodes(const WettingModel& m, TransportWorkspace& w) {
  parallel_for(w.active.size(), [&](std::size_t i) {
    const bool segment = w.active[i] < m.segments;
    Sloped potential;
    switch (m.params.model) {
      case TransportModel::as_printed:
        potential = segment ? printed_potential(w.saturation[i]) : Sloped{w.saturation[i], 1};
        break;
      case TransportModel::kunzel:
        if (segment) potential = kunzel_potential(w.saturation[i]);
        break;
      case TransportModel::physical:
        if (!segment) break;
        const NodeKind& kind = m.kinds[w.kind[i]];
        potential = kirchhoff_potential(kind.entry, kind.size_index, w.pressure[i]);
        potential.slope *= w.pressure_slope[i];
        break;
    }
    w.potential[i] = potential.value, w.potential_slope[i] = static_cast<float>(potential.slope);
  }, transport_tile);
}

void evaluate_links(const WettingModel& m, TransportWorkspace& w) {
  parallel_for(w.active.size(), [&](std::size_t i) {
    for (Index k = w.matrix.row_start[i + 1]; k-- > w.matrix.row_start[i] && w.matrix.column[k] > i;) {
      const auto here = static_cast<Index>(i), other = w.matrix.column[k];
      const Index number = w.row_link[k];
      const LinkKind& link = m.links[w.link_kind[number]];
      const bool first = w.active[here] < w.active[other];
      w.links[number] = flow_over(m, w, link, first ? here : other, first ? other : here);
    }
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
