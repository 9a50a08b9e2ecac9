// Lettering of pictures: a stroke font of our own (glyphs in text_glyphs.cpp), drawn with round pens and exact coverage
// by distance, so it is sharp at any size and needs no font file. UTF-8; a character without a glyph shows as a box.
#pragma once

#include <string_view>

#include "imbibe/core/types.h"
#include "imbibe/view/image.h"

namespace imbibe {

enum class TextAlign { left, centre, right };

struct TextStyle {
  Real height = 16;            // px, of a capital letter
  Real weight = 0.13;          // pen width / height
  Vec3f colour{0.10f, 0.11f, 0.14f};  // sRGB
  TextAlign align = TextAlign::left;
  Vec3f halo{1, 1, 1};         // sRGB, outline that keeps text legible on any ground
  float halo_opacity = 0;
};

// Width of one line, px, from the first ink to the end of the last letter.
Real text_width(std::string_view text, Real height);

// Draws one line with its baseline at y and its left end, centre or right end at x.
void draw_text(Image& image, Real x, Real y, std::string_view text, const TextStyle& style);

// The text height at which `text` is at most `width` wide, not above `height`.
Real fitted_text_height(std::string_view text, Real height, Real width);

}  // namespace imbibe
