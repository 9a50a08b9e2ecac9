#include "imbibe/liquid/tangent_fit.h"

#include <gtest/gtest.h>

#include "imbibe/core/random.h"

namespace imbibe {
namespace {

// Points around a place on the unit sphere within 0.3; `half`: only on one side. Values: the normal's tangent parts.
TangentFit fit_on_sphere(bool half, float noise_at_centre) {
  const Vec3f centre{0, 0, 1};
  TangentFit fit(centre, 1);
  for (std::uint64_t k = 0; k < 400; ++k) {
    const auto draw = [&](std::uint64_t s) { return static_cast<float>(2 * uniform({1, k, 0}, s) - 1); };
    const Vec3f p = normalized(Vec3f{0.3f * draw(0), 0.3f * draw(1), 1});
    if (half && dot(p, fit.first()) < 0) continue;
    fit.add(1, p - centre, dot(p, fit.first()) + noise_at_centre, dot(p, fit.second()));
  }
  return fit;
}

TEST(TangentFit, gives_the_curvature_of_a_sphere) {
  const TangentFit::Slopes s = fit_on_sphere(false, 0).slopes(1e-4f);
  EXPECT_NEAR(s.s11, 1, 5e-3);  // the ridge is given back for an even spread; 400 random points are even to 10 %
  EXPECT_NEAR(s.s22, 1, 5e-3);
  EXPECT_NEAR(s.s12, 0, 5e-3);
}

TEST(TangentFit, does_not_take_over_noise_of_the_centre_where_points_lie_on_one_side) {
  const TangentFit quiet = fit_on_sphere(true, 0), noisy = fit_on_sphere(true, 0.1f);
  EXPECT_GT(quiet.lopsidedness(), 0.5f);
  EXPECT_LT(fit_on_sphere(false, 0).lopsidedness(), 0.1f);
  // A fit through the centre would change by 0.1 x 0.15/0.03 = 0.5; the centre itself counts as one of 200 points.
  EXPECT_NEAR(noisy.slopes(1e-4f).s11, quiet.slopes(1e-4f).s11, 0.02);
}

TEST(TangentFit, of_points_that_do_not_span_anything_is_flat) {
  TangentFit fit({1, 0, 0}, 1);
  EXPECT_FLOAT_EQ(fit.slopes(1e-4f).s11, 0);
  fit.add(1, {0, 1e-6f, 0}, 5, 5);
  EXPECT_FLOAT_EQ(fit.slopes(1e-4f).s11, 0);
}

}  // namespace
}  // namespace imbibe
