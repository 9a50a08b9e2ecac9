#include "imbibe/view/picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "imbibe/core/error.h"
#include "imbibe/core/parallel.h"
#include "imbibe/view/denoise.h"
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
  // A soft cloth sags and swings: the table stands well below where it starts.
  if (!frame.cloths.empty()) return bounds.lower.z - 0.5 * norm(bounds_of_cloth(frame).size());
  return bounds.lower.z - (style == PictureStyle::diagram ? 0.06 : 0.04) * size;
}

// Typical way of a view ray through the liquid: the scale of its tint.
Real liquid_depth(const Frame& frame) {
  const Real volume = static_cast<Real>(frame.particles.size()) * std::pow(frame.particle_spacing, 3);
  return std::cbrt(volume);
}

LookInput look_input(const Frame& frame, const Stage& stage, const PictureOptions& options) {
  const Camera& camera = stage.camera;
  LookInput in;
  in.style = options.style;
  in.right = Vec3f(camera.right);
  in.forward = Vec3f(camera.forward);
  in.ground_height = static_cast<float>(stage.ground);
  in.content_size = static_cast<float>(stage.content_size);
  in.centre = Vec3f(stage.centre);
  in.liquid_depth = static_cast<float>(liquid_depth(frame));
  // Particles end a spacing or so above what they wet, and cloth is two yarns thick: water fills its pores to the
  // bottom, whatever the resolution.
  float thickest = 0;
  for (const float r : frame.yarns.radius) thickest = std::max(thickest, r);
  in.contact_gap = static_cast<float>(2 * frame.particle_spacing) + 5 * thickest;
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

TracedPixel pixel_light(const RayScene& scene, const Look& look, const Camera& camera, const PictureOptions& options,
                        int x, int y, std::vector<Index>& touched) {
  const std::uint64_t pixel = static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(options.width) + static_cast<std::uint64_t>(x);
  TracedPixel sum;
  sum.surface = {};
  float sum_shown = 0, sum_squares = 0;
  int n = 0;
  while (n < options.samples) {
    const PixelSamples samples(pixel, static_cast<std::uint32_t>(n));
    const Pair at = samples.pair(for_position);
    const Vec3 direction = direction_through(camera, (x + 0.5 + tent(at.u)) / options.width, (y + 0.5 + tent(at.v)) / options.height);
    TracedPixel one = trace(scene, look, {Vec3f(camera.eye), Vec3f(direction)}, samples, touched);
    // A single bright sample would stay as a speck.
    const float brightest = std::max({one.light.x, one.light.y, one.light.z});
    if (brightest > 6) one.light *= 6 / brightest;
    sum.light += one.light, sum.surface += one.surface, sum.normal += one.normal, sum.depth += one.depth;
    const float shown = srgb_from_linear(luminance(one.light));
    sum_shown += shown, sum_squares += shown * shown;
    ++n;
    if (n >= samples_at_least && (n & (n - 1)) == 0) {
      // An even pixel, bare paper mostly, needs no more: its mean is known to well below one code value.
      const float mean = sum_shown / static_cast<float>(n);
      const float variance = std::max(0.0f, sum_squares / static_cast<float>(n) - mean * mean);
      if (variance < 1e-6f) break;
    }
  }
  const float share = 1 / static_cast<float>(n);
  sum.light *= share, sum.surface *= share, sum.normal *= share, sum.depth *= share;
  return sum;
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

// Squares of the picture that water or its shadow can reach: those under every particle and under its way along the
// light down to the ground.
class WaterReach {
 public:
  WaterReach(const Stage& stage, const PictureOptions& options, int columns, int rows)
      : stage_(stage), options_(options), columns_(columns), rows_(rows),
        reached_(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 0) {}

  void include(const Vec3& particle, Real radius, const Look& look) {
    const Vec3 to_light(look.to_light);
    const Real fall = std::max(0.0, particle.z + radius - stage_.ground) / std::max(0.05, to_light.z);
    // The light is a disc: its shadow widens with the way.
    const Real wide = radius + 1.1 * look.light_size * fall;
    mark({spot(particle, radius), spot(particle - fall * to_light, wide)});
  }
  const std::vector<char>& squares() const { return reached_; }

 private:
  struct Spot {
    ImagePoint at;
    Real radius = 0;  // px
    bool behind = false;
  };
  Spot spot(const Vec3& p, Real radius) const {
    const ImagePoint at = project(stage_.camera, p);
    const Real depth = at.depth - radius;
    if (depth <= 0) return {at, 0, true};
    return {at, 2 + 1.2 * radius / (depth * stage_.camera.tan_half_height) * options_.height / 2, false};
  }
  void mark(const std::array<Spot, 2>& spots) {
    if (spots[0].behind || spots[1].behind) return std::fill(reached_.begin(), reached_.end(), char{1}), void();
    Real x0 = 1e30, x1 = -1e30, y0 = 1e30, y1 = -1e30;
    for (const Spot& s : spots) {
      const Real x = s.at.x * options_.width, y = s.at.y * options_.height;
      x0 = std::min(x0, x - s.radius), x1 = std::max(x1, x + s.radius);
      y0 = std::min(y0, y - s.radius), y1 = std::max(y1, y + s.radius);
    }
    const auto square = [](Real pixel, int count) { return static_cast<int>(std::clamp(std::floor(pixel / tile), 0.0, count - 1.0)); };
    if (x1 < 0 || y1 < 0 || x0 > options_.width || y0 > options_.height) return;
    for (int y = square(y0, rows_); y <= square(y1, rows_); ++y)
      for (int x = square(x0, columns_); x <= square(x1, columns_); ++x)
        reached_[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x)] = 1;
  }

  const Stage& stage_;
  const PictureOptions& options_;
  int columns_, rows_;
  std::vector<char> reached_;
};

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
  Bounds bounds = bounds_of_cloth(*frames[0]);
  if (bounds.empty()) bounds = bounds_of_liquid(*frames[0]);
  if (bounds.empty()) bounds = bounds_of_solids(*frames[0]);
  if (bounds.empty()) bounds.include(Vec3{});
  return {camera_for(content, options), ground, bounds.centre(), std::max({1e-6, bounds.size().x, bounds.size().y})};
}

