#include "imbibe/wetting/solved_set.h"

#include <algorithm>

#include "imbibe/core/parallel.h"
#include "imbibe/core/portable.h"
#include "imbibe/wetting/face_back.h"
#include "imbibe/wetting/transport_laws.h"

namespace imbibe {
namespace {

constexpr Real opened_pore = 0.5;      // saturation from which a rejecting pore no longer holds liquid off
constexpr Real wet_saturation = 1e-7;  // a node above it belongs to the solved set with its neighbours

using Work = TransportWorkspace;

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

// Effective entry suction of the curve a node is on now: the filling branch's, or higher while it drains.
Real effective_entry(const WettingModel& m, const Work& w, Index local) {
  const Index node = w.active[local];
  const Real s = w.old_saturation[local];
  if (!m.params.hysteresis || s >= 1 || s <= driest) return m.entry[node];
  return -w.pressure[local] * portable::pow(s, 1 / m.size_index[node]);
}

// The weight of the column from a node down to the lower of `faces`, Pa; a node without one gives off nothing.
// across: gravity along the face's normal there, m/s2.
Real face_head(const WettingModel& m, Index node, std::uint8_t faces, Real across) {
  const Real half = 0.5 * m.stack_thickness, z = m.centre[node].z;
  Real most = -std::numeric_limits<Real>::infinity();
  if (faces & upper_face) most = across * (half - z);
  if (faces & lower_face) most = std::max(most, across * (-half - z));
  return faces == 0 ? 0 : m.liquid.density * most;
}

// Where a node gives off. Liquid that covers a face exchanges with the node as its supply: through the other face then,
// or through what is left of this one.
void find_release_faces(const TransportInput& input, Work& w) {
  const WettingModel& m = *input.model;
  parallel_for(w.active.size(), [&](std::size_t i) {
    const Index node = w.active[i];
    w.face_share[i] = 1;
    w.face_head[i] = face_head(m, node, m.faces[node], input.across(node));
  }, transport_tile);
  for (const FaceSupply& supply : input.supplies) {
    const Index i = w.local_of[supply.node];
    if (i == no_index || !(supply.wetted_share > 0)) continue;
    const std::uint8_t covered = supply.from_below ? lower_face : upper_face;
    const auto other = static_cast<std::uint8_t>(m.faces[supply.node] & ~covered);
    if (other != 0) w.face_head[i] = face_head(m, supply.node, other, input.across(supply.node));
    else w.face_share[i] = 1 - std::min<Real>(1, supply.wetted_share);
  }
}

// What a pore's valve to another opens at: a rejecting pore that is still empty must be broken through first.
Real valve_opening(const WettingModel& m, const Work& w, const WettingEdge& edge, Index local_a, Index local_b) {
  const auto opening = [&](Index node, Index local) {
    const std::size_t pore = node - m.segments;
    const bool shut = !m.pore_wets[pore] && w.old_saturation[local] < opened_pore;
    return shut ? std::max(edge.valve, m.pore_breakthrough[pore]) : edge.valve;
  };
  return std::max(opening(edge.a, local_a), opening(edge.b, local_b));
}

// How much of its full contact a bridge between two layers has at the higher of its pressures.
Real bridge_share(const WettingModel& m, const CrownBridge& bridge, Real pressure) {
  const Real height = bridged_height(m.liquid.surface_tension, bridge.cosines, pressure);
  return bridged_area(height, bridge.gap, bridge.area_per_height, bridge.most) / bridge.most;
}

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
  }, transport_tile);
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
  }, transport_tile);
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
  }, transport_tile);
  parallel_for(n, [&](std::size_t i) {
    Index next = w.row_start[i];
    each_link(i, [&](Index e, Index other) { w.row_edge[next] = w.edge_place[e], w.row_other[next++] = other; });
  }, transport_tile);
  w.matrix.row_start = w.row_start;
  w.matrix.column = w.row_other;
  w.matrix.value.resize(w.row_other.size());
  w.matrix.diagonal.resize(n);
  ++w.matrix.pattern;
  w.rows_of = &m;
  w.rows_for = w.active;
}

}  // namespace

void choose_active(const TransportInput& input, const Contents& contents, TransportWorkspace& w) {
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

bool widen_active(const WettingModel& m, TransportWorkspace& w) {
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

void gather(const TransportInput& input, const Contents& contents, TransportWorkspace& w) {
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
                       &w.potential, &w.potential_slope, &w.face_head, &w.face_share, &w.release, &w.release_slope, &w.residual, &w.change,
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
  }, transport_tile);
  find_release_faces(input, w);
  evaluate_nodes(m, w);
  const bool kunzel = m.params.model == TransportModel::kunzel;
  const Real redistribution = kunzel && input.supplies.empty() ? m.params.redistribution_factor : 1;
  const Vec3 weight = m.liquid.density * input.gravity;
  parallel_for(w.edges.size(), [&](std::size_t e) {
    auto& local = w.edges[e];
    const WettingEdge& edge = m.edges[local.edge];
    local.factor = edge.conductance;
    local.head = input.field ? m.liquid.density * (input.field->potential[edge.b] - input.field->potential[edge.a])
                             : dot(weight, edge.offset);
    const bool between_layers = std::abs(edge.offset.z) > 0.5 * m.thickness;
    if (edge.kind == EdgeKind::pore_pore)
      local.entry = between_layers ? valve_opening(m, w, edge, local.a, local.b) : edge.valve;
    if (edge.kind == EdgeKind::pore_pore || m.params.model == TransportModel::as_printed) return;
    if (edge.kind == EdgeKind::face_back)
      local.factor *= bridge_share(m, m.bridges[edge.contact], std::max(w.pressure[local.a], w.pressure[local.b]));
    const bool upper_is_a = w.pressure[local.a] >= w.pressure[local.b];
    const Index upstream = edge.kind == EdgeKind::segment_pore || upper_is_a ? local.a : local.b;
    local.entry = effective_entry(m, w, upstream);
    local.factor *= redistribution;
    if (edge.kind == EdgeKind::segment_pore) {
      local.factor *= std::sqrt(std::clamp<Real>(w.old_saturation[local.b], driest_wall, 1));
    }
  }, transport_tile);
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

}  // namespace imbibe
