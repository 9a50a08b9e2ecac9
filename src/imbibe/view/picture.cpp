#include "imbibe/view/picture.h"

#include <algorithm>
#include <cmath>

#include "imbibe/core/error.h"
#include "imbibe/core/parallel.h"
#include "imbibe/view/overlay.h"
#include "imbibe/view/shading.h"

namespace imbibe {

namespace {

constexpr int tile = 16;             // px
constexpr int samples_at_least = 4;  // before a pixel may be found even
constexpr std::uint64_t for_position = 100;

// Height of the table: that of a level plane solid, else a little below the cloth and the solids, so that drops that
// fall from the cloth are seen falling.
Real ground_of(const Frame& frame, PictureStyle style) {
  for (const DrawnSolid& solid : frame.solids)
    if (const Plane* plane = std::get_if<Plane>(&solid.shape); plane && solid.mesh.triangles.empty() && plane->normal.z > 0.999)
      return plane->point.z;
  Bounds bounds = bounds_of_cloth(frame);
  const Real size = bounds.empty() ? 0 : std::max(bounds.size().x, bounds.size().y);
  bounds.include(bounds_of_solids(frame));
  if (bounds.empty()) bounds = bounds_of_liquid(frame);
  if (bounds.empty()) return 0;
  return bounds.lower.z - (style == PictureStyle::diagram ? 0.06 : 0.04) * size;
}

// Typical way of a view ray through the liquid: the scale of its tint.
Real liquid_depth(const Frame& frame) {
  const Real volume = static_cast<Real>(frame.particles.size()) * std::pow(frame.particle_spacing, 3);
  return std::cbrt(volume);
}

LookInput look_input(const Frame& frame, const Stage& stage, const PictureOptions& options) {
  Bounds bounds = bounds_of_cloth(frame);
  if (bounds.empty()) bounds = bounds_of_liquid(frame);
  if (bounds.empty()) bounds = bounds_of_solids(frame);
  if (bounds.empty()) bounds.include(Vec3{});
  const Camera& camera = stage.camera;
  LookInput in;
  in.style = options.style;
  in.right = Vec3f(camera.right);
  in.forward = Vec3f(camera.forward);
  in.ground_height = static_cast<float>(stage.ground);
  in.content_size = static_cast<float>(std::max(1e-6, std::max(bounds.size().x, bounds.size().y)));
  in.centre = Vec3f(bounds.centre());
  in.liquid_depth = static_cast<float>(liquid_depth(frame));
  in.contact_gap = static_cast<float>(2 * frame.particle_spacing);
  in.pixel_angle = static_cast<float>(2 * camera.tan_half_height / options.height);
  return in;
}

float luminance(const Vec3f& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

// A tent of two pixels' width about the pixel's middle: softer steps at edges than the bare pixel square.
Real tent(float u) { return u < 0.5f ? std::sqrt(2 * u) - 1 : 1 - std::sqrt(2 - 2 * u); }

// Light above white is rolled off instead of cut, colour by colour (natural style).
float rolled_off(float x) {
  constexpr float knee = 0.65f;
  return x <= knee ? x : knee + (1 - knee) * (1 - std::exp(-(x - knee) / (1 - knee)));
}

Vec3f pixel_light(const RayScene& scene, const Look& look, const Camera& camera, const PictureOptions& options, int x, int y) {
  const std::uint64_t pixel = static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(options.width) + static_cast<std::uint64_t>(x);
  Vec3f sum{};
  float sum_shown = 0, sum_squares = 0;
  int n = 0;
  while (n < options.samples) {
    const PixelSamples samples(pixel, static_cast<std::uint32_t>(n));
    const Pair at = samples.pair(for_position);
    const Vec3 direction = direction_through(camera, (x + 0.5 + tent(at.u)) / options.width, (y + 0.5 + tent(at.v)) / options.height);
    Vec3f light = radiance(scene, look, {Vec3f(camera.eye), Vec3f(direction)}, samples);
    // A single bright sample would stay as a speck.
    const float brightest = std::max({light.x, light.y, light.z});
    if (brightest > 6) light *= 6 / brightest;
    sum += light;
    const float shown = srgb_from_linear(luminance(light));
    sum_shown += shown, sum_squares += shown * shown;
    ++n;
    if (n >= samples_at_least && (n & (n - 1)) == 0) {
      // An even pixel, bare paper mostly, needs no more: its mean is known to well below one code value.
      const float mean = sum_shown / static_cast<float>(n);
      const float variance = std::max(0.0f, sum_squares / static_cast<float>(n) - mean * mean);
      if (variance < 1e-6f) break;
    }
  }
  return sum / static_cast<float>(n);
}

void store(Image& image, int x, int y, Vec3f light, const PictureOptions& options) {
  if (options.style == PictureStyle::natural) {
    const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(image.width) - 0.5f;
    const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(image.height) - 0.5f;
    light *= 1 - 0.35f * (u * u + v * v);  // the corners of a lens are darker
    light = {rolled_off(light.x), rolled_off(light.y), rolled_off(light.z)};
  }
  std::uint8_t* p = image.pixel(x, y);
  const float colour[3] = {light.x, light.y, light.z};
  const std::uint64_t place = static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(image.width) + static_cast<std::uint64_t>(x);
  for (std::uint64_t c = 0; c < 3; ++c) {
    // Rounding up or down by chance keeps soft shades free of bands; paper stays paper.
    const float code = 255 * srgb_from_linear(colour[c]);
    const float chance = code > 254.5f ? 0.5f : static_cast<float>(uniform({0xd17e, place, c}));
    p[c] = static_cast<std::uint8_t>(std::clamp(std::floor(code + chance), 0.0f, 255.0f));
  }
}

}  // namespace

Stage stage_for(std::span<const Frame* const> frames, const PictureOptions& options) {
  IMBIBE_ASSERT(!frames.empty());
  std::vector<Vec3> content;
  Real ground = 1e300;
  for (const Frame* frame : frames) {
    const std::vector<Vec3> points = content_of(*frame);
    content.insert(content.end(), points.begin(), points.end());
    ground = std::min(ground, ground_of(*frame, options.style));
  }
  return {camera_for(content, options), ground};
}

Stage stage_for(const Frame& frame, const PictureOptions& options) {
  const Frame* const one[] = {&frame};
  return stage_for(one, options);
}

Image draw_picture(const Frame& frame, const PictureOptions& options) {
  return draw_picture(frame, stage_for(frame, options), options);
}

Image draw_picture(const Frame& frame, const Stage& stage, const PictureOptions& options) {
  IMBIBE_ASSERT(options.width > 0 && options.height > 0 && options.samples > 0);
  const RayScene scene(frame);
  const Look look = look_for(look_input(frame, stage, options));
  Image image(options.width, options.height);
  const int columns = (options.width + tile - 1) / tile, rows = (options.height + tile - 1) / tile;
  parallel_for(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), [&](std::size_t t) {
    const int x0 = static_cast<int>(t) % columns * tile, y0 = static_cast<int>(t) / columns * tile;
    for (int y = y0; y < std::min(y0 + tile, options.height); ++y)
      for (int x = x0; x < std::min(x0 + tile, options.width); ++x)
        store(image, x, y, pixel_light(scene, look, stage.camera, options, x, y), options);
  }, 1);
  if (options.legend && options.style == PictureStyle::diagram) draw_overlay(image, frame, stage.camera, stage.ground);
  return image;
}

}  // namespace imbibe
