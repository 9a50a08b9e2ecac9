// What this machine can do at most: memory bandwidth and arithmetic, measured.
#pragma once

#include <string>

namespace imbibe::bench {

struct MachineLimits {
  double bandwidth = 0;   // B/s: a[i] = b[i] + s c[i] over arrays far larger than the caches, 12 B per element counted
  double arithmetic = 0;  // flop/s in single precision: multiplications and additions apart (no contraction)
};

// Best of several tries with so many threads. About half a second.
MachineLimits measure_limits(int threads);

}  // namespace imbibe::bench
