#include "imbibe/view/image.h"

#include <algorithm>
#include <cmath>

namespace imbibe {

float srgb_from_linear(float linear) {
  const float l = std::clamp(linear, 0.0f, 1.0f);
  return l <= 0.0031308f ? 12.92f * l : 1.055f * std::pow(l, 1 / 2.4f) - 0.055f;
}

float linear_from_srgb(float encoded) {
  const float e = std::clamp(encoded, 0.0f, 1.0f);
  return e <= 0.04045f ? e / 12.92f : std::pow((e + 0.055f) / 1.055f, 2.4f);
}

void blend_pixel(Image& image, int x, int y, const Vec3f& colour, float alpha) {
  if (x < 0 || y < 0 || x >= image.width || y >= image.height || alpha <= 0) return;
  std::uint8_t* p = image.pixel(x, y);
  const float a = std::min(alpha, 1.0f);
  const float source[3] = {colour.x, colour.y, colour.z};
  for (int c = 0; c < 3; ++c) {
    const float mixed_value = (1 - a) * static_cast<float>(p[c]) + a * 255 * std::clamp(source[c], 0.0f, 1.0f);
    p[c] = static_cast<std::uint8_t>(mixed_value + 0.5f);
  }
}

void fill_rectangle(Image& image, int x0, int y0, int x1, int y1, const Vec3f& colour, float alpha) {
  for (int y = std::max(y0, 0); y < std::min(y1, image.height); ++y)
    for (int x = std::max(x0, 0); x < std::min(x1, image.width); ++x) blend_pixel(image, x, y, colour, alpha);
}

void draw_line(Image& image, Real x0, Real y0, Real x1, Real y1, Real width, const Vec3f& colour) {
  const Real reach = width / 2 + 1, dx = x1 - x0, dy = y1 - y0, length2 = std::max(dx * dx + dy * dy, 1e-12);
  const auto clamped = [](Real value, int limit) { return static_cast<int>(std::clamp(value, 0.0, static_cast<Real>(limit))); };
  const int left = clamped(std::min(x0, x1) - reach, image.width), right = clamped(std::max(x0, x1) + reach, image.width - 1);
  const int top = clamped(std::min(y0, y1) - reach, image.height), bottom = clamped(std::max(y0, y1) + reach, image.height - 1);
  for (int y = top; y <= bottom; ++y)
    for (int x = left; x <= right; ++x) {
      const Real px = x + 0.5 - x0, py = y + 0.5 - y0;
      const Real t = std::clamp((px * dx + py * dy) / length2, 0.0, 1.0);
      const Real distance = std::hypot(px - t * dx, py - t * dy);
      blend_pixel(image, x, y, colour, static_cast<float>(std::clamp(width / 2 + 0.5 - distance, 0.0, 1.0)));
    }
}

}  // namespace imbibe
