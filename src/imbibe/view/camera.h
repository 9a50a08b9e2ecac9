// A pinhole camera, given or fitted to what a frame shows.
#pragma once

#include <span>
#include <vector>

#include "imbibe/scene/picture_options.h"
#include "imbibe/view/frame.h"

namespace imbibe {

struct Camera {
  Vec3 eye{};
  Vec3 right{1, 0, 0}, up{0, 0, 1}, forward{0, 1, 0};  // unit
  Real tan_half_height = 0.25;
  Real aspect = 16.0 / 9;
};

// Position in the image, 0..1 from the top left, and depth along `forward` (m).
struct ImagePoint {
  Real x = 0, y = 0, depth = 0;
};
ImagePoint project(const Camera& camera, const Vec3& point);
// Unit direction through image position (x, y), 0..1 from the top left.
Vec3 direction_through(const Camera& camera, Real x, Real y);

// The picture area that content may fill, 0..1.
struct Margins {
  Real left = 0.05, right = 0.05, top = 0.05, bottom = 0.05;
};

// The nearest place from which all of `content` lies within the margins, looking as the options say.
Camera fitted_camera(std::span<const Vec3> content, const PictureOptions& options, const Margins& margins);

// The points a fitted camera keeps in view: cloth, and solids and liquid that are not far from it.
std::vector<Vec3> content_of(const Frame& frame);
// Leaves room for the legend where there is one.
Camera camera_for(std::span<const Vec3> content, const PictureOptions& options);

}  // namespace imbibe
