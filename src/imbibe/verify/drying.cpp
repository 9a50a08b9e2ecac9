// Evaporation: the constant-rate period, the wet bulb, and how a cloth dries out.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "imbibe/verify/families.h"
#include "imbibe/wetting/evaporation.h"

namespace imbibe::verify {
namespace {

// IAPWS-95's auxiliary equation for the saturation pressure (Wagner & Pruss 1993), Pa: independent of the model's formula.
Real iapws_pressure(Real temperature) {
  const Real t = 1 - temperature / 647.096;
  return 22.064e6 * std::exp(647.096 / temperature *
                             (-7.85951783 * t + 1.84408259 * std::pow(t, 1.5) - 11.7866497 * std::pow(t, 3) +
                              22.6807411 * std::pow(t, 3.5) - 15.9618719 * std::pow(t, 4) + 1.80122502 * std::pow(t, 7.5)));
}
Real iapws_density(Real temperature) { return iapws_pressure(temperature) / (461.52 * temperature); }

std::vector<std::string> wet(const std::string& fibre, const std::vector<std::string>& more) {
  std::vector<std::string> o{"textiles[0].warp.fibre=" + fibre, "textiles[0].weft.fibre=" + fibre, "textiles[0].start.yarns=0.6"};
  o.insert(o.end(), more.begin(), more.end());
  return o;
}

struct Drying {
  std::vector<Real> minutes, rate, water;  // g/(m2 h); g/m2
};
Drying dry(CaseRunner& runner, const std::vector<std::string>& overrides, World* last = nullptr) {
  Drying d;
  Real before = 0, time = 0;
  World w = runner.run("swatch", overrides, [&](const World& now, const StepReport&) {
    const Real area = now.textiles[0].model->area;
    const MassBalance b = mass_balance(now);
    if (now.time > time) {
      d.minutes.push_back(now.time / 60);
      d.rate.push_back(3.6e6 * (b.evaporated - before) / (now.time - time) / area);
      d.water.push_back(1e3 * (b.yarn + b.pore + b.sorbed) / area);
    }
    before = b.evaporated, time = now.time;
  });
  if (last) *last = std::move(w);
  return d;
}

CaseResult constant_rate(CaseRunner& runner) {
  CaseResult r;
  const Air air;
  const Real difference = 0.35 * iapws_density(air.temperature);
  r.checks.push_back(near("vapour density difference, isothermal", 1e3 * evaporation_rate(air, 1, air.temperature) / air.mass_transfer,
                          1e3 * difference, "g/m3", 0.005, "the model's Magnus form is within 0.3 % of IAPWS"));
  r.checks.push_back(near("the same against its published value", 1e3 * evaporation_rate(air, 1, air.temperature) / air.mass_transfer,
                          6.037, "g/m3", 0.001, "published with four digits"));
  Chart chart = chart_of("Drying of 60 % filled yarns in 65 % humidity", "time", "min", "rate", "g/(m² h)", {}, {});
  std::vector<Real> critical;
  for (const char* fibre : {"cotton", "wool_shrinkproof", "polyester"}) {
    World last;
    const Drying d = dry(runner, wet(fibre, {"duration=1 h", "output.every=60", "limits.max_step=10 s"}), &last);
    r.checks.push_back(near(fmt::format("{}: rate in the first two minutes", fibre), d.rate[1], 2 * 3.6e6 * air.mass_transfer * difference,
                            "g/(m2 h)", 0.01, "two faces; published: 218"));
    r.checks.push_back(at_most(fmt::format("{}: balance of the water", fibre), mass_balance(last).error(), 1e-10, "", "invariant"));
    std::size_t i = 0;
    while (i + 1 < d.rate.size() && d.rate[i] > 0.97 * d.rate[1]) ++i;
    critical.push_back(d.water[i]);
    r.notes.push_back(fmt::format("{}: the rate falls from {:.0f} min on, at {:.0f} g/m2 of water in all; nothing moves any more after {:.0f} min.", fibre,
                                  d.minutes[i], d.water[i],
                                  d.minutes[static_cast<std::size_t>(std::find_if(d.rate.begin(), d.rate.end() - 1, [&](Real x) { return x < 0.01 * d.rate[1]; }) - d.rate.begin())]));
    chart.x = d.minutes;
    chart.curves.push_back({fibre, d.rate, ""});
  }
  r.checks.push_back(at_least("critical content, wool over polyester", critical[1] / critical[2], 1.5, "1", "hygroscopic fibres leave the constant rate earlier"));
  r.checks.push_back(at_least("critical content, cotton over polyester", critical[0] / critical[2], 1.5, "1", "hygroscopic fibres leave the constant rate earlier"));
  // Fibres that take no water: the rate is constant to the last drop.
  const auto bare = [&](Real step) {
    const auto o = wet("polyester", {"textiles[0].wetting.network.sorption=none", "textiles[0].wetting.network.pores=false",
                                     "duration=1 h", "output.every=5", set("limits.max_step", step, "s")});
    const World start = runner.world("swatch", o);
    const MassBalance b = mass_balance(start);
    const Real whole = b.yarn / (2 * start.textiles[0].model->area * air.mass_transfer * difference);
    Real done = 0;
    runner.run("swatch", o, [&](const World& now, const StepReport&) {
      if (mass_balance(now).yarn > 0.005 * b.yarn) done = now.time;
    });
    return std::pair{done, whole};
  };
  const auto [done, whole] = bare(2);
  r.checks.push_back(near("polyester without sorption: time to dry to 0.5 %", done / 60, 0.995 * whole / 60, "min", 0.02,
                          "linear to the critical content; outputs every 5 s"));
  r.charts.push_back(chart);
  r.parameters = {{"air", "20 degC, 65 %, h_m = 5 mm/s, both faces"}, {"cloth", "24 x 24 /cm of 20 tex, yarns 60 % full, isothermal"}};
  return r;
}

CaseResult wet_bulb(CaseRunner& runner) {
  CaseResult r;
  const Air air;
  const Real t = wet_bulb_temperature(air);
  // Heat balance with IAPWS vapour: e(T_w) - phi e(T_a) = A p (T_a - T_w), A = 6.62e-4 1/K (WMO, ventilated Assmann).
  Real low = 273.15, high = air.temperature;
  for (int i = 0; i < 80; ++i) {
    const Real middle = 0.5 * (low + high);
    const Real excess = iapws_pressure(middle) - air.humidity * iapws_pressure(air.temperature) - 6.62e-4 * 101325 * (air.temperature - middle);
    (excess < 0 ? low : high) = middle;
  }
  const Real difference = iapws_density(low) - air.humidity * iapws_density(air.temperature);
  r.checks.push_back(within("wet-bulb temperature", t - 273.15, low - 273.15, "degC", 0.02, "formulas of vapour pressure"));
  r.checks.push_back(within("the same against its published value", t - 273.15, 15.84, "degC", 0.02, "two decimals published"));
  const auto o = wet("polyester", {"textiles[0].wetting.network.surface_temperature=wet_bulb", "duration=5 min", "output.every=60"});
  const Drying d = dry(runner, o);
  r.checks.push_back(near("rate of drying", d.rate[1], 2 * 3.6e6 * air.mass_transfer * difference, "g/(m2 h)", 0.01, "two faces, heat balance with IAPWS vapour"));
  r.checks.push_back(near("vapour density difference against the figure 2.224 g/m3", d.rate[1] / (2 * 3.6e3 * air.mass_transfer), 2.224, "g/m3", 0.02,
                          "the figure itself is off by 1.4 %, see below"));
  r.notes.push_back(fmt::format(
      "At 15.84 degC the vapour formulas of Magnus (Alduchov & Eskridge), Buck, Goff & Gratch and IAPWS all give 2.256-2.259 g/m3 "
      "(here {:.4f}), not 2.224; the psychrometer constant moves it by 0.3 % per per cent. 2.224 comes out when the rounded table value "
      "17.3 g/m3 is taken for saturated air of 20 degC (13.468 - 0.65 x 17.3 = 2.223): a small difference of large numbers, in which "
      "0.3 % of the air's vapour is 1.5 % of the result.", 1e3 * difference));
  r.parameters = {{"air", "20 degC, 65 %, h_m = 5 mm/s"}, {"psychrometer constant", "6.62e-4 1/K"}};
  return r;
}

}  // namespace

void add_drying(std::vector<Case>& cases) {
  const std::string family = "Drying";
  cases.push_back({"drying", family, "A wet cloth dries at a constant rate, then slower", "evaporation of partly filled yarns in still air",
                   "m = 2 A h_m (rho_sat(T) - phi rho_sat(T)) until the critical content", "mass transfer with Lewis' coefficient; IAPWS vapour pressure (Wagner & Pruss 1993)",
                   "isothermal, boundary layer thicker than a yarn", "wetting/evaporation.h", constant_rate});
  cases.push_back({"wet-bulb", family, "An evaporating surface at its wet bulb", "temperature and rate of a wet cloth in still air",
                   "e(T_w) - phi e(T_a) = 6.62e-4 p (T_a - T_w); m = A h_m (rho_sat(T_w) - phi rho_sat(T_a))", "psychrometer equation; IAPWS vapour pressure (Wagner & Pruss 1993)",
                   "ventilated wet bulb, adiabatic", "wetting/evaporation.h", wet_bulb});
}

}  // namespace imbibe::verify