Stage stage_for(const Frame& frame, const PictureOptions& options) {
  const Frame* const one[] = {&frame};
  return stage_for(one, options);
}

Image draw_picture(const Frame& frame, const PictureOptions& options) {
  return draw_picture(frame, stage_for(frame, options), options);
}

struct PictureSeries::State {
  Stage stage;
  PictureOptions options;
  int columns, rows;
  RayScene scene;
  std::vector<TracedPixel> traced_pixels;   // of the last picture
  Image bare;                               // the last picture without lettering
  std::vector<std::uint8_t> shown;          // of every yarn point in the last picture
  std::vector<std::vector<Index>> touched;  // yarn points that went into each square, sorted
  std::vector<char> wet;                    // squares that water could reach in the last picture
  std::size_t traced = 0;

  State(Stage s, PictureOptions o)
      : stage(std::move(s)), options(std::move(o)), columns((options.width + tile - 1) / tile),
        rows((options.height + tile - 1) / tile),
        traced_pixels(static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height)), bare(options.width, options.height),
        touched(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows)) {}

  std::vector<std::size_t> squares_to_trace(const std::vector<std::uint8_t>& now, const std::vector<char>& wet_now, bool still) const;
  PixelBox box_of(std::size_t square) const;
  void trace_square(std::size_t square, const Look& look);
  // The squares themselves and those around them: their filtered pixels have changed.
  std::vector<std::size_t> with_neighbours(const std::vector<std::size_t>& squares) const;
  void finish_square(std::size_t square, const Look& look);
};

std::vector<std::size_t> PictureSeries::State::squares_to_trace(const std::vector<std::uint8_t>& now,
                                                                const std::vector<char>& wet_now, bool still) const {
  std::vector<std::size_t> squares;
  for (std::size_t t = 0; t < touched.size(); ++t) {
    const bool same = still && !wet[t] && !wet_now[t] &&
                      std::all_of(touched[t].begin(), touched[t].end(), [&](Index p) { return shown[p] == now[p]; });
    if (!same) squares.push_back(t);
  }
  return squares;
}

