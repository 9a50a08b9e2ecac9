// Slopes of two values along a surface: weighted least squares in the tangent plane of a point, with free intercept.
//
//   v_a(x) = c_a + S_ab x_b,  x_b = (x_j - x_i).t_b,  t_1, t_2 tangent axes;  minimal sum_j w_j |v(x_j) - v_j|^2
// The intercept keeps the noise of the centre's own value out of the slopes where neighbours lie on one side (at the rim of
// the surface). A ridge of 2 % of the spread bounds the slopes of thin rows; what it takes from an even neighbourhood is
// given back, so that a sphere's curvature is exact.
// Used by surface_tension.cpp; tested in tests/liquid/tangent_fit_test.cpp.
#pragma once

#include <algorithm>
#include <cmath>

#include "imbibe/core/types.h"

namespace imbibe {

class TangentFit {
 public:
  struct Slopes {
    float s11 = 0, s12 = 0, s21 = 0, s22 = 0;  // S_ab
  };

  // normal: unit. own_weight: of the centre itself, whose values are the origin of the values to come.
  TangentFit(const Vec3f& normal, float own_weight) : weight_(own_weight) {
    const Vec3f across = std::abs(normal.x) < 0.6f ? Vec3f{1, 0, 0} : Vec3f{0, 1, 0};
    first_ = normalized(across - normal * dot(across, normal));
    second_ = cross(normal, first_);
  }
  const Vec3f& first() const { return first_; }
  const Vec3f& second() const { return second_; }

  // A point at `place` from the centre with values v1, v2 above the centre's.
  void add(float w, const Vec3f& place, float v1, float v2) {
    const float x = dot(place, first_), y = dot(place, second_);
    weight_ += w, x_ += w * x, y_ += w * y, v1_ += w * v1, v2_ += w * v2;
    xx_ += w * x * x, xy_ += w * x * y, yy_ += w * y * y;
    v1x_ += w * v1 * x, v1y_ += w * v1 * y, v2x_ += w * v2 * x, v2y_ += w * v2 * y;
  }

  // 0 for neighbours evenly around, about 0.8 for a half-disc.
  float lopsidedness() const {
    return std::sqrt((x_ * x_ + y_ * y_) / std::max(weight_ * (xx_ + yy_), 1e-30f));
  }

  // Zero slopes where the points' spread (mean square) is below least_spread [m2].
  Slopes slopes(float least_spread) const {
    constexpr float part = 0.02f;
    if (!(weight_ > 0)) return {};
    float xx = xx_ - x_ * x_ / weight_, yy = yy_ - y_ * y_ / weight_;
    const float xy = xy_ - x_ * y_ / weight_, trace = xx + yy;
    if (trace < least_spread * weight_) return {};
    xx += part * trace, yy += part * trace;
    const float back = (1 + 2 * part) / (xx * yy - xy * xy);
    const float v1x = v1x_ - v1_ * x_ / weight_, v1y = v1y_ - v1_ * y_ / weight_;
    const float v2x = v2x_ - v2_ * x_ / weight_, v2y = v2y_ - v2_ * y_ / weight_;
    return {(v1x * yy - v1y * xy) * back, (v1y * xx - v1x * xy) * back, (v2x * yy - v2y * xy) * back,
            (v2y * xx - v2x * xy) * back};
  }

 private:
  Vec3f first_, second_;
  float weight_, x_ = 0, y_ = 0, v1_ = 0, v2_ = 0, xx_ = 0, xy_ = 0, yy_ = 0;
  float v1x_ = 0, v1y_ = 0, v2x_ = 0, v2y_ = 0;
};

}  // namespace imbibe
