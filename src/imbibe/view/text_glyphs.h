// The strokes of the lettering (text.h). Our own drawing: an upright linear sans on a grid where the baseline is 0, a
// capital 20 high, a small letter 14, a descender -6. Strokes are divided by '|':
//   L x y x y ...               straight line through the points
//   S x y x y ...               smooth curve through the points
//   E cx cy rx ry from to       arc of an ellipse, degrees, counter-clockwise when to > from
#pragma once

#include <string_view>

namespace imbibe::detail {

struct Glyph {
  char32_t code;
  double width;  // of the ink box, 0 at its left
  std::string_view strokes;
};

inline constexpr double glyph_capital = 20, glyph_spacing = 4.4, glyph_space = 7.5, glyph_descender = 7;

// The glyph of a character; a box for one that has none. White space has no strokes.
const Glyph& glyph_of(char32_t code);

}  // namespace imbibe::detail