PixelBox PictureSeries::State::box_of(std::size_t square) const {
  const int x0 = static_cast<int>(square) % columns * tile, y0 = static_cast<int>(square) / columns * tile;
  return {x0, y0, std::min(x0 + tile, options.width), std::min(y0 + tile, options.height)};
}

void PictureSeries::State::trace_square(std::size_t square, const Look& look) {
  const PixelBox box = box_of(square);
  std::vector<Index>& points = touched[square];
  points.clear();
  const auto keep_each_once = [&points] {
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
  };
  for (int y = box.y0; y < box.y1; ++y)
    for (int x = box.x0; x < box.x1; ++x) {
      const std::size_t pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(options.width) + static_cast<std::size_t>(x);
      traced_pixels[pixel] = pixel_light(scene, look, stage.camera, options, x, y, points);
      if (points.size() > 4096) keep_each_once();  // as it grows: neighbouring pixels see the same few points
    }
  keep_each_once();
}

std::vector<std::size_t> PictureSeries::State::with_neighbours(const std::vector<std::size_t>& squares) const {
  static_assert(denoise_reach <= tile);
  std::vector<char> marked(touched.size(), 0);
  for (const std::size_t square : squares) {
    const int x = static_cast<int>(square) % columns, y = static_cast<int>(square) / columns;
    for (int j = std::max(0, y - 1); j <= std::min(rows - 1, y + 1); ++j)
      for (int i = std::max(0, x - 1); i <= std::min(columns - 1, x + 1); ++i)
        marked[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(i)] = 1;
  }
  std::vector<std::size_t> result;
  for (std::size_t t = 0; t < marked.size(); ++t)
    if (marked[t]) result.push_back(t);
  return result;
}

void PictureSeries::State::finish_square(std::size_t square, const Look& look) {
  const PixelBox box = box_of(square);
  const std::vector<Vec3f> light = denoised(traced_pixels, options.width, options.height, box, look.pixel_angle);
  std::size_t n = 0;
  for (int y = box.y0; y < box.y1; ++y)
    for (int x = box.x0; x < box.x1; ++x) store(bare, x, y, light[n++], options);
}

PictureSeries::PictureSeries(Stage stage, PictureOptions options) : state_(new State(std::move(stage), std::move(options))) {
  IMBIBE_ASSERT(state_->options.width > 0 && state_->options.height > 0 && state_->options.samples > 0);
}
PictureSeries::~PictureSeries() = default;
PictureSeries::PictureSeries(PictureSeries&&) noexcept = default;

Real PictureSeries::traced_share() const {
  return static_cast<Real>(state_->traced) / static_cast<Real>(state_->touched.size());
}

Image PictureSeries::draw(const Frame& frame) {
  State& s = *state_;
  const Look look = look_for(look_input(frame, s.stage, s.options));
  // Colours come from what is shown of a saturation, so that a hidden difference cannot make two pictures differ.
  Frame drawn = frame;
  std::vector<std::uint8_t> now(frame.yarns.saturation.size());
  for (std::size_t i = 0; i < now.size(); ++i) {
    now[i] = shown_saturation(s.options.style, frame.yarns.saturation[i]);
    drawn.yarns.saturation[i] = shown_value(s.options.style, now[i]);
  }
  const bool still = s.scene.update(drawn);
  WaterReach reach(s.stage, s.options, s.columns, s.rows);
  for (const Vec3f& p : frame.particles) reach.include(Vec3(p), 2.5 * frame.particle_spacing, look);
  const std::vector<std::size_t> squares = s.squares_to_trace(now, reach.squares(), still);
  parallel_for(squares.size(), [&](std::size_t i) { s.trace_square(squares[i], look); }, 1);
  const std::vector<std::size_t> changed = s.with_neighbours(squares);
  parallel_for(changed.size(), [&](std::size_t i) { s.finish_square(changed[i], look); }, 4);
  s.traced = squares.size();
  s.shown = std::move(now);
  s.wet = reach.squares();

  Image image = s.bare;
  if (s.options.legend && s.options.style == PictureStyle::diagram) draw_overlay(image, frame, s.stage.camera, s.stage.ground);
  return image;
}

Image draw_picture(const Frame& frame, const Stage& stage, const PictureOptions& options) {
  return PictureSeries(stage, options).draw(frame);
}

}  // namespace imbibe
