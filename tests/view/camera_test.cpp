#include "imbibe/view/camera.h"

#include <gtest/gtest.h>

#include "view/scenes.h"

namespace imbibe {
namespace {

TEST(Camera, ProjectionAndDirectionAreInverse) {
  const std::vector<Vec3> content{{0, 0, 0}, {0.1, 0.05, 0.02}};
  const Camera camera = fitted_camera(content, PictureOptions{}, Margins{});
  for (const auto& [x, y] : {std::pair{0.5, 0.5}, std::pair{0.1, 0.9}, std::pair{0.8, 0.3}}) {
    const ImagePoint p = project(camera, camera.eye + 0.37 * direction_through(camera, x, y));
    EXPECT_NEAR(p.x, x, 1e-12);
    EXPECT_NEAR(p.y, y, 1e-12);
  }
}

TEST(Camera, FittedContentLiesWithinTheMarginsAndTouchesTwoOfThem) {
  const Margins margins{0.03, 0.15, 0.10, 0.11};
  for (const PictureView view : {PictureView::three_quarter, PictureView::top, PictureView::side}) {
    PictureOptions options;
    options.camera.view = view;
    const std::vector<Vec3> content = content_of(test::drop_on_weave());
    const Camera camera = fitted_camera(content, options, margins);
    Real left = 1, right = 0, top = 1, bottom = 0;
    for (const Vec3& p : content) {
      const ImagePoint at = project(camera, p);
      ASSERT_GT(at.depth, 0);
      left = std::min(left, at.x), right = std::max(right, at.x);
      top = std::min(top, at.y), bottom = std::max(bottom, at.y);
    }
    EXPECT_GE(left, margins.left - 1e-9);
    EXPECT_LE(right, 1 - margins.right + 1e-9);
    EXPECT_GE(top, margins.top - 1e-9);
    EXPECT_LE(bottom, 1 - margins.bottom + 1e-9);
    // As near as it can be: the content fills the width or the height.
    const Real wide = (right - left) / (1 - margins.left - margins.right), high = (bottom - top) / (1 - margins.top - margins.bottom);
    EXPECT_NEAR(std::max(wide, high), 1, 1e-9);
  }
}

TEST(Camera, AGivenEyeAndTargetAreTakenAsTheyAre) {
  PictureOptions options;
  options.camera.eye = Vec3{1, 2, 3};
  options.camera.target = Vec3{0, 0, 0};
  const std::vector<Vec3> content{{5, 5, 5}};
  const Camera camera = fitted_camera(content, options, Margins{});
  EXPECT_EQ(camera.eye, (Vec3{1, 2, 3}));
  const ImagePoint middle = project(camera, {0, 0, 0});
  EXPECT_NEAR(middle.x, 0.5, 1e-12);
  EXPECT_NEAR(middle.y, 0.5, 1e-12);
  EXPECT_GT(project(camera, {0, 0, -0.1}).y, 0.5) << "z is up";
}

}  // namespace
}  // namespace imbibe
