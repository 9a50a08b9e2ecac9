// Eight-bit sRGB picture in memory, and its PNG file.
#pragma once

#include <cstdint>
#include <vector>

#include "imbibe/core/types.h"

namespace imbibe {

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  // row by row from the top left, 3 bytes per pixel

  Image() = default;
  Image(int width_, int height_, std::uint8_t value = 255)
      : width(width_), height(height_), rgb(static_cast<std::size_t>(width_) * height_ * 3, value) {}
  std::uint8_t* pixel(int x, int y) { return &rgb[(static_cast<std::size_t>(y) * width + x) * 3]; }
  const std::uint8_t* pixel(int x, int y) const { return &rgb[(static_cast<std::size_t>(y) * width + x) * 3]; }
  friend bool operator==(const Image&, const Image&) = default;
};

// Linear light in [0, 1] to and from the sRGB code value in [0, 1] (IEC 61966-2-1).
float srgb_from_linear(float linear);
float linear_from_srgb(float encoded);

// Lays `colour` (sRGB, 0..1) over the pixel with coverage `alpha`; outside the image nothing happens.
void blend_pixel(Image& image, int x, int y, const Vec3f& colour, float alpha);
void draw_line(Image& image, Real x0, Real y0, Real x1, Real y1, Real width, const Vec3f& colour);
void fill_rectangle(Image& image, int x0, int y0, int x1, int y1, const Vec3f& colour, float alpha = 1);

}  // namespace imbibe
