// Water going into (or out of) the substance of a fibre of radius R_f whose surface is held at regain W_s.
//
//   linear driving force   dW/dt = k (W_s - W),  k = 8 D_f/R_f^2          stepped exactly: W += (W_s - W)(1 - e^(-k dt))
//   radial shells          dw/dt = (1/r) d/dr (r D_f dw/dr),  w(R_f) = W_s  finite volumes in r, exact in time
//   as printed             dW/dt = W_s D_f/R_f^2 until W = W_s              seed A eq. 6
//
// D_f m2/s diffusivity of water in the fibre substance (constant), w(r) local regain, W its mean.
// Source: Crank, The Mathematics of Diffusion, 1975, ch. 5 (cylinder); Glueckauf 1955 (the factor 8 of the linear form,
// exact late, slow at the start: at D t/R^2 = 0.01 it gives 0.077 where Crank's series gives 0.215).
// Shells are finer near the surface. Their equations are linear with constant coefficients, so a step of any length is
// taken in their eigenvectors, which belong to the number of shells alone: stable and without error in time.
// A segment only partly wetted (saturation below `wetted_at`) sorbs from liquid on that share of its fibres.
// Seed A's eq. 6 (with constant = 1 and C_f = rho W) has no driving difference: no equilibrium and no way back. Uptake stops
// at W_s by a rule (seed A 5.2), and fibres exchange nothing with the air.
// Tested in tests/wetting/models_test.cpp (Crank's values, equilibrium, steps composed against one long step).
#pragma once

#include <span>
#include <vector>

#include "imbibe/core/types.h"

namespace imbibe {

// k of the linear driving force, 1/s.
constexpr Real sorption_rate(Real diffusivity, Real radius) { return 8 * diffusivity / (radius * radius); }

// Share of the way to the surface value that dt covers: 1 - e^(-k dt).
Real sorbed_share(Real rate, Real dt);

// Regain after dt by the printed law, rate = D_f/R_f^2; never falls.
constexpr Real printed_regain(Real regain, Real surface, Real rate, Real dt) {
  const Real grown = regain + surface * rate * dt;
  return regain >= surface ? regain : grown < surface ? grown : surface;
}

// Share of a segment's fibres that liquid touches.
constexpr Real wetted_fibres(Real saturation, Real wetted_at) {
  const Real share = saturation / wetted_at;
  return share < 0 ? 0 : share > 1 ? 1 : share;
}

// Radial finite volumes of the unit cylinder with their eigenvectors; D t/R^2 is the only other number.
struct RadialShells {
  int count = 0;
  std::vector<Real> share;        // of the cross-section, sums to 1
  std::vector<Real> rates;        // eigenvalues, in units of D/R^2
  std::vector<Real> to_modes;     // count x count, row major: mode amplitudes of (w - W_s)
  std::vector<Real> from_modes;   // count x count, row major
};

RadialShells build_radial_shells(int count);

// The shells' regains after D t/R^2 = `time` with the surface at `surface`.
void advance_shells(const RadialShells& shells, std::span<const Real> regain, Real surface, Real time,
                    std::span<Real> result);

Real mean_regain(const RadialShells& shells, std::span<const Real> regain);

}  // namespace imbibe
