#include "imbibe/view/text.h"

#include <gtest/gtest.h>

#include <string>

#include "imbibe/view/overlay.h"
#include "imbibe/view/text_glyphs.h"

namespace imbibe {
namespace {

struct Ink {
  int left = 1 << 20, right = -1, top = 1 << 20, bottom = -1;
};

Ink ink_of(const Image& image) {
  Ink ink;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (image.pixel(x, y)[1] < 250) {
        ink.left = std::min(ink.left, x), ink.right = std::max(ink.right, x);
        ink.top = std::min(ink.top, y), ink.bottom = std::max(ink.bottom, y);
      }
  return ink;
}

TEST(Text, EveryPrintableCharacterHasItsOwnGlyphWithInk) {
  const auto& unknown = detail::glyph_of(U'\u4E00');
  std::u32string wanted;
  for (char32_t c = U'!'; c <= U'~'; ++c) wanted += c;
  wanted += U"\u00B0\u00B2\u00B3\u00B5\u00D7\u00B7\u2013\u2212\u03B8\u03B3";
  for (const char32_t c : wanted) {
    const auto& glyph = detail::glyph_of(c);
    EXPECT_NE(&glyph, &unknown) << "code " << static_cast<unsigned>(c);
    EXPECT_FALSE(glyph.strokes.empty()) << "code " << static_cast<unsigned>(c);
  }
}

TEST(Text, EveryGlyphStaysWithinItsWidthAndHeight) {
  // A pen of weight 0.1 and one pixel of smoothing reach beyond the strokes; nothing else may.
  const Real height = 60, reach = 0.05 * height + 1.5;
  for (char c = '!'; c <= '~'; ++c) {
    Image image(200, 160);
    const std::string text(1, c);
    draw_text(image, 60, 110, text, {.height = height, .weight = 0.1});
    const Ink ink = ink_of(image);
    ASSERT_GE(ink.right, 0) << text;
    EXPECT_GE(ink.left, 60 - reach) << text;
    EXPECT_LE(ink.right, 60 + text_width(text, height) + reach) << text;
    EXPECT_GE(ink.top, 110 - 1.2 * height - reach) << text;
    EXPECT_LE(ink.bottom, 110 + 0.35 * height + reach) << text;
  }
}

TEST(Text, WidthIsWhereTheInkEnds) {
  for (const TextAlign align : {TextAlign::left, TextAlign::centre, TextAlign::right}) {
    Image image(400, 60);
    const std::string words = "Liquid H";  // begins and ends with upright strokes
    draw_text(image, 200, 40, words, {.height = 20, .align = align});
    const Real width = text_width(words, 20);
    const Real left = align == TextAlign::left ? 200 : align == TextAlign::centre ? 200 - width / 2 : 200 - width;
    const Ink ink = ink_of(image);
    EXPECT_NEAR(ink.left, left, 2.5);  // half a pen, and a pixel
    EXPECT_NEAR(ink.right, left + width, 2.5);
  }
}

TEST(Text, TextThatIsTooWideIsMadeSmallerUntilItFits) {
  const std::string title(120, 'W');
  const Real height = fitted_text_height(title, 20, 500);
  EXPECT_LT(height, 20);
  EXPECT_NEAR(text_width(title, height), 500, 1e-9);
  EXPECT_EQ(fitted_text_height("W", 20, 500), 20);
}

TEST(Text, BrokenUtf8IsDrawnAndNeverReadBeyondItsEnd) {
  for (const std::string& text : {std::string("\xC3"), std::string("a\xFF\x62"), std::string("\xE2\x82"), std::string("\xF0")}) {
    Image image(100, 40);
    draw_text(image, 5, 30, text, {.height = 16});
    EXPECT_GT(text_width(text, 16), 0);
  }
  EXPECT_EQ(text_width("", 16), 0);
  EXPECT_NEAR(text_width("\xC2\xB5m", 16), text_width("\xCE\xBCm", 16), 1e-12) << "both signs for micro";
}

TEST(Text, TextOutsideThePictureDoesNoHarm) {
  Image image(50, 50);
  draw_text(image, -500, 30, "far left of it", {.height = 16});
  draw_text(image, 30, 5000, "far below it", {.height = 16});
  EXPECT_EQ(ink_of(image).right, -1);
}

TEST(Overlay, TimesReadWellFromMillisecondsToHours) {
  EXPECT_EQ(time_label(0), "t = 0.000 s");
  EXPECT_EQ(time_label(0.35), "t = 0.350 s");
  EXPECT_EQ(time_label(12.52), "t = 12.5 s");
  EXPECT_EQ(time_label(200), "t = 3 min 20 s");
  EXPECT_EQ(time_label(3900), "t = 1 h 05 min");
}

TEST(Overlay, ScaleBarsAreOneTwoOrFive) {
  EXPECT_DOUBLE_EQ(round_length(0.0123), 0.01);
  EXPECT_DOUBLE_EQ(round_length(0.0049), 0.002);
  EXPECT_DOUBLE_EQ(round_length(0.9), 0.5);
  EXPECT_DOUBLE_EQ(round_length(0.01), 0.01);
}

}  // namespace
}  // namespace imbibe
