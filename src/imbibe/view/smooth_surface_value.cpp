#include "imbibe/view/smooth_surface_value.h"

#include <algorithm>
#include <cmath>

namespace imbibe {
namespace {

// Twice the area, negative where the corners go round clockwise.
float twice_area(const std::array<Index, 3>& t, std::span<const std::array<float, 2>> p) {
  return (p[t[1]][0] - p[t[0]][0]) * (p[t[2]][1] - p[t[0]][1]) - (p[t[2]][0] - p[t[0]][0]) * (p[t[1]][1] - p[t[0]][1]);
}

}  // namespace

std::vector<float> averaged_values(std::span<const std::array<Index, 3>> triangles, std::span<const std::array<float, 2>> places,
                                   std::span<const float> values) {
  std::vector<float> sum(values.size()), area(values.size());
  for (const auto& t : triangles) {
    const float weight = std::abs(twice_area(t, places)), all = values[t[0]] + values[t[1]] + values[t[2]];
    for (const Index i : t) sum[i] += weight * 0.25f * (all + values[i]), area[i] += weight;
  }
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = area[i] > 0 ? sum[i] / area[i] : values[i];
  return sum;
}

std::vector<Slope> corner_slopes(std::span<const std::array<Index, 3>> triangles, std::span<const std::array<float, 2>> places,
                                 std::span<const float> values) {
  std::vector<Slope> slopes(values.size());
  std::vector<float> area(values.size());
  for (const auto& t : triangles) {
    const float u1 = places[t[1]][0] - places[t[0]][0], v1 = places[t[1]][1] - places[t[0]][1];
    const float u2 = places[t[2]][0] - places[t[0]][0], v2 = places[t[2]][1] - places[t[0]][1];
    const float s1 = values[t[1]] - values[t[0]], s2 = values[t[2]] - values[t[0]];
    const float twice = twice_area(t, places), sign = twice < 0 ? -1.0f : 1.0f;
    for (const Index i : t) {  // slope of the plane through the corners, times twice the area
      slopes[i][0] += sign * (v2 * s1 - v1 * s2), slopes[i][1] += sign * (u1 * s2 - u2 * s1);
      area[i] += sign * twice;
    }
  }
  for (std::size_t i = 0; i < slopes.size(); ++i)
    slopes[i] = area[i] > 0 && values[i] > 0 ? Slope{slopes[i][0] / area[i], slopes[i][1] / area[i]} : Slope{};
  return slopes;
}

float smooth_value(const std::array<float, 3>& b, const std::array<float, 3>& values,
                   const std::array<std::array<float, 2>, 3>& places, const std::array<Slope, 3>& slopes) {
  const float bubble = b[0] * b[1] * b[2];
  float sum = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    sum += values[i] * (b[i] * b[i] * (3 - 2 * b[i]) + 2 * bubble);
    for (const std::size_t j : {(i + 1) % 3, (i + 2) % 3}) {
      const float along = slopes[i][0] * (places[j][0] - places[i][0]) + slopes[i][1] * (places[j][1] - places[i][1]);
      sum += along * (b[i] * b[i] * b[j] + 0.5f * bubble);
    }
  }
  return std::max(sum, 0.0f);
}

}  // namespace imbibe
