// The colour bar of seed A section 6 (Fig. 6): eleven colours. No liquid is opaque white; ten levels of blue follow,
// value and opacity evenly spaced, up to opaque blue at saturation.
//   level(s) = 0 for s <= 0 (less than half a per mille), else ceil(10 s), at most 10;  opacity(level) = level / 10, opacity(0) = 1
// Seed A gives no numbers for the blue; ours is full_blue below, and level k is blue of opacity k/10 over white.
// Tested in tests/view/colour_bar_test.cpp.
#pragma once

#include <array>
#include <string>

#include "imbibe/core/types.h"
#include "imbibe/view/image.h"

namespace imbibe {

inline constexpr int colour_levels = 11;
inline constexpr Vec3f full_blue{0.05f, 0.20f, 0.72f};  // sRGB, 0..1: the saturated end
inline constexpr float dry_below = 5e-4f;               // saturation shown as none: half of the last label digit, 0.1 %

struct BarColour {
  Vec3f colour{1, 1, 1};  // sRGB, 0..1
  float opacity = 1;
};

int colour_level(float saturation);         // 0..10
BarColour colour_of_level(int level);
BarColour colour_of_saturation(float saturation);
// The bar's colour as seen over `ground` (sRGB).
Vec3f over(const BarColour& bar, const Vec3f& ground);

struct LegendLayout {
  int right = 0, top = 0, bottom = 0;  // px: the bar and its labels end at `right`, between top and bottom
  Real text_height = 14;               // px
};

// Draws the bar with its 0..100 labels, and `quantity` and `unit` as its heading.
void draw_colour_bar(Image& image, const LegendLayout& layout, const std::string& quantity, const std::string& unit);

}  // namespace imbibe
