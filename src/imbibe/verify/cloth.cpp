// Cloth without liquid: how a strip hangs, vibrates and bends, dry and wet.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "imbibe/verify/families.h"
#include "imbibe/verify/heavy_elastica.h"
#include "imbibe/verify/zero_crossings.h"

namespace imbibe::verify {
namespace {

constexpr Real g = 9.81, areal_mass = 0.2;
// Dense air takes the motion out of a strip that is to come to rest; it has no part in the shape of rest.
// Falling it goes at some 0.2 m/s.
const std::string settling = "textiles[0].sheet.soft.cloth.air.density=10";

const Sheet& sheet_of(const World& world) { return world.cell_cloths[0].soft.sheet; }
Sheet& sheet_of(World& world) { return world.cell_cloths[0].soft.sheet; }

// ---- hanging between two supports --------------------------------------------------------------------------------

// Parameter a of z = a cosh(x/a) for a span of 1 and a length of 1.2: 2 a sinh(1/(2a)) = 1.2.
Real catenary_parameter() {
  Real low = 0.1, high = 10;
  for (int k = 0; k < 200; ++k) {
    const Real a = 0.5 * (low + high);
    (2 * a * std::sinh(0.5 / a) > 1.2 ? low : high) = a;
  }
  return 0.5 * (low + high);
}

struct Hanging {
  Real sag = 0;
  std::vector<Real> x, z;
  World world;
};
Hanging hang(CaseRunner& runner, Index columns) {
  Hanging h;
  h.world = runner.run("strip", {"textiles[0].size=[1.2 m, 20 mm]", fmt::format("textiles[0].sheet.soft.columns={}", columns), settling, "duration=12 s",
                                 "textiles[0].sheet.soft.pins=[{edge: left, motion: [{time: 0, displacement: [0, 0, 0]}, {time: 0.5, displacement: [0.1, 0, 0]}]}, "
                                 "{edge: right, motion: [{time: 0, displacement: [0, 0, 0]}, {time: 0.5, displacement: [-0.1, 0, 0]}]}]"});
  const Sheet& sheet = sheet_of(h.world);
  for (Index i = 0; i < columns; ++i) {
    h.x.push_back(sheet.position[i].x), h.z.push_back(sheet.position[i].z);
    h.sag = std::max(h.sag, -sheet.position[i].z);
  }
  return h;
}

CaseResult catenary(CaseRunner& runner) {
  CaseResult r;
  const Real a = catenary_parameter(), sag = a * (std::cosh(0.5 / a) - 1);
  std::vector<Convergence::Row> rows;
  Real coarser = 0;
  for (const Index columns : runner.form(std::vector<Index>{31, 61}, std::vector<Index>{31, 61, 121})) {
    const Hanging h = hang(runner, columns);
    r.checks.push_back(near(fmt::format("sag, {} nodes along the strip", columns), h.sag, sag, "m", 0.01, "project's goal"));
    if (coarser > 0) r.checks.push_back(near(fmt::format("sag, {} nodes against half as many", columns), h.sag, coarser, "m", 0.02, "project's goal"));
    coarser = h.sag;
    rows.push_back({1.2 / (columns - 1), std::abs(h.sag / sag - 1)});
    std::vector<Real> exact;
    for (const Real x : h.x) exact.push_back(a * (std::cosh(x / a) - std::cosh(0.5 / a)));
    r.charts = {chart_of("A strip between two supports", "x", "m", "height", "m", h.x, {{"strip", h.z, ""}, {"catenary", exact, ""}})};
    runner.picture(r, h.world, runner.scene("strip"), "At rest");
  }
  r.convergence.push_back(convergence_of("sag", "distance of nodes [m]", rows));
  r.parameters = {{"span, length", "1 m, 1.2 m"}, {"stretch stiffness", "1e6 N/m"}, {"bending stiffness", "1e-9 N m"}};
  return r;
}

// ---- frequencies -------------------------------------------------------------------------------------------------

constexpr Real stiffness = 200, strain = 0.02;  // N/m; of the string

// The strip stretched between two supports and pulled aside in its first mode, `saturation` of its cells' capacity in it.
Real string_frequency(CaseRunner& runner, Real saturation, Chart* chart) {
  const std::vector<std::string> o{set("textiles[0].sheet.soft.cloth.hand.stretch_weft", stiffness), "gravity=[0, 0, 0]", set("duration", runner.form(2.0, 4.0), "s"),
                                   "textiles[0].sheet.soft.pins=[{edge: left}, {edge: right}]"};
  World world = runner.world("strip", o);
  CellCloth& cloth = world.cell_cloths[0];
  Sheet& sheet = cloth.soft.sheet;
  for (std::size_t i = 0; i < sheet.size(); ++i) {
    sheet.position[i].x = (1 + strain) * (sheet.u[i] - 0.5);
    sheet.position[i].z = 2e-3 * std::sin(pi * sheet.u[i]);
  }
  for (Pin& pin : sheet.pins) sheet.position[pin.node].z = pin.anchor.z, pin.anchor = sheet.position[pin.node];
  for (std::size_t c = 0; saturation > 0 && c < cloth.grid->cells(); ++c) {
    const Vec3 at = cloth.grid->centre(c);
    add_parcel(*cloth.grid, cloth.contents, at.x, at.y, saturation * cloth.grid->capacity(c));
  }
  weigh(cloth);
  world.ledger.initial_kg = cell_kg(cloth);
  ZeroCrossings zero;
  std::vector<Real> time, height;
  runner.run(world, runner.scene("strip", o), {}, [&](const World& now, const StepReport&) {
    const Real z = sheet_of(now).position[20].z;
    zero.add(now.time, z);
    if (now.time < 2) time.push_back(now.time), height.push_back(1e3 * z);
  });
  if (chart) {
    std::vector<Real> exact;
    const Real f = std::sqrt(stiffness * strain / (areal_mass / (1 + strain))) / (2 * (1 + strain));
    for (const Real t : time) exact.push_back(2 * std::cos(2 * pi * f * t));
    *chart = chart_of("A stretched strip, in its middle", "time", "s", "height", "mm", time, {{"strip", height, ""}, {"string", exact, ""}});
  }
  return zero.frequency();
}

CaseResult string(CaseRunner& runner) {
  CaseResult r;
  Chart chart;
  const Real expected = std::sqrt(stiffness * strain / (areal_mass / (1 + strain))) / (2 * (1 + strain));
  r.checks.push_back(near("first frequency", string_frequency(runner, 0, &chart), expected, "Hz", 0.01, "project's goal"));
  r.charts.push_back(chart);
  r.notes.push_back("The strip is put into its first mode, 2 mm high, by hand; the command starts it flat.");
  r.parameters = {{"tension", fmt::format("{} N/m", stiffness * strain)}, {"length", "1.02 m, 2 % above its own"}};
  return r;
}

CaseResult wet_string(CaseRunner& runner) {
  CaseResult r;
  const Real dry = string_frequency(runner, 0, nullptr);
  for (const Real saturation : {0.25, 1.0}) {
    const Real part = 2 * saturation;  // capacity_ratio 2: kg of water per kg of cloth
    r.checks.push_back(near(fmt::format("frequency with {} g of water per g of cloth, of the dry one", part), string_frequency(runner, saturation, nullptr) / dry, std::sqrt(1 / (1 + part)), "1", 0.01, "project's goal"));
  }
  r.notes.push_back("Put into its first mode by hand, with the same saturation in all cells; the command starts it flat and dry.");
  return r;
}

CaseResult chain(CaseRunner& runner) {
  CaseResult r;
  constexpr Real j01 = 2.404825557695773;  // first zero of J0
  const std::vector<std::string> o{"textiles[0].weft_direction=[0, 0, -1]", "textiles[0].warp_direction=[0, 1, 0]", "textiles[0].sheet.soft.columns=51", set("duration", runner.form(4.0, 8.0), "s")};
  World world = runner.world("strip", o);
  Sheet& sheet = sheet_of(world);
  for (std::size_t i = 0; i < sheet.size(); ++i) sheet.position[i].x = 0.005 * std::cyl_bessel_j(0, j01 * std::sqrt(std::max(0.0, 1 - sheet.u[i])));
  for (const Pin& pin : sheet.pins) sheet.position[pin.node].x = pin.anchor.x;
  ZeroCrossings zero;
  std::vector<Real> time, aside, exact;
  const Real expected = j01 / (4 * pi) * std::sqrt(g);
  runner.run(world, runner.scene("strip", o), {}, [&](const World& now, const StepReport&) {
    const Real x = sheet_of(now).position[50].x;
    zero.add(now.time, x);
    time.push_back(now.time), aside.push_back(1e3 * x), exact.push_back(5 * std::cos(2 * pi * expected * now.time));
  });
  r.checks.push_back(near("first frequency", zero.frequency(), expected, "Hz", 0.01, "project's goal"));
  r.charts.push_back(chart_of("A hanging strip, its free end", "time", "s", "aside", "mm", time, {{"strip", aside, ""}, {"chain", exact, ""}}));
  r.notes.push_back("The strip is put into its first mode, 5 mm wide, by hand; the command starts it straight.");
  r.parameters = {{"length", "1 m"}};
  return r;
}

// ---- bending -----------------------------------------------------------------------------------------------------

CaseResult elastica(CaseRunner& runner) {
  CaseResult r;
  constexpr Real bending = 2e-5;  // N m
  constexpr Index columns = 42;
  for (const Real free_length : {0.04, 0.08}) {
    // The clamp holds the first two columns: the cloth is free from the middle between them on.
    const Real length = free_length / (1 - 0.5 / (columns - 1)), edge = length / (columns - 1);
    const World world = runner.run("strip", {fmt::format("textiles[0].size=[{:.12g} m, 20 mm]", length), fmt::format("textiles[0].sheet.soft.columns={}", columns), settling,
                                             "duration=6 s", "textiles[0].sheet.soft.cloth.strain_error=1e-3", "textiles[0].sheet.soft.cloth.hand.stretch_weft=1e4",
                                             "textiles[0].sheet.soft.cloth.hand.stretch_warp=1e4", set("textiles[0].sheet.soft.cloth.hand.bending_weft", bending),
                                             set("textiles[0].sheet.soft.cloth.hand.bending_warp", bending),
                                             fmt::format("textiles[0].sheet.soft.pins=[{{edge: left}}, {{point: [{0:.9g} m, 0 m]}}, {{point: [{0:.9g} m, 0.02 m]}}]", edge)});
    const Sheet& sheet = sheet_of(world);
    const ElasticaTip tip = heavy_elastica(free_length, areal_mass * g / bending);
    const Vec3 end = sheet.position[columns - 1], start = sheet.position[0];
    const std::string name = fmt::format("{:g} mm: ", 1e3 * free_length);
    r.checks.push_back(near(name + "drop of the free end", 1e3 * (start.z - end.z), 1e3 * tip.drop, "mm", 0.03, "project's goal"));
    r.checks.push_back(within(name + "reach of the free end", 1e3 * (end.x - start.x - 0.5 * edge), 1e3 * tip.reach, "mm", 0.03e3 * free_length, "project's goal, of the length"));
  }
  r.parameters = {{"bending stiffness", "2e-5 N m"}, {"weight", "200 g/m2"}};
  return r;
}

}  // namespace

void add_cloth(std::vector<Case>& cases) {
  const std::string family = "Cloth";
  cases.push_back({"catenary", family, "A strip between two supports hangs as a catenary", "sag of a strip longer than the span", "2a sinh(1/2a) = 1.2, sag = a (cosh(1/2a) - 1) = .292344 m",
                   "classical (Leibniz, Huygens, Bernoulli 1691)", "next to no stretch and bending", "cloth/cloth_step.h cloth/threads.h", catenary});
  cases.push_back({"string", family, "A stretched strip vibrates as a string", "first frequency", "f = sqrt(T/mu)/(2 L)", "classical (Mersenne, d'Alembert)", "no weight, no air, small amplitude",
                   "cloth/cloth_step.h cloth/threads.h", string});
  cases.push_back({"wet-string", family, "Water lowers the frequency by the root of the masses", "first frequency, wet over dry", "sqrt(m/(m + dm))", "inertia", "water moves with its node",
                   "coupling/cell_cloth.h cloth/cloth_step.h", wet_string});
  cases.push_back({"hanging-chain", family, "A hanging strip swings as a hanging chain", "first frequency", "f = j01/(4 pi) sqrt(g/L)", "D. Bernoulli 1738; j01 = 2.404826 first zero of J0",
                   "no stretch, no bending, no air", "cloth/cloth_step.h cloth/threads.h", chain});
  cases.push_back({"elastica", family, "A clamped strip droops as a heavy elastica", "drop and reach of the free end", "B theta'' = -w (L - s) cos(theta), theta(0) = 0, theta'(L) = 0",
                   "Euler's elastica with weight, by shooting (also: Peirce, J. Text. Inst. 21 (1930) T377, the cantilever test)", "no stretch, no twist", "cloth/elastic.h cloth/cloth_step.h", elastica});
}

}  // namespace imbibe::verify
