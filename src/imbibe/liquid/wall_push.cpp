#include "imbibe/liquid/wall_push.h"

#include <algorithm>
#include <array>

namespace imbibe {

namespace {

// J for d = q H.
Real fold(Real q) {
  constexpr int steps = 400;  // midpoints
  Real sum = 0;
  for (int k = 0; k < steps; ++k) {
    const Real y = 2 * (k + 0.5) / steps;  // beyond q + 1 the kernel does not reach
    sum += -half_space_integral(std::abs(q - y), 1).slope / (1 - half_space_integral(y, 1).lambda) * 2 / steps;
  }
  return sum;
}

// A function of q = d/H in [0, 1] from a table; q < 0 counts as 0.
class Table {
 public:
  template <class Function>
  explicit Table(Function function) {
    for (std::size_t k = 0; k <= entries; ++k) value_[k] = static_cast<float>(function(static_cast<Real>(k) / entries));
  }
  float at(float q) const {
    const float place = std::clamp(q, 0.0f, 0.9999f) * entries;
    const auto k = static_cast<std::size_t>(place);
    return value_[k] + (place - static_cast<float>(k)) * (value_[k + 1] - value_[k]);
  }

 private:
  static constexpr std::size_t entries = 256;
  std::array<float, entries + 1> value_{};
};

}  // namespace

void set_pushes(std::span<WallSample> samples, std::span<const float> contact, float support) {
  static const Table ratio([](Real q) { return pressure_gradient_ratio(q, 1); });
  static const Table folds([](Real q) { return fold(q); });
  for (std::size_t k = 0; k < samples.size(); ++k) {
    float others = 1;
    for (std::size_t l = 0; l < samples.size(); ++l)
      if (l != k) others *= 1 + contact[l] * (folds.at(samples[l].distance / support) - 1);
    samples[k].push = samples[k].gradient * (0.5f * (1 + (2 * ratio.at(samples[k].distance / support) - 1) * others));
  }
}

}  // namespace imbibe
