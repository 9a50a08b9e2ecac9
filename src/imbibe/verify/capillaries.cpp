// Capillary tubes: rise to Jurin's height, level filling by Washburn, rise in time by Fries and Dreyer, entry.
#include <fmt/format.h>

#include <cmath>

#include "imbibe/verify/families.h"
#include "imbibe/wetting/capillary.h"

namespace imbibe::verify {
namespace {

constexpr Real gravity = 9.81;

// The only pore of the scene.
struct Tube {
  Real throat = 0, length = 0, volume = 0;
  LiquidKind water;
  // The model lets a pore with the volume V fill at the rate of a tube with its throat's section: its clock runs slower
  // than that tube's by this factor.
  Real slower() const { return volume / (pi * throat * throat * length); }
};
Tube tube_of(const World& world) {
  const WettingModel& m = *world.textiles[0].model;
  return {m.pore_throat(0), m.thickness, m.volume(m.segments), world.liquid.kind};
}
Real height(const World& world) {
  const Textile& t = world.textiles[0];
  return saturation(*t.model, t.contents, t.model->segments) * t.model->thickness;
}

CaseResult jurin(CaseRunner& runner) {
  CaseResult r;
  const Real radius = 0.2e-3;
  for (const Real angle : {0.0, 60.0}) {
    const World w = runner.run("jurin", {set("textiles[0].contact_angle", angle, "deg")});
    const Tube tube = tube_of(w);
    r.checks.push_back(near("throat radius of the pore", tube.throat * 1e3, 0.2, "mm", 1e-6, "the scene's geometry"));
    r.checks.push_back(near(fmt::format("height at rest, {:g} deg", angle), height(w) * 1e3,
                            1e3 * jurin_height(tube.water.surface_tension, std::cos(radians(angle)), radius,
                                                 tube.water.density, gravity), "mm", 0.01,
                            "one node per tube: its law is exact, 1 % covers the step in time"));
  }
  // Above 90 degrees the level in the tube is pressed below the outer one; here: no entry without pressure.
  const World w = runner.run("jurin", {"textiles[0].contact_angle=110 deg"});
  r.checks.push_back(at_most("height at rest, 110 deg, without pressure", height(w) * 1e3, 0, "mm",
                             "a tube that repels water stays empty"));
  r.parameters = {{"radius", "0.2 mm"}, {"liquid", "water of the library: 998.2 kg/m3, 1.002 mPa s, 72.75 mN/m"}};
  r.checks.push_back(near("closed form for 72.8 mN/m against its published value",
                          1e3 * jurin_height(0.0728, 1, radius, 998.2, gravity), 74.34, "mm", 1e-4, "four digits"));
  return r;
}

// Heights at the outputs of one run.
struct Rise {
  std::vector<Real> time, height;
};
Rise rise(CaseRunner& runner, const std::vector<std::string>& overrides, Tube& tube) {
  Rise rise;
  runner.run("upright_tube", overrides, [&](const World& w, const StepReport&) {
    tube = tube_of(w);
    rise.time.push_back(w.time / tube.slower()), rise.height.push_back(height(w));
  });
  return rise;
}

CaseResult tube_in_time(CaseRunner& runner, bool upright) {
  CaseResult r;
  Tube tube;
  rise(runner, {"duration=1 ms", "output.every=1 ms"}, tube);
  const Real radius = 0.1e-3, scale = tube.slower();
  const std::vector<std::string> base{upright ? "gravity=[0, 0, -9.81]" : "gravity=[0, 0, 0]"};
  const auto height_at = [&](Real time, Real step) {
    std::vector<std::string> o = base;
    o.push_back(set("duration", time * scale, "s"));
    o.push_back(set("output.every", time * scale, "s"));
    if (step > 0) o.push_back(set("limits.max_step", step * scale, "s"));
    return rise(runner, o, tube).height.back();
  };
  const auto reference = [&](Real time) {
    const LiquidKind& k = tube.water;
    return tube_rise(k.surface_tension, 1, radius, k.density, k.viscosity, upright ? gravity : 0, time);
  };
  for (const Real time : upright ? std::vector<Real>{0.1, 1, 10} : std::vector<Real>{0.1, 1})
    r.checks.push_back(near(fmt::format("height after {:g} s", time), 1e3 * height_at(time, 0), 1e3 * reference(time), "mm",
                            0.01, "what the tube model promises (capillary.h)"));
  if (upright) {
    // Published figures of the closed form itself.
    const std::pair<Real, Real> published[] = {{0.1, 18.254}, {1, 52.419}, {10, 119.398}};
    for (const auto& [time, h] : published)
      r.checks.push_back(near(fmt::format("closed form after {:g} s against its published value", time),
                              1e3 * tube_rise(0.0728, 1, radius, 998.2, 1.002e-3, gravity, time), h, "mm", 1e-4, "the table has five digits"));
  }
  std::vector<Convergence::Row> rows;
  for (const int steps : {100, 200, 400, 800})
    rows.push_back({1e3 / steps, height_at(1, 1.0 / steps) / reference(1) - 1});
  r.convergence.push_back(convergence_of("height after 1 s (relative)", "longest step [ms]", rows));
  // A level tube is integrated exactly over any step: x dx/dt is constant.
  if (upright)
    r.checks.push_back(at_least("observed order in time", r.convergence[0].order, 0.8, "",
                                "backward Euler: order 1, less a logarithm for the start with the root of time"));

  Rise curve = rise(runner, {base[0], set("duration", 2 * scale, "s"), set("output.every", 0.05 * scale, "s")}, tube);
  std::vector<Real> theory;
  for (const Real t : curve.time) theory.push_back(1e3 * reference(t));
  for (Real& h : curve.height) h *= 1e3;
  r.charts.push_back(chart_of(upright ? "Rise in an upright tube" : "Filling of a level tube", "time", "s", "height", "mm",
                              curve.time, {{"solver", curve.height, ""}, {"closed form", theory, ""}}));
  r.parameters = {{"radius", "0.1 mm"}, {"angle", "0 deg"}, {"liquid", "water of the library: 998.2 kg/m3, 1.002 mPa s, 72.75 mN/m"}};
  r.notes.push_back(fmt::format(
      "The tube is a pore between four threads. The model fills a pore at the rate of a tube with its throat, while its "
      "volume is that of the opening; times are divided by the ratio of the two, {:.4f}.", scale));
  return r;
}

CaseResult washburn(CaseRunner& runner) { return tube_in_time(runner, false); }
CaseResult fries_dreyer(CaseRunner& runner) { return tube_in_time(runner, true); }

CaseResult breakthrough(CaseRunner& runner) {
  CaseResult r;
  const std::vector<std::string> base{"textiles[0].contact_angle=110 deg", "duration=10 ms", "output.every=10 ms"};
  const World world = runner.world("upright_tube", base);
  const Real wanted = world.textiles[0].model->pore_breakthrough(0);
  const auto taken = [&](Real share) {
    auto o = base;
    o.push_back(set("textiles[0].reservoirs[0].pressure", share * wanted, "Pa"));
    return height(runner.run("upright_tube", o));
  };
  r.checks.push_back(at_most("height at 0.99 of the breakthrough pressure", 1e3 * taken(0.99), 0, "mm", "exactly nothing"));
  r.checks.push_back(at_least("height at 1.01 of the breakthrough pressure", 1e3 * taken(1.01), 1e-3, "mm", "it enters"));
  // max over phi of the two-cylinder meniscus, by a fine search of its own.
  const Real b = 0.5 * 0.2e-3, tension = world.liquid.kind.surface_tension, thread = 0.002e-3, angle = radians(110);
  Real most = 0;
  for (int i = 0; i <= 200000; ++i) {
    const Real phi = pi * i / 200000;
    const Real lift = thread * (1 - std::sin(phi));
    most = std::max(most, tension * std::sin(angle + phi - pi) * 2 / (b + lift));
  }
  r.checks.push_back(near("breakthrough pressure", wanted, most, "Pa", 1e-3, "both search the same maximum"));
  r.parameters = {{"angle", "110 deg"}, {"threads", "0.004 mm, 0.204 mm apart"}};
  return r;
}

}  // namespace

void add_capillaries(std::vector<Case>& cases) {
  const std::string family = "Capillary entry";
  cases.push_back({"jurin", family, "Capillary rise ends at Jurin's height",
                   "equilibrium height of water in an upright tube that stands on a free level",
                   "h = 2 gamma cos(theta) / (rho g r)", "Jurin 1718", "sharp meniscus, no evaporation",
                   "wetting/capillary.h wetting/entry.h", jurin});
  cases.push_back({"washburn", family, "A level tube fills by Lucas and Washburn", "filled length against time without gravity",
                   "h^2 = gamma r cos(theta) t / (2 eta)", "Lucas 1918; Washburn, Phys. Rev. 17 (1921) 273",
                   "laminar, no inertia, no dynamic angle", "wetting/capillary.h wetting/transport.h", washburn});
  cases.push_back({"fries-dreyer", family, "An upright tube fills by Fries and Dreyer",
                   "height against time with gravity",
                   "h = (a/b)[1 + W0(-exp(-1 - b^2 t/a))], a = gamma r cos(theta)/(4 eta), b = rho g r^2/(8 eta)",
                   "Fries & Dreyer, J. Colloid Interface Sci. 320 (2008) 259, eq. 16", "laminar, no inertia",
                   "wetting/capillary.h wetting/transport.h", fries_dreyer});
  cases.push_back({"breakthrough", family, "A pore that repels water opens at the greatest meniscus pressure",
                   "height reached just below and just above the breakthrough pressure",
                   "max over phi of gamma sin(theta + phi - pi)[1/(b_x + r(1 - sin phi)) + 1/(b_y + r(1 - sin phi))]",
                   "two-cylinder meniscus, derived (wetting/entry.h)", "round threads, quasi-static",
                   "wetting/entry.h", breakthrough});
}

}  // namespace imbibe::verify
