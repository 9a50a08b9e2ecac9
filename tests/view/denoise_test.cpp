#include "imbibe/view/denoise.h"

#include <gtest/gtest.h>

#include "imbibe/core/random.h"

namespace imbibe {
namespace {

constexpr int width = 48, height = 32;

// Left half dark, right half bright, both with noise.
std::vector<TracedPixel> two_halves(Real noise) {
  std::vector<TracedPixel> pixels;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      TracedPixel p;
      const Real light = (x < width / 2 ? 0.3 : 0.9) * (1 + noise * (uniform({1, static_cast<std::uint64_t>(y * width + x)}) - 0.5));
      p.light = Vec3f(Vec3{light, light, light});
      p.surface = {0.5f, 0.5f, 0.5f};
      p.normal = x < width / 2 ? Vec3f{0, 0, 1} : Vec3f{1, 0, 0};
      p.depth = 1;
      pixels.push_back(p);
    }
  return pixels;
}

struct Spread {
  Real mean = 0, deviation = 0;
};
Spread spread_of(const std::vector<Vec3f>& light, int x0, int x1) {
  Real sum = 0, squares = 0;
  int n = 0;
  for (int y = 0; y < height; ++y)
    for (int x = x0; x < x1; ++x, ++n) {
      const Real v = light[static_cast<std::size_t>(y * width + x)].x;
      sum += v, squares += v * v;
    }
  return {sum / n, std::sqrt(std::max(0.0, squares / n - sum / n * sum / n))};
}

TEST(Denoise, TakesMostOfTheGrainAndKeepsTheEdge) {
  const auto noisy = two_halves(0.5);
  const auto calm = denoised(noisy, width, height, {0, 0, width, height}, 1e-3f);
  const Spread dark = spread_of(calm, 0, width / 2), bright = spread_of(calm, width / 2, width);
  // Uniform noise of +-25 %: deviation 14 % before; 25 pixels of unequal weight leave about a third.
  EXPECT_LT(dark.deviation, 0.05 * 0.3);
  EXPECT_LT(bright.deviation, 0.05 * 0.9);
  EXPECT_NEAR(dark.mean, 0.3, 0.01);
  EXPECT_NEAR(bright.mean, 0.9, 0.02);
}

TEST(Denoise, LeavesEvenLightAloneAndKeepsThePatternOfTheSurface) {
  auto pixels = two_halves(0);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    // A fine pattern of the cloth itself under even light.
    const float colour = i % 3 == 0 ? 0.2f : 0.8f;
    pixels[i].surface = {colour, colour, colour};
    pixels[i].light = pixels[i].surface * 0.7f;
    pixels[i].normal = {0, 0, 1};
  }
  const auto calm = denoised(pixels, width, height, {0, 0, width, height}, 1e-3f);
  for (std::size_t i = 0; i < pixels.size(); ++i) EXPECT_NEAR(calm[i].x, pixels[i].light.x, 1e-5);
}

TEST(Denoise, APartOfThePictureIsFilteredAsTheWholeIs) {
  const auto noisy = two_halves(0.8);
  const auto whole = denoised(noisy, width, height, {0, 0, width, height}, 1e-3f);
  const PixelBox box{16, 0, 32, 16};
  const auto part = denoised(noisy, width, height, box, 1e-3f);
  std::size_t n = 0;
  for (int y = box.y0; y < box.y1; ++y)
    for (int x = box.x0; x < box.x1; ++x) EXPECT_EQ(part[n++], whole[static_cast<std::size_t>(y * width + x)]);
}

}  // namespace
}  // namespace imbibe
