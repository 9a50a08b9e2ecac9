#include "imbibe/view/denoise.h"

#include <algorithm>
#include <cmath>

namespace imbibe {

namespace {

constexpr float normal_spread = 0.35f, depth_spread = 2.5f;
// Wide in the first pass, so that a lone dark or bright pixel still finds neighbours; narrower once it is calmer.
constexpr float light_spread_first = 1.5f, light_spread_second = 0.6f;
constexpr float spline[5] = {1 / 16.0f, 1 / 4.0f, 3 / 8.0f, 1 / 4.0f, 1 / 16.0f};

float brightness(const Vec3f& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

// Light without the surface's own colour. A floor keeps near-black surfaces from blowing it up.
Vec3f floor_of(const Vec3f& surface) {
  return {std::max(surface.x, 0.02f), std::max(surface.y, 0.02f), std::max(surface.z, 0.02f)};
}

// exp(-x) for x >= 0, closely enough for a weight and without a call.
float falling(float x) {
  const float t = std::max(0.0f, 1 - 0.125f * x);
  const float t2 = t * t, t4 = t2 * t2;
  return t4 * t4;
}

struct Field {
  const std::vector<TracedPixel>& traced;
  int width;
  PixelBox box;             // for which `light` holds values
  std::vector<Vec3f> light;
  float pixel_angle;

  const TracedPixel& pixel(int x, int y) const {
    return traced[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }
  std::size_t place(int x, int y) const {
    return static_cast<std::size_t>(y - box.y0) * static_cast<std::size_t>(box.x1 - box.x0) + static_cast<std::size_t>(x - box.x0);
  }
};

Vec3f filtered(const Field& field, int x, int y, int step) {
  const TracedPixel& here = field.pixel(x, y);
  const Vec3f light = field.light[field.place(x, y)];
  const float bright = brightness(light);
  const float light_spread = step == 1 ? light_spread_first : light_spread_second;
  const float depth_scale = 1 / (depth_spread * static_cast<float>(step) * std::max(here.depth, 1e-9f) * field.pixel_angle * 4);
  Vec3f sum{};
  float total = 0;
  for (int j = -2; j <= 2; ++j)
    for (int i = -2; i <= 2; ++i) {
      const int px = x + i * step, py = y + j * step;
      if (px < field.box.x0 || px >= field.box.x1 || py < field.box.y0 || py >= field.box.y1) continue;
      const TracedPixel& there = field.pixel(px, py);
      const Vec3f other = field.light[field.place(px, py)];
      const float other_bright = brightness(other);
      const float dn = squared_norm(here.normal - there.normal) / (normal_spread * normal_spread);
      const float dz = (here.depth - there.depth) * depth_scale;
      const float dy = (bright - other_bright) / (light_spread * (bright + other_bright) * 0.5f + 0.02f);
      const float w = spline[i + 2] * spline[j + 2] * falling(dn + dz * dz + dy * dy);
      sum += other * w;
      total += w;
    }
  return sum / total;  // the pixel itself has weight, so total > 0
}

}  // namespace

std::vector<Vec3f> denoised(const std::vector<TracedPixel>& traced, int width, int height, const PixelBox& box,
                            float pixel_angle) {
  const auto grown = [&](int by) {
    return PixelBox{std::max(0, box.x0 - by), std::max(0, box.y0 - by), std::min(width, box.x1 + by), std::min(height, box.y1 + by)};
  };
  Field field{traced, width, grown(denoise_reach), {}, pixel_angle};
  for (int y = field.box.y0; y < field.box.y1; ++y)
    for (int x = field.box.x0; x < field.box.x1; ++x) {
      const TracedPixel& p = field.pixel(x, y);
      const Vec3f surface = floor_of(p.surface);
      field.light.push_back({p.light.x / surface.x, p.light.y / surface.y, p.light.z / surface.z});
    }
  for (const int step : {1, 2}) {
    // Pass one covers what pass two will look at; its own edge sees all it needs within the grown box.
    const PixelBox inner = step == 1 ? grown(4) : box;
    std::vector<Vec3f> light;
    for (int y = inner.y0; y < inner.y1; ++y)
      for (int x = inner.x0; x < inner.x1; ++x) light.push_back(filtered(field, x, y, step));
    field.box = inner;
    field.light = std::move(light);
  }
  for (int y = box.y0; y < box.y1; ++y)
    for (int x = box.x0; x < box.x1; ++x) {
      const Vec3f surface = floor_of(field.pixel(x, y).surface);
      Vec3f& l = field.light[field.place(x, y)];
      l = {l.x * surface.x, l.y * surface.y, l.z * surface.z};
    }
  return field.light;
}

}  // namespace imbibe
