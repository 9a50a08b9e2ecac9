// A value >= 0 given at the corners of a triangle mesh, smoothly between them: a cubic in each triangle that has the corners' values
// and slopes. Linear values show the triangles wherever they are few, as along the edge of a stain.
//
//   s = sum_i [ s_i (b_i^2 (3 - 2 b_i) + 2 b_1 b_2 b_3) + sum_(j != i) g_i.(p_j - p_i) (b_i^2 b_j + b_1 b_2 b_3/2) ]
//
// b barycentric coordinates, p places in the surface (m), s_i values and g_i slopes (per m) of the corners: of each the mean of the
// linear slopes of the triangles around it, by area, and none where the value is 0: nothing is less, and a dry triangle stays dry.
// Even slopes come out exact; along a shared edge both triangles agree.
// What changes from full to dry within a triangle or two still shows them: averaged_values makes its edge as wide as two.
// Source: Bazeley, Cheung, Irons & Zienkiewicz 1965, the triangle of nine values.
// Tested in tests/view/smooth_surface_value_test.cpp.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "imbibe/core/types.h"

namespace imbibe {

using Slope = std::array<float, 2>;

// At each corner the mean of the linear values around it, weighted by its hat function: half its own, half those of its neighbours.
// The integral over the surface is the same.
std::vector<float> averaged_values(std::span<const std::array<Index, 3>> triangles, std::span<const std::array<float, 2>> places,
                                   std::span<const float> values);

// The slopes at all corners; triangles without area count nothing.
std::vector<Slope> corner_slopes(std::span<const std::array<Index, 3>> triangles, std::span<const std::array<float, 2>> places,
                                 std::span<const float> values);

// At barycentric coordinates b of a triangle with these corners.
float smooth_value(const std::array<float, 3>& b, const std::array<float, 3>& values,
                   const std::array<std::array<float, 2>, 3>& places, const std::array<Slope, 3>& slopes);

}  // namespace imbibe
