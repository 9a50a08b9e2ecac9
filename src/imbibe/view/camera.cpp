#include "imbibe/view/camera.h"

#include <algorithm>

#include "imbibe/core/error.h"

namespace imbibe {

namespace {

// The axes of a camera that looks along `forward`, with its horizon level.
void level(Camera& camera, const Vec3& forward) {
  camera.forward = normalized(forward);
  // Straight down or up there is no horizon: the picture's up is then +y.
  const Vec3 side = cross(camera.forward, Vec3{0, 0, 1});
  camera.right = squared_norm(side) > 1e-12 ? normalized(side) : Vec3{1, 0, 0};
  camera.up = cross(camera.right, camera.forward);
}

Vec3 view_direction(const CameraOptions& options) {
  if (options.view == PictureView::top) return {0, 0, -1};
  const Real elevation = options.view == PictureView::side ? radians(4) : options.elevation;
  return -Vec3{std::cos(elevation) * std::cos(options.azimuth), std::cos(elevation) * std::sin(options.azimuth),
               std::sin(elevation)};
}

// One picture axis of the fit. Seen from depth c, a point (p along the axis, d deep) lies within the slopes [low, high]
// when p - high (d - c) <= eye <= p - low (d - c). The bounds over all points meet at the greatest c that still works.
struct AxisFit {
  Real low, high;                 // slopes of the usable picture area
  Real most = -1e300, least = 1e300;  // max(p - high d), min(p - low d)

  void include(Real p, Real d) {
    most = std::max(most, p - high * d);
    least = std::min(least, p - low * d);
  }
  Real greatest_depth() const { return (least - most) / (high - low); }
  Real eye(Real c) const { return 0.5 * (most + high * c + least + low * c); }
};

void include_corners(std::vector<Vec3>& content, const Bounds& b) {
  if (b.empty()) return;
  for (int c = 0; c < 8; ++c)
    content.push_back({c & 1 ? b.upper.x : b.lower.x, c & 2 ? b.upper.y : b.lower.y, c & 4 ? b.upper.z : b.lower.z});
}

Bounds intersection(const Bounds& a, const Bounds& b) {
  Bounds r;
  r.lower = {std::max(a.lower.x, b.lower.x), std::max(a.lower.y, b.lower.y), std::max(a.lower.z, b.lower.z)};
  r.upper = {std::min(a.upper.x, b.upper.x), std::min(a.upper.y, b.upper.y), std::min(a.upper.z, b.upper.z)};
  const bool nothing = r.lower.x > r.upper.x || r.lower.y > r.upper.y || r.lower.z > r.upper.z;
  return nothing ? Bounds{} : r;
}

}  // namespace

ImagePoint project(const Camera& camera, const Vec3& point) {
  const Vec3 offset = point - camera.eye;
  const Real depth = dot(offset, camera.forward), scale = 1 / (depth * camera.tan_half_height);
  return {0.5 + 0.5 * dot(offset, camera.right) * scale / camera.aspect, 0.5 - 0.5 * dot(offset, camera.up) * scale, depth};
}

Vec3 direction_through(const Camera& camera, Real x, Real y) {
  const Real across = (2 * x - 1) * camera.tan_half_height * camera.aspect, up = (1 - 2 * y) * camera.tan_half_height;
  return normalized(camera.forward + across * camera.right + up * camera.up);
}

Camera fitted_camera(std::span<const Vec3> content, const PictureOptions& options, const Margins& margins) {
  IMBIBE_ASSERT(!content.empty());
  Camera camera;
  const CameraOptions& wish = options.camera;
  camera.aspect = static_cast<Real>(options.width) / options.height;
  camera.tan_half_height = std::tan(wish.field_of_view / 2);
  if (wish.eye && wish.target) {
    camera.eye = *wish.eye;
    level(camera, *wish.target - *wish.eye);
    return camera;
  }
  level(camera, view_direction(wish));
  const Real wide = camera.tan_half_height * camera.aspect, high = camera.tan_half_height;
  AxisFit across{-wide * (1 - 2 * margins.left), wide * (1 - 2 * margins.right)};
  AxisFit upward{-high * (1 - 2 * margins.bottom), high * (1 - 2 * margins.top)};
  Bounds bounds;
  Real nearest = 1e300;
  for (const Vec3& p : content) {
    const Real depth = dot(p, camera.forward);
    across.include(dot(p, camera.right), depth);
    upward.include(dot(p, camera.up), depth);
    bounds.include(p);
    nearest = std::min(nearest, depth);
  }
  // Content that is a single point would put the eye into it.
  const Real least_distance = 0.05 * norm(bounds.size()) + 1e-3;
  const Real depth = std::min({across.greatest_depth(), upward.greatest_depth(), nearest - least_distance});
  camera.eye = depth * camera.forward + across.eye(depth) * camera.right + upward.eye(depth) * camera.up;
  if (wish.zoom != 1) {
    const Real distance = dot(bounds.centre() - camera.eye, camera.forward);
    camera.eye += (1 - 1 / wish.zoom) * distance * camera.forward;
  }
  return camera;
}

std::vector<Vec3> content_of(const Frame& frame) {
  std::vector<Vec3> content;
  const DrawnYarns& yarns = frame.yarns;
  // Ends and every eighth point: a sheet of any pose is enclosed without a box around it.
  for (std::size_t y = 0; y < yarns.yarns(); ++y) {
    const Index first = yarns.first_point[y], last = yarns.first_point[y + 1];
    for (Index i = first; i < last; i += 8) content.emplace_back(yarns.points[i]);
    if (last > first) content.emplace_back(yarns.points[last - 1]);
  }
  for (const DrawnCloth& cloth : frame.cloths)
    for (std::size_t i = 0; i < cloth.mesh.vertices.size(); i += 8) content.emplace_back(cloth.mesh.vertices[i]);
  Bounds main = bounds_of_cloth(frame);
  const bool cloth = !main.empty();
  if (!cloth) main = bounds_of_liquid(frame);
  if (main.empty()) main = bounds_of_solids(frame);
  if (main.empty()) main.include(Vec3{});
  Bounds near = main;
  near.grow(std::max(1e-4, 0.12 * norm(main.size())));
  near.upper.z += 0.45 * norm(main.size());
  include_corners(content, intersection(bounds_of_liquid(frame), near));
  include_corners(content, intersection(bounds_of_solids(frame), near));
  if (content.empty()) include_corners(content, main);
  return content;
}

Camera camera_for(std::span<const Vec3> content, const PictureOptions& options) {
  const bool legend = options.legend && options.style == PictureStyle::diagram;
  const Margins margins = legend ? Margins{0.03, 0.145, 0.10, 0.11} : Margins{0.05, 0.05, 0.05, 0.05};
  return fitted_camera(content, options, margins);
}

}  // namespace imbibe
