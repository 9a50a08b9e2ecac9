#include "imbibe/wetting/solved_set.h"

#include <algorithm>

#include "imbibe/core/parallel.h"
#include "imbibe/core/portable.h"
#include "imbibe/wetting/transport_laws.h"

namespace imbibe {
namespace {

constexpr Real wet_saturation = 1e-7;  // a node above it belongs to the solved set with its neighbours

using Work = TransportWorkspace;

// Makes room for `size` values that are all written anew; unlike resize() for no more than these.
template <class T>
void fit(std::vector<T>& values, std::size_t size) {
  if (values.capacity() < size) values = std::vector<T>();
  values.resize(size);
}

void add_active(const WettingModel& m, Work& w, Index node) {
  if (w.local_of[node] != no_index || m.volume(node) <= 0) return;
  w.local_of[node] = 0;
  w.active.push_back(node);
}

void add_neighbours(const WettingModel& m, Work& w, Index node) {
  for (Index k = m.row_start[node]; k < m.row_start[node + 1]; ++k) {
    if (m.links[m.row_link[k]].conductance > 0) add_active(m, w, m.row_other[k]);
  }
}

// Adds the neighbours of those active nodes [first, last) that `from` chooses. Few of these lie at the rim.
template <class From>
void add_ring(const WettingModel& m, Work& w, std::size_t first, std::size_t last, From&& from) {
  fit(w.at_rim, last - first);
  parallel_for(last - first, [&](std::size_t i) {
    const Index node = w.active[first + i];
    const auto row = m.row_other.begin();
    w.at_rim[i] = from(first + i) && std::any_of(row + m.row_start[node], row + m.row_start[node + 1], [&](Index other) {
      return w.local_of[other] == no_index;
    });
  }, transport_tile);
  for (std::size_t i = first; i < last; ++i) {
    if (w.at_rim[i - first]) add_neighbours(m, w, w.active[i]);
  }
}

// Effective entry suction of the curve a node is on now: the filling branch's, or higher while it drains.
Real effective_entry(const WettingModel& m, const Work& w, Index local) {
  const Index node = w.active[local];
  const Real s = w.old_saturation[local];
  if (!m.params.hysteresis || s >= 1 || s <= driest) return m.entry(node);
  const Retention curve = retention_of(m.at(node));
  return -w.pressure[local] * portable::pow(plain_saturation(curve, s), 1 / curve.size_index);
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
    w.face_head[i] = static_cast<float>(face_head(m, node, m.faces(node), input.across(node)));
  }, transport_tile);
  for (const FaceSupply& supply : input.supplies) {
    const Index i = w.local_of[supply.node];
    if (i == no_index || !(supply.wetted_share > 0)) continue;
    const std::uint8_t covered = supply.from_below ? lower_face : upper_face;
    const auto other = static_cast<std::uint8_t>(m.faces(supply.node) & ~covered);
    if (other != 0) w.face_head[i] = static_cast<float>(face_head(m, supply.node, other, input.across(supply.node)));
    else w.face_share[i] = static_cast<float>(1 - std::min<Real>(1, supply.wetted_share));
  }
}

// What the links of a node make of its potential (own_side).
void gather_own_sides(const TransportInput& input, Work& w) {
  const WettingModel& m = *input.model;
  parallel_for(w.active.size(), [&](std::size_t i) {
    Real conductance = 0, entry = 0;
    for (Index k = w.matrix.row_start[i]; k < w.matrix.row_start[i + 1]; ++k) {
      const LinkKind& link = m.links[w.link_kind[w.row_link[k]]];
      if (link.kind == EdgeKind::pore_pore) continue;
      const auto here = static_cast<Index>(i), other = w.matrix.column[k];
      const bool first = w.active[here] < w.active[other];
      const Index a = first ? here : other, b = first ? other : here;
      const Real factor = link_factor(m, w, link, a, b);
      conductance += factor, entry += factor * link_entry(m, w, link, a, b);
    }
    const bool segment = w.active[i] < m.segments && !m.params.hysteresis;
    w.own_share[i] = static_cast<float>(input.dt / w.volume[i] * conductance);
    w.own_entry[i] = static_cast<float>(segment || conductance <= 0 ? m.entry(w.active[i]) : entry / conductance);
  }, transport_tile);
}

