#include "imbibe/liquid/gradient_correction.h"

#include <algorithm>
#include <cmath>

namespace imbibe {

using simd::Floats;
using simd::Floats3;
using simd::Floats4;
using simd::lanes;

namespace {

constexpr float most_correction = 0.5f;               // of |L - I|
constexpr float surface_from = 0.15f, surface_to = 0.4f;  // of |n + f G| H: between, L fades to I
constexpr float singular_from = 1e-3f, singular_to = 1e-2f;  // of det M: between, L fades to I

struct Matrix {
  Vec3f row[3];
  void add(float scale, const Vec3f& a, const Vec3f& b) {
    row[0] += (scale * a.x) * b, row[1] += (scale * a.y) * b, row[2] += (scale * a.z) * b;
  }
};

// The second moments of eight particles.
struct Moments {
  Floats xx{}, xy{}, xz{}, yy{}, yz{}, zz{};
};

Moments second_moments(const LiquidFields& f, const Slice& s) {
  const Floats4 here = simd::load4(&f.position[s.first]);
  Moments m;
  for (std::size_t k = 0; k < s.slots; ++k) {
    const Floats3 x = here.xyz() - simd::load4(f.position.data(), s.index + k * lanes).xyz();
    const Floats c = -f.volume * simd::load(s.slope + k * lanes);
    const Floats3 v{c * x.x, c * x.y, c * x.z};
    m.xx += v.x * x.x, m.xy += v.x * x.y, m.xz += v.x * x.z, m.yy += v.y * x.y, m.yz += v.y * x.z, m.zz += v.z * x.z;
  }
  return m;
}

// 1 inside, 0 where the free surface cuts the pairs of particle i.
float inside(const LiquidFields& f, std::size_t i) {
  return std::clamp((surface_to - f.colour_gradient[i].w) / (surface_to - surface_from), 0.0f, 1.0f);
}

// B of particle i.
Matrix even_moment(const LiquidFields& f, std::size_t i, float stress) {
  const Float4& wall = f.boundary.wall[i];
  const float whole = stress * (1 - wall.w);
  Matrix b{{{whole, 0, 0}, {0, whole, 0}, {0, 0, whole}}};
  // A sample's gradient is -A m with the other walls' factors; the sum in `wall` is without walls across a gap (density.h).
  Vec3f all{};
  for (const WallSample& s : f.boundary.samples(i)) all += s.gradient;
  const float met = dot(all, Vec3f{wall.x, wall.y, wall.z}) / std::max(dot(all, all), 1e-20f);
  for (const WallSample& s : f.boundary.samples(i))
    b.add(stress * met * std::max(s.distance, 0.0f), s.gradient, s.normal);
  return b;
}

// L - I of particle i from its M, lane l of the moments; 0 where M says nothing.
Matrix correction(const LiquidFields& f, std::size_t i, const Moments& m, std::size_t l, float stress) {
  const float a = m.xx[l], b = m.xy[l], c = m.xz[l], d = m.yy[l], e = m.yz[l], g = m.zz[l];
  const Vec3f minor[3] = {{d * g - e * e, c * e - b * g, b * e - c * d},
                          {c * e - b * g, a * g - c * c, b * c - a * e},
                          {b * e - c * d, b * c - a * e, a * d - b * b}};
  const float determinant = a * minor[0].x + b * minor[0].y + c * minor[0].z;
  const float regular =
      inside(f, i) * std::clamp((determinant - singular_from) / (singular_to - singular_from), 0.0f, 1.0f);
  if (regular == 0) return {};
  const Matrix even = even_moment(f, i, stress);
  Matrix change;
  float square = 0;
  for (int r = 0; r < 3; ++r) {
    const Vec3f& u = even.row[r];
    Vec3f& row = change.row[r];
    row = (u.x * minor[0] + u.y * minor[1] + u.z * minor[2]) / determinant;
    (r == 0 ? row.x : r == 1 ? row.y : row.z) -= 1;
    square += dot(row, row);
  }
  const float scale = regular * std::min(1.0f, most_correction / std::max(std::sqrt(square), 1e-9f));
  for (Vec3f& row : change.row) row = scale * row;
  return change;
}

}  // namespace

void correct_gradients(LiquidFields& f, Real spray_filling) {
  f.corrected = true;
  const std::size_t padded = f.position.size();
  for (auto* array : {&f.correction, &f.stress}) {
    array->resize(3 * padded);
    for (std::size_t i = 3 * f.count; i < 3 * padded; ++i) (*array)[i] = {};
  }
  const auto spray = static_cast<float>(spray_filling);
  const float stress = f.lattice.stress;
  for_each_slice(f.neighbours, [&](const Slice& s) {
    const Moments m = second_moments(f, s);
    for (std::size_t i = s.first; i < std::min(s.first + lanes, f.count); ++i) {
      const Matrix c = f.filling[i] < spray ? Matrix{} : correction(f, i, m, i - s.first, stress);
      Float4* row = &f.correction[3 * i];
      row[0] = {1 + c.row[0].x, c.row[0].y, c.row[0].z, 0};
      row[1] = {c.row[1].x, 1 + c.row[1].y, c.row[1].z, 0};
      row[2] = {c.row[2].x, c.row[2].y, 1 + c.row[2].z, 0};
    }
  });
}

}  // namespace imbibe
