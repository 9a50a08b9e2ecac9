#include "imbibe/view/colour_bar.h"

#include <gtest/gtest.h>

#include <set>

namespace imbibe {
namespace {

TEST(ColourBar, HasElevenLevelsWhiteForDryAndTenEvenSteps) {
  EXPECT_EQ(colour_level(0), 0);
  EXPECT_EQ(colour_level(-0.1f), 0);
  EXPECT_EQ(colour_level(0.01f), 1);
  for (int level = 1; level <= 10; ++level) {
    EXPECT_EQ(colour_level(static_cast<float>(level) / 10), level) << "the upper end of a step belongs to it";
    EXPECT_EQ(colour_level((static_cast<float>(level) - 0.5f) / 10), level);
  }
  EXPECT_EQ(colour_level(1.2f), 10) << "over-full shows as full";
  EXPECT_EQ(colour_level(std::numeric_limits<float>::quiet_NaN()), 0);
}

TEST(ColourBar, DryIsOpaqueWhiteAndSaturatedIsOpaqueBlue) {
  const BarColour dry = colour_of_saturation(0), full = colour_of_saturation(1);
  EXPECT_EQ(dry.colour, (Vec3f{1, 1, 1}));
  EXPECT_EQ(dry.opacity, 1);
  EXPECT_EQ(full.opacity, 1);
  EXPECT_NEAR(full.colour.x, full_blue.x, 1e-6);
  EXPECT_NEAR(full.colour.z, full_blue.z, 1e-6);
  EXPECT_EQ(over(full, {0, 1, 0}).y, full.colour.y) << "nothing shows through the saturated colour";
}

TEST(ColourBar, OpacityAndValueRiseInEqualSteps) {
  for (int level = 1; level < 10; ++level) {
    const BarColour a = colour_of_level(level), b = colour_of_level(level + 1);
    EXPECT_NEAR(b.opacity - a.opacity, 0.1, 1e-6);
    EXPECT_NEAR(a.colour.z - b.colour.z, (1 - full_blue.z) / 10, 1e-6);  // value = the largest component, blue
    EXPECT_LT(over(b, {1, 1, 1}).x, over(a, {1, 1, 1}).x) << "darker on white with every step";
  }
}

TEST(ColourBar, LegendShowsAllElevenColoursAndStaysInsideThePicture) {
  Image image(300, 500, 200);
  const LegendLayout layout{.right = 280, .top = 40, .bottom = 460, .text_height = 14};
  draw_colour_bar(image, layout, "Liquid content", "% of saturation");
  std::set<std::array<int, 3>> colours;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const std::uint8_t* p = image.pixel(x, y);
      colours.insert({p[0], p[1], p[2]});
      const bool outside = x >= layout.right + 2 || y < layout.top - 2 || y >= layout.bottom + 8;
      if (outside) {
        ASSERT_EQ(p[0], 200) << "ink at " << x << ", " << y;
      }
    }
  for (int level = 0; level < colour_levels; ++level) {
    const Vec3f c = over(colour_of_level(level), {1, 1, 1}) * 255.0f;
    EXPECT_TRUE(colours.contains({static_cast<int>(c.x + 0.5f), static_cast<int>(c.y + 0.5f), static_cast<int>(c.z + 0.5f)}))
        << "level " << level;
  }
}

}  // namespace
}  // namespace imbibe
