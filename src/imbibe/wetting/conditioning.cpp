#include "imbibe/wetting/conditioning.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "imbibe/core/error.h"
#include "imbibe/wetting/isotherm.h"

namespace imbibe {
namespace {

struct DryFibres {
  std::vector<Real> mass;  // kg, per yarn type
  Real total = 0;
};

DryFibres dry_fibres(const WettingModel& m) {
  DryFibres dry;
  dry.mass.assign(m.fibres.size(), 0);
  for (std::size_t s = 0; s < m.segments; ++s) dry.mass[m.segment_type[s]] += m.dry_mass(s);
  for (const Real kg : dry.mass) dry.total += kg;
  return dry;
}

Real mean_regain(const WettingModel& m, const DryFibres& dry, Real humidity) {
  Real water = 0;
  for (std::size_t f = 0; f < dry.mass.size(); ++f)
    if (dry.mass[f] > 0) water += dry.mass[f] * equilibrium_regain(m.fibres[f], humidity);
  return dry.total > 0 ? water / dry.total : 0;
}

bool touches_liquid(const WettingModel& m, const Contents& contents, std::size_t s) {
  if (contents.liquid_kg[s] > 0) return true;
  if (m.volume(s) > 0) return false;
  const auto pores = m.pores_of_segment(s);
  return std::any_of(pores.begin(), pores.end(), [&](Index pore) { return contents.liquid_kg[pore] > 0; });
}

}  // namespace

Real regain_in_balance(const WettingModel& m, Real humidity) { return mean_regain(m, dry_fibres(m), humidity); }

Real humidity_in_balance(const WettingModel& m, Real regain) {
  const DryFibres dry = dry_fibres(m);
  const Real most = mean_regain(m, dry, 1);
  if (regain > most)
    throw InputError({Problem{.key = "regain", .message = fmt::format("{:.4g} % is more than these fibres take up from "
                                                                      "saturated air: {:.4g} %", 100 * regain, 100 * most)}});
  Real low = 0, high = 1;
  for (int i = 0; i < 53; ++i) {  // all that a double can tell apart
    const Real middle = 0.5 * (low + high);
    (mean_regain(m, dry, middle) < regain ? low : high) = middle;
  }
  return high;
}

Real condition_dry_fibres(const WettingModel& m, Contents& contents, Real humidity) {
  std::vector<Real> regain;
  for (const Fibre& fibre : m.fibres) regain.push_back(equilibrium_regain(fibre, humidity));
  const auto shells = static_cast<std::size_t>(m.shells.count);
  Real from_air = 0;
  for (std::size_t s = 0; s < m.segments; ++s) {
    if (touches_liquid(m, contents, s)) continue;
    const Real w = regain[m.segment_type[s]], kg = m.dry_mass(s) * w;
    from_air += kg - contents.sorbed_kg[s];
    contents.sorbed_kg[s] = kg;
    if (!contents.shell_regain.empty())
      std::fill_n(contents.shell_regain.begin() + static_cast<std::ptrdiff_t>(s * shells), shells, w);
  }
  return from_air;
}

}  // namespace imbibe
