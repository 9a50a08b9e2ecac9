// Properties of the network solver that hold whatever the parameters: maximum principle, mass, agreement with a dense
// solution of the same equations.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "imbibe/core/random.h"
#include "imbibe/verify/families.h"
#include "imbibe/wetting/along_yarn.h"

namespace imbibe::verify {
namespace {

// A third of the nodes dry, the rest anywhere up to the top of the over-full range.
void randomise(World& w, std::uint64_t seed, Real most) {
  Textile& t = w.textiles[0];
  const WettingModel& m = *t.model;
  for (std::size_t i = 0; i < m.nodes(); ++i) {
    const Real u = uniform({.seed = seed, .id = i}), v = uniform({.seed = seed, .id = i}, 1);
    t.contents.liquid_kg[i] = (u < 0.33 ? 0 : v * (1 + most * m.overfill(i))) * m.liquid.density * m.volume(i);
  }
}

Real water(const Contents& c) {
  Real sum = 0;
  for (const Real kg : c.liquid_kg) sum += kg;
  return sum;
}

CaseResult maximum_principle(CaseRunner& runner) {
  CaseResult r;
  struct Variant {
    const char *name, *model;
    Real crossing;
    bool pores;
  };
  const Variant variants[] = {{"along yarns alone", "physical", 0, false},   {"along and crossing", "physical", 3, false},
                              {"along and pores", "physical", 0, true},      {"along, crossing and pores", "physical", 3, true},
                              {"Kuenzel along", "kunzel", 0, false},         {"Kuenzel along and crossing", "kunzel", 3, false}};
  const int states = runner.form(100, 1000);
  for (const Variant& v : variants) {
    World w = runner.world("swatch", {"textiles[0].wetting.network.model=" + std::string(v.model), set("textiles[0].wetting.network.crossing_factor", v.crossing),
                                      fmt::format("textiles[0].wetting.network.pores={}", v.pores), "textiles[0].wetting.network.evaporation=false",
                                      "textiles[0].wetting.network.sorption=none", "textiles[0].wetting.network.swelling=false", "textiles[0].wetting.network.residual=1e-9",
                                      "textiles[0].size=[2 mm, 2 mm]"});
    Textile& t = w.textiles[0];
    const WettingModel& m = *t.model;
    Real mass = 0, over = 0, below = 0;
    int unfinished = 0;
    WettingScratch scratch;
    for (int k = 0; k < states; ++k) {
      const auto seed = static_cast<std::uint64_t>(k + 1);
      randomise(w, seed, 0.5);
      const Real step = std::pow(10.0, -6 + 9.5563 * uniform({.seed = seed, .id = 1u << 20}));  // 1 us to 1 h
      const auto extremes = [&] {
        Real low = 1e300, high = -1e300;
        for (std::size_t i = 0; i < m.nodes(); ++i) {
          if (m.volume(i) <= 0) continue;
          const Real p = node_pressure(m, t.contents, i);
          low = std::min(low, p), high = std::max(high, p);
        }
        return std::pair{low, high};
      };
      const auto [low, high] = extremes();
      const Real before = water(t.contents);
      const WettingReport report = step_wetting(m, t.contents, {}, {}, w.air, {}, step, scratch);
      unfinished += !report.converged;
      Real released = 0;
      for (const auto& one : report.released) released += one.kg;
      mass = std::max(mass, std::abs(water(t.contents) + released - before) / before);
      const auto [low_after, high_after] = extremes();
      over = std::max(over, high_after - high), below = std::max(below, low - low_after);
    }
    const std::string name = std::string(v.name) + ": ";
    r.checks.push_back(at_most(name + "error of mass in any state", mass, 1e-12, "", "masses move by edge flows only"));
    r.checks.push_back(at_most(name + "pressure above the highest before", over, 1, "Pa", "residual tolerance of 1e-9 in saturation, suctions of 20 kPa"));
    r.checks.push_back(at_most(name + "pressure below the lowest before, relative", below > 0 ? 1 : 0, 0, "", "the driest node gains water"));
    r.checks.push_back(at_most(name + "steps not finished", unfinished, 0, "", "any state, any step"));
  }
  r.parameters = {{"states", fmt::format("{} per variant, a third of the nodes dry, others up to bulging", states)}, {"steps", "1 us to 1 h, spread evenly in the logarithm"}};
  return r;
}

// One step of backward Euler on a dense matrix: V (s - s0) + dt sum_j T (Psi(s_i) - Psi(s_j)) = 0 by Newton and Gauss.
std::vector<Real> dense_step(const WettingModel& m, const std::vector<Real>& start, Real dt) {
  const std::size_t n = m.segments;
  std::vector<Real> s = start;
  const auto psi = [&](std::size_t i, Real x) {
    const Sloped p = pressure_at(retention_of(m.at(i)), x);
    const Sloped k = kirchhoff_potential(m.entry(i), m.size_index(i), p.value);
    return Sloped{k.value, k.slope * p.slope};
  };
  for (int newton = 0; newton < 400; ++newton) {
    std::vector<Real> a(n * n, 0), residual(n);
    for (std::size_t i = 0; i < n; ++i) residual[i] = m.volume(i) * (s[i] - start[i]), a[i * n + i] = m.volume(i);
    for (Index i = 0; i < n; ++i)
      for (Index k = m.row_start[i]; k < m.row_start[i + 1]; ++k) {
        const Index j = m.row_other[k];
        if (j < i || j >= n) continue;  // once a link; the pores behind the segments are shut and no unknowns
        const Sloped x = psi(i, s[i]), y = psi(j, s[j]);
        const Real conductance = m.links[m.row_link[k]].conductance, flow = dt * conductance * (x.value - y.value);
        residual[i] += flow, residual[j] -= flow;
        a[i * n + i] += dt * conductance * x.slope, a[i * n + j] -= dt * conductance * y.slope;
        a[j * n + j] += dt * conductance * y.slope, a[j * n + i] -= dt * conductance * x.slope;
      }
    Real worst = 0;
    for (std::size_t i = 0; i < n; ++i) worst = std::max(worst, std::abs(residual[i]) / m.volume(i));
    if (worst < 1e-14) break;
    for (std::size_t c = 0; c < n; ++c) {  // diagonally dominant by columns: no pivots needed
      for (std::size_t row = c + 1; row < n; ++row) {
        const Real f = a[row * n + c] / a[c * n + c];
        if (f == 0) continue;
        for (std::size_t k = c; k < n; ++k) a[row * n + k] -= f * a[c * n + k];
        residual[row] -= f * residual[c];
      }
    }
    for (std::size_t c = n; c-- > 0;) {
      for (std::size_t k = c + 1; k < n; ++k) residual[c] -= a[c * n + k] * residual[k];
      residual[c] /= a[c * n + c];
    }
    for (std::size_t i = 0; i < n; ++i) {
      Real next = s[i] - std::clamp<Real>(residual[i], -0.1, 0.1);
      if ((s[i] < 1) != (next < 1)) next = s[i] < 1 ? 1 + 1e-4 : 1 - 1e-4;  // halt at the kink of p(s)
      if (std::abs(residual[i]) < 1e-3) next = s[i] - residual[i];
      s[i] = std::max(next, 0.1 * s[i]);
    }
  }
  return s;
}

CaseResult dense(CaseRunner& runner) {
  CaseResult r;
  Real worst = 0;
  int compared = 0;
  const int networks = runner.form(12, 60);
  for (int k = 0; k < networks; ++k) {
    const auto seed = static_cast<std::uint64_t>(1000 + k);
    const auto draw = [&](std::uint64_t id, Real low, Real high) { return low + (high - low) * uniform({.seed = seed, .id = id}); };
    const char* fibres[] = {"cotton", "wool_shrinkproof", "polyester", "viscose"};
    const std::string fibre = fibres[k % 4];
    const std::vector<std::string> o{"textiles[0].warp.fibre=" + fibre, "textiles[0].weft.fibre=" + fibre,
                                     fmt::format("textiles[0].warp.density={:.3f} /cm", draw(1, 12, 25)), fmt::format("textiles[0].weft.density={:.3f} /cm", draw(2, 12, 25)),
                                     set("textiles[0].wetting.network.crossing_factor", draw(3, 0, 10)), fmt::format("textiles[0].size=[{:.2f} mm, {:.2f} mm]", draw(4, 1.5, 3), draw(5, 1.5, 3)),
                                     "textiles[0].wetting.network.pores=false", "textiles[0].wetting.network.evaporation=false",
                                     "textiles[0].wetting.network.sorption=none", "textiles[0].wetting.network.swelling=false",
                                     "textiles[0].wetting.network.residual=1e-9"};
    World w = runner.world("swatch", o);
    Textile& t = w.textiles[0];
    const WettingModel& m = *t.model;
    randomise(w, seed, 0);
    std::vector<Real> start(m.segments);
    for (std::size_t i = 0; i < m.segments; ++i) {
      start[i] = std::max(0.01, saturation(m, t.contents, i));
      t.contents.liquid_kg[i] = start[i] * m.liquid.density * m.volume(i);
    }
    const Real dt = std::pow(10.0, draw(6, -4, 0));
    const WettingReport report = step_wetting(m, t.contents, {}, {}, w.air, {}, dt);
    if (!report.converged || report.substeps != 1) continue;  // cut steps are another equation
    const std::vector<Real> wanted = dense_step(m, start, dt);
    for (std::size_t i = 0; i < m.segments; ++i) worst = std::max(worst, std::abs(saturation(m, t.contents, i) - wanted[i]));
    ++compared;
  }
  r.checks.push_back(at_most("largest difference of a saturation", worst, 1e-6, "1", "solver's residual 1e-9 of a node's volume, in parts of it"));
  r.checks.push_back(at_least("networks compared", compared, 0.7 * networks, "", "steps that the solver took in one piece"));
  r.parameters = {{"networks", fmt::format("{}, of random densities, sizes and crossings, four fibres; steps of 0.1 ms to 1 s", networks)}};
  return r;
}

}  // namespace

void add_network(std::vector<Case>& cases) {
  const std::string family = "The network solver";
  cases.push_back({"maximum-principle", family, "No node becomes wetter than the wettest or drier than the driest", "pressures and mass after one step from random states",
                   "min p(0) <= p <= max p(0) without supply and gravity; sum of masses constant", "property of backward Euler with conservative flows (M-matrix)",
                   "no supply, no gravity", "wetting/transport.h wetting/graph_solver.h", maximum_principle});
  cases.push_back({"dense-solution", family, "Random networks against a dense direct solution", "saturations after one implicit step",
                   "V (s - s0) + dt sum T (Psi_i - Psi_j) = 0 by Newton with Gaussian elimination on the full matrix", "independent implementation in this case",
                   "one material, no pores", "wetting/transport.h wetting/graph_solver.h", dense});
}

}  // namespace imbibe::verify
