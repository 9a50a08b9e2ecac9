// Takes the grain out of a picture traced with few rays per pixel: an edge-stopping a-trous filter (Dammertz et al.,
// HPG 2010) on the light, that is on colour over surface colour, so that cloth and stain keep their detail.
//   weight = h(k) exp(-|n - n'|^2 / s_n^2 - (|z - z'| / (s_z z pixel))^2 - (y - y')^2 / (s_y (y + y'))^2)
// h: B3-spline 5 x 5, in two passes of steps 1 and 2; n normal, z depth, y brightness of the light.
// A pixel's result depends on pixels within `denoise_reach` only. Tested in tests/view/denoise_test.cpp.
#pragma once

#include <vector>

#include "imbibe/core/types.h"

namespace imbibe {

inline constexpr int denoise_reach = 2 + 4;  // px

// What was traced of one pixel: means over its samples.
struct TracedPixel {
  Vec3f light;          // linear RGB, what is seen
  Vec3f surface{1, 1, 1};  // linear RGB, colour of the surface itself
  Vec3f normal;         // mean, so shorter than one where surfaces meet
  float depth = 0;      // m
};

struct PixelBox {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // [x0, x1) x [y0, y1)
};

// The filtered light of the box, row by row. pixel_angle: rad per pixel.
std::vector<Vec3f> denoised(const std::vector<TracedPixel>& traced, int width, int height, const PixelBox& box,
                            float pixel_angle);

}  // namespace imbibe
