#include "imbibe/view/smooth_surface_value.h"

#include <gtest/gtest.h>

#include <cmath>

namespace imbibe {
namespace {

// n x n nodes over a square of 1 m, each cell cut along alternating diagonals.
struct Square {
  std::vector<std::array<Index, 3>> triangles;
  std::vector<std::array<float, 2>> places;
  std::vector<float> values;
  std::vector<Slope> slopes;

  Square(Index n, auto&& value) {
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i) {
        places.push_back({static_cast<float>(i) / static_cast<float>(n - 1), static_cast<float>(j) / static_cast<float>(n - 1)});
        values.push_back(value(places.back()));
      }
    for (Index j = 0; j + 1 < n; ++j)
      for (Index i = 0; i + 1 < n; ++i) {
        const Index a = i + n * j, b = a + 1, c = a + n, d = c + 1;
        if ((i + j) % 2) triangles.insert(triangles.end(), {{a, b, d}, {a, d, c}});
        else triangles.insert(triangles.end(), {{a, b, c}, {b, d, c}});
      }
    slopes = corner_slopes(triangles, places, values);
  }
  float at(std::size_t triangle, const std::array<float, 3>& b) const {
    const auto& t = triangles[triangle];
    return smooth_value(b, {values[t[0]], values[t[1]], values[t[2]]}, {places[t[0]], places[t[1]], places[t[2]]},
                        {slopes[t[0]], slopes[t[1]], slopes[t[2]]});
  }
  std::array<float, 2> place(std::size_t triangle, const std::array<float, 3>& b) const {
    std::array<float, 2> p{};
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t c = 0; c < 2; ++c) p[c] += b[k] * places[triangles[triangle][k]][c];
    return p;
  }
};

// Greatest error over the triangles of the inner half, at five points of each; and that of linear values.
std::array<float, 2> errors(const Square& square, auto&& value) {
  std::array<float, 2> most{};
  for (std::size_t t = 0; t < square.triangles.size(); ++t)
    for (const std::array<float, 3>& b : {std::array{1 / 3.0f, 1 / 3.0f, 1 / 3.0f}, {0.5f, 0.5f, 0.0f}, {0.0f, 0.5f, 0.5f},
                                          {0.5f, 0.0f, 0.5f}, {0.6f, 0.2f, 0.2f}}) {
      const auto p = square.place(t, b);
      if (std::abs(p[0] - 0.5f) > 0.25f || std::abs(p[1] - 0.5f) > 0.25f) continue;
      float linear = 0;
      for (std::size_t k = 0; k < 3; ++k) linear += b[k] * square.values[square.triangles[t][k]];
      most[0] = std::max(most[0], std::abs(square.at(t, b) - value(p)));
      most[1] = std::max(most[1], std::abs(linear - value(p)));
    }
  return most;
}

TEST(SmoothSurfaceValue, of_an_even_slope_is_that_slope) {
  const auto plane = [](const std::array<float, 2>& p) { return 0.2f + 0.3f * p[0] - 0.1f * p[1]; };
  EXPECT_LT(errors(Square(9, plane), plane)[0], 1e-6f);  // rounding of floats
}

TEST(SmoothSurfaceValue, is_a_quarter_as_far_from_a_rounded_stain_as_linear_values) {
  const auto stain = [](const std::array<float, 2>& p) {
    const float x = p[0] - 0.5f, y = p[1] - 0.5f;
    return std::exp(-12 * (x * x + y * y));
  };
  const auto [smooth, linear] = errors(Square(17, stain), stain);
  EXPECT_LT(smooth, 0.25f * linear);
}

TEST(SmoothSurfaceValue, of_corners_is_theirs_and_of_a_dry_triangle_is_dry) {
  const auto step = [](const std::array<float, 2>& p) { return p[0] > 0.5f ? 1.0f : 0.0f; };
  const Square square(9, step);
  for (std::size_t t = 0; t < square.triangles.size(); ++t) {
    const auto& corner = square.triangles[t];
    EXPECT_FLOAT_EQ(square.at(t, {1, 0, 0}), square.values[corner[0]]);
    if (square.values[corner[0]] + square.values[corner[1]] + square.values[corner[2]] == 0) {
      EXPECT_EQ(square.at(t, {0.3f, 0.3f, 0.4f}), 0);
    }
  }
}

// How ragged the edge of a stain along 0.4 x + y = const is: root mean square of what the values at one distance from it differ by.
float raggedness(const Square& square, float h) {
  struct Bin {
    float count = 0, sum = 0, squares = 0;
  };
  std::vector<Bin> bins(64);
  constexpr int cuts = 20;
  for (std::size_t t = 0; t < square.triangles.size(); ++t)
    for (int i = 0; i <= cuts; ++i)
      for (int j = 0; i + j <= cuts; ++j) {
        const std::array<float, 3> b{static_cast<float>(i) / cuts, static_cast<float>(j) / cuts, static_cast<float>(cuts - i - j) / cuts};
        const auto p = square.place(t, b);
        const float away = (0.4f * p[0] + p[1] - 0.7f) / std::hypot(0.4f, 1.0f);
        if (std::abs(p[0] - 0.5f) > 0.25f || std::abs(away) > 2 * h) continue;
        const float value = square.at(t, b);
        Bin& bin = bins[static_cast<std::size_t>(std::lround(32 + 15 * away / h))];
        bin.count += 1, bin.sum += value, bin.squares += value * value;
      }
  float count = 0, squares = 0;
  for (const Bin& bin : bins)
    if (bin.count > 0) count += bin.count, squares += bin.squares - bin.sum * bin.sum / bin.count;
  return std::sqrt(squares / count);
}

TEST(SmoothSurfaceValue, averages_keep_the_integral_and_halve_the_raggedness_of_a_stains_edge) {
  const auto half = [](const std::array<float, 2>& p) { return 0.4f * p[0] + p[1] < 0.7f ? 1.0f : 0.0f; };
  Square sharp(17, half), averaged = sharp;
  averaged.values = averaged_values(sharp.triangles, sharp.places, sharp.values);
  averaged.slopes = corner_slopes(sharp.triangles, sharp.places, averaged.values);
  const auto integral = [](const Square& s) {
    float sum = 0;  // all triangles are alike
    for (const auto& t : s.triangles) sum += s.values[t[0]] + s.values[t[1]] + s.values[t[2]];
    return sum;
  };
  EXPECT_NEAR(integral(averaged), integral(sharp), 1e-5f * integral(sharp));  // rounding of floats
  EXPECT_LT(raggedness(averaged, 1.0f / 16), 0.5f * raggedness(sharp, 1.0f / 16));
}

TEST(SmoothSurfaceValue, agrees_on_both_sides_of_a_shared_edge) {
  const auto wild = [](const std::array<float, 2>& p) { return 0.5f + 0.5f * std::sin(37 * p[0] + 61 * p[1] * p[1]); };
  const Square square(9, wild);
  for (std::size_t t = 0; t + 1 < square.triangles.size(); t += 2) {  // the two of a cell share its diagonal
    const auto &p = square.triangles[t], &q = square.triangles[t + 1];
    std::array<float, 3> b{}, c{};
    Index shared = 0;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        if (p[i] == q[j]) b[i] = c[j] = shared++ == 0 ? 0.3f : 0.7f;
    ASSERT_EQ(shared, 2u);
    EXPECT_NEAR(square.at(t, b), square.at(t + 1, c), 1e-6f);  // rounding of floats
  }
}

}  // namespace
}  // namespace imbibe