constexpr auto any = [](std::size_t) { return true; };

void order_active(const WettingModel& m, Work& w) {
  w.active.clear();
  for (const Index node : m.by_place) {
    if (w.local_of[node] == no_index) continue;
    w.local_of[node] = static_cast<Index>(w.active.size());
    w.active.push_back(node);
  }
}

// By how many places the nodes of a link lie apart.
std::size_t farthest_link(const WettingModel& m, const Work& w) {
  return parallel_max(w.active.size(), std::size_t{0}, [&](std::size_t begin, std::size_t end) {
    std::size_t farthest = 0;
    for (std::size_t i = begin; i < end; ++i) {
      for (Index k = m.row_start[w.active[i]]; k < m.row_start[w.active[i] + 1]; ++k) {
        const Index other = w.local_of[m.row_other[k]];
        if (other != no_index && other > i) farthest = std::max(farthest, other - i);
      }
    }
    return farthest;
  }, transport_tile);
}

// The links of the set, and the pattern of the matrix. A link belongs to the first of its nodes.
void build_rows(const WettingModel& m, Work& w) {
  const std::size_t n = w.active.size();
  const bool kept = w.rows_of == &m && w.rows_for == w.active;
  if (!kept) w.rows_for = w.active, w.matrix.order = order_in_halves(n, farthest_link(m, w));
  parallel_for(n, [&](std::size_t i) {
    const std::size_t place = w.matrix.order.place(i);
    w.active[place] = w.rows_for[i];
    w.local_of[w.rows_for[i]] = static_cast<Index>(place);
  }, transport_tile);
  if (kept) return;
  w.rows_of = &m;
  std::vector<Index>& first_link = w.kind;  // until the end
  std::vector<Index>& row_start = w.matrix.row_start;
  row_start.assign(n + 1, 0);
  first_link.assign(n + 1, 0);
  const auto each_link = [&](std::size_t i, auto&& call) {
    const Index node = w.active[i];
    for (Index k = m.row_start[node]; k < m.row_start[node + 1]; ++k) {
      const Index other = w.local_of[m.row_other[k]];
      if (other != no_index && m.links[m.row_link[k]].conductance > 0) call(other, m.row_link[k]);
    }
  };
  parallel_for(n, [&](std::size_t i) {
    each_link(i, [&](Index other, Index) { ++row_start[i + 1], first_link[i + 1] += other > i; });
  }, transport_tile);
  for (std::size_t i = 0; i < n; ++i) row_start[i + 1] += row_start[i], first_link[i + 1] += first_link[i];
  fit(w.links, first_link[n]);
  fit(w.link_kind, first_link[n]);
  fit(w.row_link, row_start[n]);
  fit(w.matrix.column, row_start[n]);
  parallel_for(n, [&](std::size_t i) {
    Index own = first_link[i], after = row_start[i + 1] - (first_link[i + 1] - own), before = row_start[i];
    each_link(i, [&](Index other, Index kind) {
      Index& next = other > i ? after : before;
      w.matrix.column[next] = other;
      w.row_link[next++] = other > i ? own : kind;  // of the others the kind, until the link is found
      if (other > i) w.link_kind[own++] = kind;
    });
  }, transport_tile);
  // The other node finds the link in the first one's row; parallel links of one kind are all alike.
  parallel_for(n, [&](std::size_t i) {
    for (Index k = row_start[i]; k < row_start[i + 1] && w.matrix.column[k] < i; ++k) {
      const Index other = w.matrix.column[k], kind = w.row_link[k];
      for (Index link = first_link[other], back = row_start[other + 1] - (first_link[other + 1] - link);
           link < first_link[other + 1]; ++link, ++back) {
        if (w.matrix.column[back] == i && w.link_kind[link] == kind) w.row_link[k] = link;
      }
    }
  }, transport_tile);
  fit(w.matrix.value, row_start[n]);
  fit(w.matrix.scale, n);
  fit(w.matrix.diagonal, n);
}

}  // namespace

