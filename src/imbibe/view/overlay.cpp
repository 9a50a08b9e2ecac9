#include "imbibe/view/overlay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "imbibe/view/colour_bar.h"
#include "imbibe/view/text.h"

namespace imbibe {

namespace {

std::string length_label(Real metres) {
  if (metres >= 0.9995) return fmt::format("{:.3g} m", metres);
  if (metres >= 0.9995e-3) return fmt::format("{:.3g} mm", metres * 1e3);
  return fmt::format("{:.3g} µm", metres * 1e6);
}

// The scale bar lies in the scene, along that lower edge of the content which is nearest in the picture, so that the
// perspective is right for it.
void draw_scale_bar(Image& image, const Frame& frame, const Camera& camera, Real ground, Real unit) {
  Bounds bounds = bounds_of_cloth(frame);
  if (bounds.empty()) bounds = bounds_of_liquid(frame);
  if (bounds.empty()) return;
  const Vec3 size = bounds.size();
  const Real low = std::min(ground, bounds.lower.z);
  const Real off = 0.04 * std::max(size.x, size.y);
  struct Edge {
    Vec3 from, to;
  };
  const Vec3 a{bounds.lower.x, bounds.lower.y, low}, b{bounds.upper.x, bounds.upper.y, low};
  const Edge edges[4] = {{{a.x, a.y - off, low}, {b.x, a.y - off, low}},
                         {{b.x + off, a.y, low}, {b.x + off, b.y, low}},
                         {{b.x, b.y + off, low}, {a.x, b.y + off, low}},
                         {{a.x - off, b.y, low}, {a.x - off, a.y, low}}};
  // The lowest edge in the picture; of two, the one that lies flatter. Not one of an upright cloth's thickness.
  const auto score = [&](const Edge& e) {
    if (norm(e.to - e.from) < 0.2 * std::max(size.x, size.y)) return -std::numeric_limits<Real>::infinity();
    const ImagePoint p = project(camera, e.from), q = project(camera, e.to);
    return std::max(p.y, q.y) + 0.5 * (p.y + q.y) + 0.3 * std::abs(p.x - q.x);
  };
  const Edge& edge = *std::max_element(std::begin(edges), std::end(edges),
                                       [&](const Edge& p, const Edge& q) { return score(p) < score(q); });
  Vec3 start = edge.from, end = edge.to;
  if (project(camera, start).x > project(camera, end).x) std::swap(start, end);
  const Real whole = norm(end - start), length = round_length(0.3 * whole);
  end = start + (length / whole) * (end - start);
  const ImagePoint p = project(camera, start), q = project(camera, end);
  if (p.depth <= 0 || q.depth <= 0) return;
  const Real x0 = p.x * image.width, y0 = p.y * image.height, x1 = q.x * image.width, y1 = q.y * image.height;
  const TextStyle style{.height = 0.9 * unit, .align = TextAlign::centre, .halo_opacity = 0.85f};
  const std::string label = length_label(length);
  const Real half = 0.5 * text_width(label, style.height) + 4;
  const Real x = 0.5 * (x0 + x1), y = std::max(y0, y1) + 1.6 * unit;
  const bool inside = std::min(x0, x - half) > 2 && std::max(x1, x + half) < image.width - 2 && y + 0.4 * unit < image.height - 2;
  if (!inside) return;  // a camera of the user's that leaves no room: no bar rather than half a bar
  draw_line(image, x0, y0, x1, y1, 0.16 * unit + 1, style.colour);
  const Real tick = 0.32 * unit;
  for (const auto& [tx, ty] : {std::pair{x0, y0}, std::pair{x1, y1}}) draw_line(image, tx, ty - tick, tx, ty + tick, 0.10 * unit + 1, style.colour);
  draw_text(image, x, y, label, style);
}

}  // namespace

Real round_length(Real length) {
  const Real power = std::pow(10.0, std::floor(std::log10(length) + 1e-9));
  for (const Real step : {5.0, 2.0})
    if (step * power <= length * (1 + 1e-9)) return step * power;
  return power;
}

std::string time_label(Real seconds) {
  if (seconds < 10) return fmt::format("t = {:.3f} s", seconds);
  if (seconds < 60) return fmt::format("t = {:.1f} s", seconds);
  const auto whole = static_cast<long long>(std::floor(seconds + 0.5));
  if (whole < 3600) return fmt::format("t = {} min {:02} s", whole / 60, whole % 60);
  return fmt::format("t = {} h {:02} min", whole / 3600, whole / 60 % 60);
}

void draw_overlay(Image& image, const Frame& frame, const Camera& camera, Real ground) {
  // Everything scales with the picture, so that a small one has small lettering and nothing runs out of it.
  const Real unit = std::max(6.0, std::min(image.height / 45.0, image.width / 75.0));
  const Real margin = 1.6 * unit;
  if (!frame.title.empty()) {
    const Real room = image.width - 2 * margin;
    TextStyle title{.height = fitted_text_height(frame.title, 1.35 * unit, room), .weight = 0.14, .halo_opacity = 0.8f};
    draw_text(image, margin, margin + 1.35 * unit, frame.title, title);
  }
  const TextStyle time{.height = 1.05 * unit, .colour = {0.28f, 0.30f, 0.36f}, .halo_opacity = 0.8f};
  draw_text(image, margin, margin + (frame.title.empty() ? 1.1 : 3.5) * unit, time_label(frame.time), time);
  if (frame.yarns.yarns() > 0) {
    LegendLayout layout;
    layout.right = image.width - static_cast<int>(margin);
    layout.top = static_cast<int>(std::max(0.20 * image.height, 5.5 * unit));
    layout.bottom = image.height - static_cast<int>(std::max(0.13 * image.height, 2 * unit));
    layout.text_height = unit;
    // A veil behind it that begins softly, for cameras that do not leave room.
    const int left = layout.right - static_cast<int>(text_width(frame.quantity, unit) + 2.5 * unit);
    for (int x = left; x < image.width; ++x) {
      const float veil = std::min(0.8f, static_cast<float>((x - left) / (4 * unit)));
      fill_rectangle(image, x, layout.top - static_cast<int>(unit), x + 1, layout.bottom + static_cast<int>(unit), {1, 1, 1}, veil);
    }
    draw_colour_bar(image, layout, frame.quantity, frame.quantity_unit);
  }
  draw_scale_bar(image, frame, camera, ground, unit);
}

}  // namespace imbibe
