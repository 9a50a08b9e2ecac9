#include "imbibe/core/portable.h"

#include <bit>
#include <cstdint>
#include <limits>

namespace imbibe::portable {

namespace {

constexpr Real infinity = std::numeric_limits<Real>::infinity();
constexpr Real nan = std::numeric_limits<Real>::quiet_NaN();

// ln 2 and pi/2 in pieces: the first ones end in zeros, so that their products with small whole numbers are exact.
constexpr Real ln2_high = 0x1.62e42fee00000p-1, ln2_low = 0x1.a39ef35793c76p-33;
constexpr Real half_pi_1 = 0x1.921fb54400000p+0, half_pi_2 = 0x1.0b4611a600000p-34, half_pi_3 = 0x1.3198a2e037073p-69;
constexpr Real half_pi_rest = 6.123233995736766e-17;  // pi/2 minus the Real nearest to it

// The sum of two Reals, or their product, as a rounded value and what it lacks.
struct Pair {
  Real high, low;
};
Pair exact_sum(Real a, Real b) {
  const Real sum = a + b, part = sum - a;
  return {sum, (a - (sum - part)) + (b - part)};
}
// Products of halves of 26 bits are exact. For |a|, |b| < 2^990.
Pair exact_product(Real a, Real b) {
  constexpr Real split = 134217729;  // 2^27 + 1
  const Real ca = split * a, cb = split * b;
  const Real a1 = ca - (ca - a), a2 = a - a1, b1 = cb - (cb - b), b2 = b - b1;
  const Real product = a * b;
  return {product, ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2};
}

// x 2^k, also where the result is subnormal.
Real scaled(Real x, int k) {
  const auto power = [](int n) { return std::bit_cast<Real>(static_cast<std::uint64_t>(n + 1023) << 52); };
  if (k > 1023) return x * power(1023) * power(k - 1023);
  if (k < -1022) return x * power(k + 969 > -1022 ? k + 969 : -1022) * power(-969);
  return x * power(k);
}

// c[0] + c[1] z + ... as four sums in z^4 that the processor works on at the same time.
template <int count>
Real polynomial(const Real (&c)[count], Real z) {
  static_assert(count % 4 == 0);
  const Real z2 = z * z, z4 = z2 * z2;
  Real a = c[count - 4], b = c[count - 3], d = c[count - 2], e = c[count - 1];
  for (int i = count - 8; i >= 0; i -= 4) a = a * z4 + c[i], b = b * z4 + c[i + 1], d = d * z4 + c[i + 2], e = e * z4 + c[i + 3];
  return (a + b * z) + z2 * (d + e * z);
}

// e^r - 1 - r for |r| <= 0.35: r^2/2! + ... + r^13/13!.
Real exp_tail(Real r) {
  static constexpr Real c[] = {0.5,          1.0 / 6,       1.0 / 24,       1.0 / 120,       1.0 / 720,       1.0 / 5040,
                               1.0 / 40320,  1.0 / 362880,  1.0 / 3628800,  1.0 / 39916800,  1.0 / 479001600, 1.0 / 6227020800};
  return r * r * polynomial(c, r);
}

// e^(x + rest), |rest| far below |x|.
Real exp_of(Real x, Real rest) {
  if (!(x < 710)) return x != x ? nan : infinity;
  if (x < -746) return 0;
  const Real k = std::floor(x * 1.4426950408889634 + 0.5);
  const Pair r = exact_sum(x - k * ln2_high, rest - k * ln2_low);
  return scaled(1 + (r.high + (r.low * (1 + r.high) + exp_tail(r.high))), static_cast<int>(k));
}

// x = 2^exponent (1 + fraction) with 1 + fraction in [sqrt(1/2), sqrt(2)); x > 0 and finite.
struct Split {
  Real fraction;
  int exponent;
};
Split split(Real x) {
  int exponent = 0;
  if (x < std::numeric_limits<Real>::min()) x *= 0x1p54, exponent = -54;
  auto bits = std::bit_cast<std::uint64_t>(x);
  exponent += static_cast<int>(bits >> 52) - 1023;
  Real mantissa = std::bit_cast<Real>((bits & 0xfffffffffffffULL) | 0x3ff0000000000000ULL);
  if (mantissa > 1.4142135623730951) mantissa *= 0.5, ++exponent;
  return {mantissa - 1, exponent};
}

// artanh(s)/s - 1 = z/3 + z^2/5 + ... for z = s^2 <= 0.0295.
Real artanh_tail(Real z) {
  static constexpr Real c[] = {1.0 / 3,  1.0 / 5,  1.0 / 7,  1.0 / 9,  1.0 / 11, 1.0 / 13,
                               1.0 / 15, 1.0 / 17, 1.0 / 19, 1.0 / 21, 1.0 / 23, 1.0 / 25};
  return z * polynomial(c, z);
}

// log x as a pair of some 60 bits: 2 artanh(f / (2 + f)) + exponent ln 2, for x > 0 and finite.
Pair log_of(Real x) {
  const auto [f, exponent] = split(x);
  const Pair below = exact_sum(2, f);
  const Real inverse = 1 / below.high, s = f * inverse;
  const Pair back = exact_product(s, below.high);
  const Real s_rest = ((f - back.high) - back.low - s * below.low) * inverse;
  const Real tail = 2 * s_rest + 2 * s * artanh_tail(s * s);
  const Pair sum = exact_sum(exponent * ln2_high, 2 * s);
  const Real low = sum.low + (tail + exponent * ln2_low);
  const Pair result = exact_sum(sum.high, low);
  return result;
}

// sin r - r and cos r - 1 + r^2/2 over |r| <= pi/4.
Real sin_tail(Real r) {
  static constexpr Real c[] = {-1.0 / 6,        1.0 / 120,           -1.0 / 5040,          1.0 / 362880,
                               -1.0 / 39916800, 1.0 / 6227020800,    -1.0 / 1307674368000, 1.0 / 355687428096000};
  const Real z = r * r;
  return r * z * polynomial(c, z);
}
Real cos_tail(Real r) {
  static constexpr Real c[] = {1.0 / 24,        -1.0 / 720,          1.0 / 40320,          -1.0 / 3628800,
                               1.0 / 479001600, -1.0 / 87178291200,  1.0 / 20922789888000, -1.0 / 6402373705728000};
  const Real z = r * r;
  return z * z * polynomial(c, z);
}

// The quarter turn of x, and what remains of it, within [-pi/4, pi/4].
struct Turn {
  int quarter;
  Pair rest;
};
Turn turn_of(Real x) {
  const Real k = std::floor(x * 0.6366197723675814 + 0.5);
  const Pair first = exact_sum(x - k * half_pi_1, -k * half_pi_2);
  const Pair rest = exact_sum(first.high, first.low - k * half_pi_3);
  return {static_cast<int>(k - 4 * std::floor(k * 0.25)), rest};
}

Real sin_of(const Pair& r) { return r.high + (sin_tail(r.high) + r.low * (1 - 0.5 * r.high * r.high)); }
Real cos_of(const Pair& r) {
  const Real half = 0.5 * r.high * r.high, most = 1 - half;
  return most + (((1 - most) - half) + (cos_tail(r.high) - r.high * r.low));
}

// arctan x for x in [0, 1]: about pi/6 above tan(pi/12), arctan x = pi/6 + arctan((x - 1/root3) / (1 + x/root3)).
Real arctan(Real x) {
  constexpr Real inverse_root3 = 0.5773502691896257, inverse_rest = 3.3450280739356345e-17;  // its two pieces
  constexpr Real sixth = 0.5235987755982989, sixth_rest = -5.360408832255455e-17;
  const bool turned = x > 0.2679491924311227;
  const Real t = turned ? ((x - inverse_root3) - inverse_rest) / (1 + x * inverse_root3) : x, z = t * t;
  static constexpr Real c[] = {-1.0 / 3,  1.0 / 5,  -1.0 / 7,  1.0 / 9,  -1.0 / 11, 1.0 / 13,
                               -1.0 / 15, 1.0 / 17, -1.0 / 19, 1.0 / 21, -1.0 / 23, 1.0 / 25};
  const Real bend = t * z * polynomial(c, z);
  return turned ? sixth + (t + (bend + sixth_rest)) : t + bend;
}

}  // namespace

Real exp(Real x) { return exp_of(x, 0); }

Real expm1(Real x) {
  if (std::abs(x) < 0.35) return x + exp_tail(x);
  if (!(x < 40)) return exp(x);
  const Pair result = exact_sum(exp(x), -1);
  return result.high + result.low;
}

Real log(Real x) {
  if (!(x > 0)) return x == 0 ? -infinity : nan;
  if (x == infinity) return infinity;
  const Pair l = log_of(x);
  return l.high + l.low;
}

Real pow(Real x, Real y) {
  if (y == 0 || x == 1) return 1;
  if (x != x || y != y) return nan;
  if (x < 0) {
    if (y != std::floor(y)) return nan;
    const bool odd = std::abs(y) < 0x1p53 && std::fmod(y, 2) != 0;
    return odd ? -pow(-x, y) : pow(-x, y);
  }
  if (x == 0) return y > 0 ? 0 : infinity;
  if (x == infinity) return y > 0 ? infinity : 0;
  const Pair l = log_of(x);
  const Real about = y * l.high;
  if (!(std::abs(about) < 800)) return about > 0 ? infinity : 0;
  const Pair p = exact_product(y, l.high);
  return exp_of(p.high, p.low + y * l.low);
}

Real cbrt(Real x) {
  if (!(std::abs(x) < infinity) || x == 0) return x;
  Real size = std::abs(x);
  int thirds = 0;  // the result's power of two
  if (size < 0x1p-900) size *= 0x1p180, thirds = -60;
  const int exponent = static_cast<int>(std::bit_cast<std::uint64_t>(size) >> 52) - 1023;
  const int third = (exponent + 3000) / 3 - 1000;
  const Real m = scaled(size, -3 * third);  // in [1, 8)
  Real root = 0.8 + m * (0.27 - 0.0144 * m);
  for (int i = 0; i < 3; ++i) {  // Halley's method triples the digits: 2 % at first
    const Real cube = root * root * root;
    root -= root * (cube - m) / (2 * cube + m);
  }
  // One more step with the cube's rounding known.
  const Pair square = exact_product(root, root), cube = exact_product(square.high, root);
  root -= ((cube.high - m) + (cube.low + square.low * root)) / (3 * square.high);
  return std::copysign(scaled(root, third + thirds), x);
}

Real sin(Real x) {
  if (!(std::abs(x) < infinity)) return nan;
  const Turn t = turn_of(x);
  const Real value = t.quarter % 2 == 0 ? sin_of(t.rest) : cos_of(t.rest);
  return t.quarter < 2 ? value : -value;
}

Real cos(Real x) {
  if (!(std::abs(x) < infinity)) return nan;
  const Turn t = turn_of(x);
  const Real value = t.quarter % 2 == 0 ? cos_of(t.rest) : sin_of(t.rest);
  return t.quarter == 1 || t.quarter == 2 ? -value : value;
}

Real atan2(Real y, Real x) {
  if (x != x || y != y) return nan;
  const Real a = std::abs(x), b = std::abs(y);
  Real angle = 0;  // of (a, b), in [0, pi/2]
  if (a == infinity && b == infinity) angle = pi / 4;
  else if (b > a) angle = (pi / 2 - arctan(a / b)) + half_pi_rest;
  else if (a > 0) angle = arctan(b / a);
  if (std::signbit(x)) angle = (pi - angle) + 2 * half_pi_rest;
  return std::copysign(angle, y);
}

Real asin(Real x) {
  if (!(std::abs(x) <= 1)) return nan;
  return atan2(x, std::sqrt((1 - x) * (1 + x)));
}

Real acos(Real x) {
  if (!(std::abs(x) <= 1)) return nan;
  return atan2(std::sqrt((1 - x) * (1 + x)), x);
}

}  // namespace imbibe::portable
