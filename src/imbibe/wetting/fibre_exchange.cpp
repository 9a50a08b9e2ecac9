#include "imbibe/wetting/fibre_exchange.h"

#include <algorithm>
#include <array>

#include "imbibe/core/parallel.h"
#include "imbibe/wetting/evaporation.h"
#include "imbibe/wetting/isotherm.h"
#include "imbibe/wetting/sorption.h"

namespace imbibe {
namespace {

constexpr std::size_t most_shells = 64;
constexpr Real free_water = 0.02;  // saturation from which a segment's face counts as wet

std::span<Real> shells_of(const WettingModel& m, Contents& contents, std::size_t s) {
  const auto n = static_cast<std::size_t>(m.shells.count);
  return {contents.shell_regain.data() + s * n, n};
}

// Mean regain of segment s after dt with its surface at `surface`, all fibres taking part.
Real regain_after(const WettingModel& m, Contents& contents, std::size_t s, Real surface, Real dt) {
  const YarnWetting& yarn = m.yarns[m.segment_type[s]];
  if (m.params.sorption == SorptionModel::shells) {
    std::array<Real, most_shells> next;
    const auto regain = shells_of(m, contents, s);
    const std::span<Real> result(next.data(), regain.size());
    advance_shells(m.shells, regain, surface, yarn.shell_rate * dt, result);
    return mean_regain(m.shells, result);
  }
  const Real regain = node_regain(m, contents, s);
  if (m.params.sorption == SorptionModel::as_printed) return printed_regain(regain, surface, yarn.shell_rate, dt);
  return regain + (surface - regain) * sorbed_share(yarn.sorption_rate, dt);
}

// Moves `share` of the way that a surface at `surface` would move the fibres in dt; `kg` is the mass that makes.
void commit(const WettingModel& m, Contents& contents, std::size_t s, Real surface, Real dt, Real share, Real kg) {
  contents.sorbed_kg[s] = std::max<Real>(0, contents.sorbed_kg[s] + kg);
  if (m.params.sorption != SorptionModel::shells) return;
  std::array<Real, most_shells> next;
  const auto regain = shells_of(m, contents, s);
  const std::span<Real> result(next.data(), regain.size());
  advance_shells(m.shells, regain, surface, m.yarns[m.segment_type[s]].shell_rate * dt, result);
  for (std::size_t i = 0; i < regain.size(); ++i) regain[i] += share * (result[i] - regain[i]);
}

bool sorbs_from_pores(const WettingModel& m, std::size_t s) {
  const YarnWetting& yarn = m.yarns[m.segment_type[s]];
  return m.volume(s) <= 0 && yarn.void_share <= 0 && yarn.cos_advancing > 0 && m.params.pores;
}

// A fibre as thick as its yarn, wetted by the pores beside it. One after the other: neighbours share pores.
void sorb_from_pores(const WettingModel& m, Contents& contents, std::size_t s, Real dt) {
  Real held = 0, wet = 0;
  const auto pores = m.pores_of_segment(s);
  for (const Index pore : pores) {
    held += contents.liquid_kg[pore];
    wet += wetted_fibres(contents.liquid_kg[pore] / (m.liquid.density * m.volume(pore)), m.params.wetted_at);
  }
  const YarnWetting& yarn = m.yarns[m.segment_type[s]];
  if (held <= 0 || node_regain(m, contents, s) >= yarn.swelling_regain) return;
  const Real share = wet / static_cast<Real>(pores.size());
  const Real full = m.dry_mass(s) * (regain_after(m, contents, s, yarn.swelling_regain, dt) -
                                     node_regain(m, contents, s));
  if (full <= 0) return;
  const Real kg = std::min(share * full, held);
  Real moved = 0;
  for (const Index pore : pores) {
    const Real part = std::min(contents.liquid_kg[pore], kg * (contents.liquid_kg[pore] / held));
    contents.liquid_kg[pore] -= part;
    moved += part;
  }
  commit(m, contents, s, yarn.swelling_regain, dt, moved / full, moved);
}

void sorb_from_yarn(const WettingModel& m, Contents& contents, std::size_t s, Real dt) {
  const Real held = contents.liquid_kg[s];
  const YarnWetting& yarn = m.yarns[m.segment_type[s]];
  if (held <= 0 || node_regain(m, contents, s) >= yarn.swelling_regain) return;
  const Real share = wetted_fibres(held / (m.liquid.density * m.volume(s)), m.params.wetted_at);
  const Real full = m.dry_mass(s) * (regain_after(m, contents, s, yarn.swelling_regain, dt) -
                                     node_regain(m, contents, s));
  if (full <= 0) return;
  const Real kg = std::min(share * full, held);
  contents.liquid_kg[s] = kg < held ? held - kg : 0;
  commit(m, contents, s, yarn.swelling_regain, dt, kg / full, kg);
}

// kg from the fibres of segment s to the air over dt.
Real vapour_from_fibres(const WettingModel& m, Contents& contents, std::size_t s, Real density, Real humidity,
                        const Air& air, Real dt) {
  const Fibre& fibre = m.fibres[m.segment_type[s]];
  FibreVapour step{.dry_mass = m.dry_mass(s), .regain = node_regain(m, contents, s),
                   .conductance = dt * m.vapour_area(s) * air.mass_transfer * density, .humidity = humidity,
                   .hysteresis = m.params.hysteresis};
  step.rest = regain_after(m, contents, s, 0, dt);
  step.gain = regain_after(m, contents, s, 1, dt) - step.rest;
  const FibreVapourResult result = fibre_vapour(fibre, step);
  if (result.given_kg == 0) return 0;
  const Real given = std::min(result.given_kg, contents.sorbed_kg[s]);
  const Real full = m.dry_mass(s) * (step.regain - step.rest - step.gain * result.surface_regain);
  commit(m, contents, s, result.surface_regain, dt, full != 0 ? given / full : 0, -given);
  return given;
}

// kg that `held` loses at `rate` kg/s in dt, and the time that was needed.
struct Drying {
  Real kg = 0, time = 0;
};
Drying dry(Real held, Real rate, Real dt) {
  if (held <= 0 || rate <= 0) return {};
  return rate * dt < held ? Drying{rate * dt, dt} : Drying{held, held / rate};
}

}  // namespace

void sorb_liquid(const WettingModel& m, Contents& contents, Real dt) {
  if (m.params.sorption == SorptionModel::none || m.params.model == TransportModel::as_printed || dt <= 0) return;
  parallel_for(m.segments, [&](std::size_t s) {
    if (m.volume(s) > 0) sorb_from_yarn(m, contents, s, dt);
  }, 1024);
  for (std::size_t s = 0; s < m.segments; ++s) {
    if (sorbs_from_pores(m, s)) sorb_from_pores(m, contents, s, dt);
  }
}

Real exchange_vapour(const WettingModel& m, Contents& contents, const Air& air, Real dt) {
  if (!m.params.evaporation || dt <= 0) return 0;
  const bool wet_bulb = m.params.surface_temperature == SurfaceTemperature::wet_bulb;
  const Real surface = wet_bulb ? wet_bulb_temperature(air) : air.temperature;
  const Real wet_rate = evaporation_rate(air, 1, surface);
  // Fibres without free water stand at the air's temperature.
  const Real density = saturated_vapour_density(air.temperature);
  const auto wet_share = [&](std::size_t s) {
    return m.volume(s) > 0 ? wetted_fibres(contents.liquid_kg[s] / (m.liquid.density * m.volume(s)), free_water) : 0;
  };
  const bool with_air = m.params.sorption == SorptionModel::linear || m.params.sorption == SorptionModel::shells;
  // A fibre in equilibrium with the air gives and takes nothing: most of a cloth that is dry.
  std::vector<Real> at_rest(m.fibres.size(), -1);
  if (m.params.sorption == SorptionModel::linear) {
    for (std::size_t i = 0; i < at_rest.size(); ++i) at_rest[i] = equilibrium_regain(m.fibres[i], air.humidity);
  }
  const auto rests = [&](std::size_t s) {
    const Real regain = at_rest[m.segment_type[s]];
    return std::abs(node_regain(m, contents, s) - regain) <= 1e-14 * regain;
  };
  // Pores first: they look at the segments' liquid as it was.
  Real total = parallel_sum(m.pores, [&](std::size_t begin, std::size_t end) {
    Real given = 0;
    for (std::size_t i = begin; i < end; ++i) {
      Real& held = contents.liquid_kg[m.segments + i];
      if (held <= 0) continue;
      Real wet = 0;
      const auto around = m.segments_of_pore(i);
      for (const Index s : around) wet += wet_share(s);
      const Real bare = around.empty() ? 1 : 1 - wet / static_cast<Real>(around.size());
      const Drying drying = dry(held, wet_rate * bare * m.vapour_area(m.segments + i), dt);
      held -= drying.kg;
      given += drying.kg;
    }
    return given;
  }, 1024);
  total += parallel_sum(m.segments, [&](std::size_t begin, std::size_t end) {
    Real given = 0;
    for (std::size_t s = begin; s < end; ++s) {
      Real& held = contents.liquid_kg[s];
      const Drying drying = dry(held, wet_rate * m.vapour_area(s), dt);
      held = drying.kg < held ? held - drying.kg : 0;
      given += drying.kg;
      if (with_air && drying.time < dt && !rests(s)) {
        given += vapour_from_fibres(m, contents, s, density, air.humidity, air, dt - drying.time);
      }
    }
    return given;
  }, 1024);
  return total;
}

}  // namespace imbibe
