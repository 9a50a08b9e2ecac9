#include "imbibe/wetting/sorption.h"

#define EIGEN_DONT_VECTORIZE  // its sums would depend on the width of the vectors, and on fused multiply-add
#include <Eigen/Dense>

#include "imbibe/core/error.h"
#include "imbibe/core/portable.h"

namespace imbibe {

Real sorbed_share(Real rate, Real dt) { return -portable::expm1(-rate * dt); }

RadialShells build_radial_shells(int count) {
  IMBIBE_ASSERT(count >= 2);
  RadialShells shells;
  shells.count = count;
  // Borders r_i = 1 - (1 - i/n)^1.8: about ten times finer at the surface than in the core for n = 16.
  std::vector<Real> border(count + 1), centre(count);
  for (int i = 0; i <= count; ++i) border[i] = 1 - portable::pow(1 - Real(i) / count, 1.8);
  for (int i = 0; i < count; ++i) centre[i] = 0.5 * (border[i] + border[i + 1]);
  for (int i = 0; i < count; ++i) shells.share.push_back(border[i + 1] * border[i + 1] - border[i] * border[i]);
  // share_i dw_i/dt = sum of 2 r (dw/dr) over both borders (per unit of pi R^2 and D/R^2).
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(count, count);
  for (int i = 0; i < count; ++i) {
    const bool surface = i + 1 == count;
    const Real distance = (surface ? Real(1) : centre[i + 1]) - centre[i];
    const Real conductance = 2 * border[i + 1] / distance;
    stiffness(i, i) += conductance;
    if (surface) continue;
    stiffness(i + 1, i + 1) += conductance;
    stiffness(i, i + 1) -= conductance;
    stiffness(i + 1, i) -= conductance;
  }
  // Symmetric form with y = sqrt(share) (w - W_s).
  Eigen::VectorXd root(count);
  for (int i = 0; i < count; ++i) root(i) = std::sqrt(shells.share[i]);
  const Eigen::MatrixXd scaled = root.cwiseInverse().asDiagonal() * stiffness * root.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled);
  IMBIBE_ASSERT(solver.info() == Eigen::Success);
  shells.to_modes.resize(std::size_t(count) * count);
  shells.from_modes.resize(std::size_t(count) * count);
  for (int m = 0; m < count; ++m) {
    shells.rates.push_back(solver.eigenvalues()(m));
    for (int i = 0; i < count; ++i) {
      shells.to_modes[std::size_t(m) * count + i] = solver.eigenvectors()(i, m) * root(i);
      shells.from_modes[std::size_t(i) * count + m] = solver.eigenvectors()(i, m) / root(i);
    }
  }
  return shells;
}

void advance_shells(const RadialShells& shells, std::span<const Real> regain, Real surface, Real time,
                    std::span<Real> result) {
  const auto n = static_cast<std::size_t>(shells.count);
  Real mode[64];
  IMBIBE_ASSERT(n <= 64 && regain.size() == n && result.size() == n);
  for (std::size_t m = 0; m < n; ++m) {
    Real amplitude = 0;
    for (std::size_t i = 0; i < n; ++i) amplitude += shells.to_modes[m * n + i] * (regain[i] - surface);
    mode[m] = amplitude * portable::exp(-shells.rates[m] * time);
  }
  for (std::size_t i = 0; i < n; ++i) {
    Real deviation = 0;
    for (std::size_t m = 0; m < n; ++m) deviation += shells.from_modes[i * n + m] * mode[m];
    result[i] = surface + deviation;
  }
}

Real mean_regain(const RadialShells& shells, std::span<const Real> regain) {
  Real mean = 0;
  for (std::size_t i = 0; i < regain.size(); ++i) mean += shells.share[i] * regain[i];
  return mean;
}

}  // namespace imbibe
