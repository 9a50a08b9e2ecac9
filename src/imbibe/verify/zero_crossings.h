// Frequency of a signal from the times at which it crosses zero (linear between samples).
#pragma once

#include <vector>

#include "imbibe/core/types.h"

namespace imbibe::verify {

struct ZeroCrossings {
  Real last_value = 0, last_time = 0;
  std::vector<Real> times;  // s

  void add(Real time, Real value) {
    if (last_value * value < 0) times.push_back(last_time + (time - last_time) * last_value / (last_value - value));
    last_value = value, last_time = time;
  }
  // Hz; 0 with fewer than two crossings.
  Real frequency() const {
    return times.size() < 2 ? 0 : 0.5 * static_cast<Real>(times.size() - 1) / (times.back() - times.front());
  }
};

}  // namespace imbibe::verify