void choose_active(const TransportInput& input, const Contents& contents, TransportWorkspace& w) {
  const WettingModel& m = *input.model;
  w.local_of.assign(m.nodes(), no_index);
  w.active.clear();
  for (std::size_t i = 0; i < m.nodes(); ++i) {
    if (m.volume(i) > 0 && contents.liquid_kg[i] > wet_saturation * m.liquid.density * m.volume(i)) {
      add_active(m, w, static_cast<Index>(i));
    }
  }
  for (std::size_t i = 0; i < input.supplies.size(); ++i) {
    if (input.supplies[i].wetted_share > 0) add_active(m, w, input.supplies[i].node);
  }
  const std::size_t seeds = w.active.size();
  add_ring(m, w, 0, seeds, any);
  const std::size_t ring = w.active.size();
  add_ring(m, w, seeds, ring, any);
}

bool widen_active(const WettingModel& m, TransportWorkspace& w) {
  const std::size_t before = w.active.size();
  add_ring(m, w, 0, before, [&](std::size_t i) { return w.saturation[i] > wet_saturation; });
  if (w.active.size() == before) return false;
  for (int ring = 0; ring < 2; ++ring) add_ring(m, w, before, w.active.size(), any);
  return true;
}

void gather(const TransportInput& input, const Contents& contents, TransportWorkspace& w) {
  const WettingModel& m = *input.model;
  w.previous = w.saturation;  // of the first nodes in `active`
  const std::vector<Index> solved(w.active.begin(), w.active.begin() + static_cast<std::ptrdiff_t>(w.saturation.size()));
  order_active(m, w);
  build_rows(m, w);
  const std::size_t n = w.active.size();
  for (auto* vector : {&w.volume, &w.old_saturation, &w.saturation, &w.pressure, &w.potential, &w.height, &w.residual,
                       &w.change}) {
    fit(*vector, n);
  }
  for (auto* vector : {&w.pressure_slope, &w.potential_slope, &w.own_share, &w.own_entry, &w.old_pressure, &w.face_head,
                       &w.face_share}) {
    fit(*vector, n);
  }
  if (m.params.hysteresis) fit(w.reached, n), fit(w.curve_entry, n);
  fit(w.kind, n);
  const Vec3 weight = m.liquid.density * input.gravity;
  parallel_for(n, [&](std::size_t i) {
    const Index node = w.active[i];
    w.kind[i] = m.kind[node];
    w.height[i] = input.field ? m.liquid.density * input.field->potential[node] : dot(weight, m.centre[node]);
    w.volume[i] = current_volume(m, contents, node);
    w.old_saturation[i] = contents.liquid_kg[node] / m.liquid.density / w.volume[i];
    if (m.params.hysteresis) w.reached[i] = contents.reached_saturation[node];
    w.pressure[i] = w.pressure_slope[i] = 0;  // in the model as printed
    set_saturation(m, w, i, w.old_saturation[i]);
    w.old_pressure[i] = static_cast<float>(w.pressure[i]);
    if (m.params.hysteresis) w.curve_entry[i] = effective_entry(m, w, static_cast<Index>(i));
  }, transport_tile);
  find_release_faces(input, w);
  const bool kunzel = m.params.model == TransportModel::kunzel;
  w.redistribution = kunzel && input.supplies.empty() ? m.params.redistribution_factor : 1;
  gather_own_sides(input, w);
  w.supplies.clear();
  for (std::size_t i = 0; i < input.supplies.size(); ++i) {
    const Index local = w.local_of[input.supplies[i].node];
    if (local != no_index && input.supplies[i].wetted_share > 0) w.supplies.push_back({.supply = i, .node = local});
  }
  parallel_for(solved.size(), [&](std::size_t i) { set_saturation(m, w, w.local_of[solved[i]], w.previous[i]); },
               transport_tile);
}

}  // namespace imbibe
