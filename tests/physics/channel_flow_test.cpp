// Start-up of plane Poiseuille flow on the real step against the closed form (Morris, Fox & Zhu, J. Comput. Phys. 136
// (1997) 214, section 4.2), without surface tension and hence without numerical viscosity:
//   u(y, t) = g/(2 nu) (h^2 - y^2) - sum_n (-1)^n 16 g h^2/(nu pi^3 (2n+1)^3) cos((2n+1) pi y/(2h)) e^(-(2n+1)^2 pi^2 nu t/(4 h^2))
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "imbibe/core/random.h"
#include "imbibe/liquid/liquid_step.h"

namespace imbibe {
namespace {

constexpr Real g = 9.81, nu = 1e-4, spacing = 1e-4;
constexpr int cells_across = 8;
const Real edge = std::cbrt(2.0) * spacing, half = 0.5 * cells_across * edge;

Real poiseuille(Real y, Real t) {
  Real u = g / (2 * nu) * (half * half - y * y);
  for (int n = 0; n < 50; ++n) {
    const Real m = 2 * n + 1;
    u -= (n % 2 == 0 ? 1 : -1) * 16 * g * half * half / (nu * std::pow(pi * m, 3)) * std::cos(m * pi * y / (2 * half)) *
         std::exp(-m * m * pi * pi * nu * t / (4 * half * half));
  }
  return u;
}

// A block of liquid, open at both ends in x, between two plates in y that hold it and two in z that do not. The flow moves
// by a quarter of a spacing, so the ends stay flat and have no pressure; measured one channel width and more from them.
TEST(ChannelFlow, starts_up_like_plane_poiseuille_flow) {
  constexpr int cells_along = 32, cells_deep = 14;
  const Real depth = 0.5 * cells_deep * edge;
  Liquid liquid;
  liquid.particle_mass = liquid.kind.density * std::pow(spacing, 3);
  liquid.kind.viscosity = nu * liquid.kind.density;
  for (int k = 0; k < 2 * cells_along * cells_deep * cells_across; ++k) {
    const int cell = k / 2;
    const auto at = [&](int step, int cells, std::uint64_t axis) {
      const Real shake = 0.1 * spacing * (uniform({3, static_cast<std::uint64_t>(k), 0}, axis) - 0.5);
      return edge * (step + 0.25 + 0.5 * (k % 2) - 0.5 * cells) + shake;
    };
    add_particle(liquid,
                 {at(cell % cells_along, cells_along, 0), at(cell / cells_along % cells_across, cells_across, 1),
                  at(cell / cells_along / cells_across, cells_deep, 2)},
                 {});
  }
  const Shape shapes[] = {Plane{{0, -half, 0}, {0, 1, 0}}, Plane{{0, half, 0}, {0, -1, 0}},
                          Plane{{0, 0, -depth}, {0, 0, 1}}, Plane{{0, 0, depth}, {0, 0, -1}}};
  std::vector<Wall> walls;
  for (const Shape& s : shapes) walls.push_back({&s, {.friction = walls.size() < 2 ? 1.0 : 0.0}, {}, false});
  LiquidParams params;
  params.surface_tension = false;
  LiquidScratch scratch;
  const Real settled = half * half / nu, fastest = g * half * half / (2 * nu);
  Real time = 0;
  for (const Real until : {0.1, 0.3, 0.6, 1.5}) {
    while (time < until * settled) {
      time += step_liquid(liquid, params, walls, {g, 0, 0}, settled / 100, scratch).step_s;
    }
    Real square = 0, count = 0, middle = 0, theory = 0;
    for (std::size_t i = 0; i < liquid.particles.size(); ++i) {
      const Float4 &x = liquid.particles.position[i], &u = liquid.particles.velocity[i];
      if (std::abs(x.x) > 2 * half || std::abs(x.z) > depth - 3 * spacing) continue;
      const Real wanted = poiseuille(x.y, time);
      square += (u.x - wanted) * (u.x - wanted), count += 1;
      if (std::abs(x.y) < 0.3 * half) middle += u.x, theory += wanted;
    }
    std::printf("  t = %.1f h2/nu: middle %.3f of theory, deviation %.4f of the greatest speed\n", time / settled,
                middle / theory, std::sqrt(square / count) / fastest);
    // At 10 spacings across: 1.0 % at first, 4.4 % when steady (3.8 % at twice the depth: pairs are missing at the plates
    // that let it slip). What makes the rest is not known; it does not fade with resolution: 6.3 % at 20 spacings across in
    // a block that is only 3.5 half-widths deep and 6 long. So the bound is a regression bound, not a converged error.
    EXPECT_LT(std::sqrt(square / count) / fastest, 0.05) << time / settled;
  }
}

}  // namespace
}  // namespace imbibe
