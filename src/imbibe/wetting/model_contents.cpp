// What the model says of contents: volumes, saturations, pressures, sums. Its building is in wetting_model.cpp.
#include "imbibe/wetting/wetting_model.h"

#include <algorithm>
#include <cmath>

#include "imbibe/core/portable.h"
#include "imbibe/wetting/isotherm.h"
#include "imbibe/wetting/swelling.h"

namespace imbibe {
namespace {

constexpr Real scanning_power = 4;                 // from the filling to the draining branch: P_c ~ s^-4

}  // namespace

Sloped filling_pressure(const NodeKind& node, Real saturation_value) {
  if (node.pore() && !node.wets) {
    // Pushes its liquid out at every content; the last per cent clings to the crossings.
    constexpr Real cling = 0.01, cling_suction = 100;
    const Real slope = node.open / (1 + node.overfill);
    const Real s = std::max(saturation_value, driest);
    if (s >= cling) return {slope * s, slope};
    const Real rise = std::sqrt(cling / s);
    return {slope * s - cling_suction * (rise - 1), slope + 0.5 * cling_suction * rise / s};
  }
  return pressure_at(retention_of(node), saturation_value);
}

Sloped hysteretic_pressure(const WettingModel& m, std::size_t node, Real s, Real reached) {
  const Real top = std::min<Real>(1, reached);
  if (s >= top || s <= driest || (node >= m.segments && !m.pore_wets(node - m.segments))) {
    return filling_pressure(m, node, s);
  }
  Retention curve = retention_of(m.at(node));
  const Real scanning = -pressure_at(curve, top).value * portable::pow(top / s, scanning_power);
  curve.entry = m.entry_receding(node);
  const Sloped draining = pressure_at(curve, s);
  if (-draining.value < scanning) return draining;
  return {-scanning, scanning_power * scanning / s};
}

Contents conditioned_contents(const WettingModel& m, const Air& air) {
  Contents contents;
  contents.liquid_kg.assign(m.nodes(), 0);
  std::vector<Real> regain;
  for (const Fibre& fibre : m.fibres) regain.push_back(equilibrium_regain(fibre, air.humidity));
  for (std::size_t s = 0; s < m.segments; ++s) {
    const Real w = regain[m.segment_type[s]];
    contents.sorbed_kg.push_back(m.dry_mass(s) * w);
    contents.shell_regain.insert(contents.shell_regain.end(), static_cast<std::size_t>(m.shells.count), w);
  }
  if (m.params.hysteresis) contents.reached_saturation.assign(m.nodes(), 0);
  return contents;
}

Real current_volume(const WettingModel& m, const Contents& contents, std::size_t node) {
  const auto growth = [&](std::size_t s) {
    const YarnWetting& yarn = m.yarns[m.segment_type[s]];
    return swollen_area(yarn.area_swelling, contents.sorbed_kg[s] / m.dry_mass(s), yarn.regain_65,
                        yarn.swelling_regain);
  };
  if (m.params.model == TransportModel::as_printed || m.volume(node) <= 0) return m.volume(node);
  if (node < m.segments) return m.yarns[m.segment_type[node]].area_swelling > 0 ? m.volume(node) * growth(node)
                                                                                : m.volume(node);
  Real taken = 0;
  for (const Index s : m.segments_of_pore(node - m.segments)) {
    if (m.yarns[m.segment_type[s]].area_swelling > 0) taken += 0.25 * m.yarn_volume(s) * (growth(s) - 1);
  }
  return shrunk_pore(m.volume(node), taken);
}

Real saturation(const WettingModel& m, const Contents& contents, std::size_t node) {
  const Real volume = current_volume(m, contents, node);
  if (volume > 0) return contents.liquid_kg[node] / (m.liquid.density * volume);
  if (node >= m.segments) return 0;
  const YarnWetting& yarn = m.yarns[m.segment_type[node]];
  const Real room = yarn.swelling_regain - yarn.regain_65;
  if (yarn.void_share > 0 || room <= 0) return 0;
  return std::clamp<Real>((node_regain(m, contents, node) - yarn.regain_65) / room, 0, 1);
}

Real node_pressure(const WettingModel& m, const Contents& contents, std::size_t node) {
  if (m.volume(node) <= 0 || m.params.model == TransportModel::as_printed) return 0;
  const Real s = saturation(m, contents, node);
  const Real reached = contents.reached_saturation.empty() ? 0 : contents.reached_saturation[node];
  return m.params.hysteresis ? hysteretic_pressure(m, node, s, reached).value : filling_pressure(m, node, s).value;
}

Real node_regain(const WettingModel& m, const Contents& contents, std::size_t segment) {
  return contents.sorbed_kg[segment] / m.dry_mass(segment);
}

namespace {
Real sum_of(const std::vector<Real>& values, std::size_t begin, std::size_t end) {
  Real sum = 0;
  for (std::size_t i = begin; i < end; ++i) sum += values[i];
  return sum;
}
}  // namespace

Real total_sorbed_kg(const WettingModel& m, const Contents& contents) {
  return sum_of(contents.sorbed_kg, 0, m.segments);
}
Real total_yarn_kg(const WettingModel& m, const Contents& contents) {
  return sum_of(contents.liquid_kg, 0, m.segments);
}
Real total_pore_kg(const WettingModel& m, const Contents& contents) {
  return sum_of(contents.liquid_kg, m.segments, m.nodes());
}

}  // namespace imbibe
