#include "imbibe/view/picture.h"

#include <gtest/gtest.h>

#include "imbibe/core/parallel.h"
#include "imbibe/view/pixel_samples.h"
#include "imbibe/view/shading.h"
#include "view/scenes.h"

namespace imbibe {
namespace {

PictureOptions small(PictureStyle style) {
  PictureOptions options;
  options.style = style;
  options.width = 160, options.height = 90, options.samples = 4;
  return options;
}

struct Shares {
  Real white = 0, blue = 0, dark = 0;
};
Shares shares_of(const Image& image) {
  Shares s;
  const Real one = 1.0 / (image.width * image.height);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const std::uint8_t* p = image.pixel(x, y);
      if (p[0] > 245 && p[1] > 245 && p[2] > 245) s.white += one;
      if (p[2] > p[0] + 40) s.blue += one;
      if (p[0] < 90 && p[1] < 90 && p[2] < 90) s.dark += one;
    }
  return s;
}

TEST(Picture, IsTheSameForOneAndForTwoThreads) {
  for (const PictureStyle style : {PictureStyle::diagram, PictureStyle::natural}) {
    const Frame frame = test::drop_on_weave();
    const PictureOptions options = small(style);
    Image one, two;
    {
      const ThreadLimit limit(1);
      one = draw_picture(frame, options);
    }
    {
      const ThreadLimit limit(2);
      two = draw_picture(frame, options);
    }
    EXPECT_TRUE(one == two);
  }
}

TEST(Picture, DiagramShowsBlueClothOnWhitePaper) {
  const Shares wet = shares_of(draw_picture(test::drop_on_weave(), small(PictureStyle::diagram)));
  EXPECT_GT(wet.white, 0.2);
  EXPECT_GT(wet.blue, 0.03);
  Frame dry = test::woven_frame(8, 1e-9);
  PictureOptions options = small(PictureStyle::diagram);
  options.legend = false;
  EXPECT_LT(shares_of(draw_picture(dry, options)).blue, 1e-3) << "dry cloth is white";
}

TEST(Picture, NaturalStyleShowsWetClothDarker) {
  const PictureOptions options = small(PictureStyle::natural);
  const auto brightness_of = [&](float saturation) {
    Frame frame = test::woven_frame(8, 1);
    std::fill(frame.yarns.saturation.begin(), frame.yarns.saturation.end(), saturation);
    const Image image = draw_picture(frame, options);
    const std::uint8_t* p = image.pixel(0, 0);
    Real sum = 0;
    for (int y = 35; y < 55; ++y)
      for (int x = 65; x < 95; ++x) sum += image.pixel(x, y)[1];
    return sum / 600 + 0 * p[0];
  };
  EXPECT_LT(brightness_of(1), 0.9 * brightness_of(0));
}

TEST(Picture, AnEmptyFrameIsABlankPageNotAnError) {
  const Image image = draw_picture(Frame{}, small(PictureStyle::diagram));
  EXPECT_GT(shares_of(image).white, 0.8);
}

TEST(Picture, SolidsAndLiquidWithoutClothAreDrawn) {
  Frame frame;
  frame.solids.push_back({Cone{{0, 0, 0}, {0, 0, 1}, 5e-3, 6e-3}, {}, {0.6f, 0.3f, 0.2f}});
  frame.solids.push_back({Plane{{0, 0, 0}, {0, 0, 1}}, {}, {0.5f, 0.5f, 0.5f}});
  frame.particle_spacing = 0.5e-3;
  frame.particles = test::ball_of_particles({0, 0, 8e-3}, 2e-3, 0.5e-3);
  const Image image = draw_picture(frame, small(PictureStyle::diagram));
  EXPECT_LT(shares_of(image).white, 0.98);
  EXPECT_GT(shares_of(image).blue, 0.005);
}

TEST(Picture, EachPictureOfASeriesIsThatOfItsFrameAlone) {
  for (const PictureStyle style : {PictureStyle::diagram, PictureStyle::natural}) {
    PictureOptions options = small(style);
    options.width = 256, options.height = 144;
    Frame frame = test::drop_on_weave();
    const Stage stage = stage_for(frame, options);
    PictureSeries series(stage, options);
    for (int step = 0; step < 4; ++step) {
      frame.time = 0.1 * step;
      // The drop sinks and shrinks, the stain grows; at last the drop is gone.
      frame.particles = step < 3 ? test::ball_of_particles({0.2e-3 * step, 0, 2e-3 - 0.4e-3 * step}, (1.4 - 0.3 * step) * 1e-3, frame.particle_spacing)
                                 : std::vector<Vec3f>{};
      frame.yarns.saturation = test::woven_frame(8, (1 + 0.5 * step) * 1e-3).yarns.saturation;
      EXPECT_TRUE(series.draw(frame) == draw_picture(frame, stage, options)) << "frame " << step;
    }
    series.draw(frame);
    EXPECT_EQ(series.traced_share(), 0) << "nothing changed, nothing is traced";
  }
}

TEST(Picture, FallingDropsDoNotMakeTheFilmTraceEverything) {
  PictureOptions options = small(PictureStyle::diagram);
  options.width = 320, options.height = 180;
  Frame frame = test::drop_on_weave();
  PictureSeries series(stage_for(frame, options), options);
  series.draw(frame);
  EXPECT_EQ(series.traced_share(), 1);
  for (Vec3f& p : frame.particles) p.z -= 0.1e-3f;
  series.draw(frame);
  EXPECT_LT(series.traced_share(), 0.6);
}

TEST(Shading, FresnelReflectanceHasItsKnownValues) {
  const float n = 1.333f, straight = (n - 1) * (n - 1) / ((n + 1) * (n + 1));
  EXPECT_NEAR(fresnel_reflectance(1, 1, n), straight, 1e-6);
  EXPECT_NEAR(fresnel_reflectance(1, n, 1), straight, 1e-6);
  EXPECT_NEAR(fresnel_reflectance(0, 1, n), 1, 1e-5);
  EXPECT_EQ(fresnel_reflectance(std::cos(radians(49.0)), n, 1), 1) << "beyond the critical angle, 48.6 degrees";
  EXPECT_LT(fresnel_reflectance(std::cos(radians(48.0)), n, 1), 1);
  // At Brewster's angle only one polarisation is reflected: half of ((n^2 - 1) / (n^2 + 1))^2.
  const float share = (n * n - 1) / (n * n + 1);
  EXPECT_NEAR(fresnel_reflectance(std::cos(std::atan(n)), 1, n), share * share / 2, 1e-6);
}

TEST(Shading, WetClothIsDarkerTheWetterItIsAndKeepsItsHue) {
  const Vec3f dry{0.8f, 0.7f, 0.5f};
  EXPECT_EQ(wet_colour(dry, 0), dry);
  Vec3f before = dry;
  for (float s = 0.1f; s <= 1; s += 0.1f) {
    const Vec3f wet = wet_colour(dry, s);
    EXPECT_LT(wet.x, before.x);
    EXPECT_GT(wet.x, wet.y);
    EXPECT_GT(wet.y, wet.z);
    before = wet;
  }
}

TEST(PixelSamples, SixteenSamplesFallOnePerCellOfAFourByFourGrid) {
  for (std::uint64_t purpose = 0; purpose < 20; ++purpose) {
    int cells[16] = {};
    for (std::uint32_t i = 0; i < 16; ++i) {
      const Pair p = PixelSamples(1234, i).pair(purpose);
      ASSERT_GE(p.u, 0);
      ASSERT_LT(p.u, 1);
      ++cells[static_cast<int>(4 * p.u) + 4 * static_cast<int>(4 * p.v)];
    }
    for (const int count : cells) EXPECT_EQ(count, 1);
  }
}

}  // namespace
}  // namespace imbibe
