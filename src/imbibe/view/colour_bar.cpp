#include "imbibe/view/colour_bar.h"

#include <algorithm>
#include <cmath>

#include "imbibe/core/error.h"
#include "imbibe/view/text.h"

namespace imbibe {

int colour_level(float saturation) {
  if (!(saturation >= dry_below)) return 0;
  // A hair below the boundary, so that 0.3f, which is a little more than 3/10, is still level 3.
  const int level = static_cast<int>(std::ceil(10 * saturation - 1e-5f));
  return std::clamp(level, 1, colour_levels - 1);
}

BarColour colour_of_level(int level) {
  IMBIBE_ASSERT(level >= 0 && level < colour_levels);
  if (level == 0) return {};
  // Value (the largest component) falls evenly from 1 to that of full blue; hue and saturation of colour stay.
  const float share = static_cast<float>(level) / (colour_levels - 1);
  const float full_value = std::max({full_blue.x, full_blue.y, full_blue.z});
  const float value = 1 + (full_value - 1) * share;
  return {full_blue * (value / full_value), share};
}

BarColour colour_of_saturation(float saturation) { return colour_of_level(colour_level(saturation)); }

Vec3f over(const BarColour& bar, const Vec3f& ground) {
  return bar.opacity * bar.colour + (1 - bar.opacity) * ground;
}

namespace {

void outline(Image& image, int x0, int y0, int x1, int y1, const Vec3f& colour) {
  fill_rectangle(image, x0, y0, x1, y0 + 1, colour);
  fill_rectangle(image, x0, y1 - 1, x1, y1, colour);
  fill_rectangle(image, x0, y0, x0 + 1, y1, colour);
  fill_rectangle(image, x1 - 1, y0, x1, y1, colour);
}

}  // namespace

void draw_colour_bar(Image& image, const LegendLayout& layout, const std::string& quantity, const std::string& unit) {
  const Vec3f ink{0.10f, 0.11f, 0.14f};
  const Real text = layout.text_height;
  TextStyle style{.height = text, .colour = ink};

  // Heading: quantity, below it the unit; both end at the right edge so that they never leave the picture.
  style.align = TextAlign::right;
  draw_text(image, layout.right, layout.top + text, quantity, style);
  TextStyle small = style;
  small.height = 0.82 * text;
  draw_text(image, layout.right, layout.top + 2.35 * text, unit, small);

  const int gap = std::max(2, static_cast<int>(0.35 * text));
  const int bar_top = layout.top + static_cast<int>(3.6 * text);
  const int box = std::max(4, (layout.bottom - bar_top - gap) / colour_levels);
  const int width = static_cast<int>(1.9 * text);
  const int x1 = layout.right - static_cast<int>(text_width("100", small.height) + 1.2 * text);
  const int x0 = x1 - width;
  const int bar_bottom = bar_top + (colour_levels - 1) * box;

  const auto label = [&](Real y, const std::string& words, bool tick) {
    if (tick) fill_rectangle(image, x1, static_cast<int>(y), x1 + static_cast<int>(0.4 * text), static_cast<int>(y) + 1, ink);
    draw_text(image, layout.right, y + 0.5 * small.height, words, small);
  };
  for (int level = 1; level < colour_levels; ++level) {
    const int y0 = bar_bottom - level * box;
    fill_rectangle(image, x0, y0, x1, y0 + box, over(colour_of_level(level), {1, 1, 1}));
    label(y0, std::to_string(10 * level), true);
  }
  outline(image, x0, bar_top, x1, bar_bottom, ink);
  // White, "no liquid", stands apart: it is one value, not a range.
  const int dry_top = bar_bottom + gap;
  fill_rectangle(image, x0, dry_top, x1, dry_top + box, colour_of_level(0).colour);
  outline(image, x0, dry_top, x1, dry_top + box, ink);
  label(dry_top + 0.5 * box, "0", false);
}

}  // namespace imbibe
