// What a picture of a run looks like: style, size, samples, camera. Plain scene data; drawn by view/picture.h.
// Units: m, rad. Tested in tests/view/picture_test.cpp.
#pragma once

#include <optional>
#include <string>

#include "imbibe/core/parameter.h"
#include "imbibe/core/types.h"

namespace imbibe {

// diagram: the colour bar of seed A section 6 on the yarns, translucent blue liquid, legend, scale bar, time, title.
// natural: cloth in its own colour, wet places darker and glossier, refracting liquid on a warm table.
enum class PictureStyle { diagram, natural };

enum class PictureView { three_quarter, top, side };

struct CameraOptions {
  PictureView view = PictureView::three_quarter;
  std::optional<Vec3> eye;      // both given: the view is exactly this; otherwise it is fitted to what is shown
  std::optional<Vec3> target;
  Real field_of_view = radians(26);  // vertical
  Real azimuth = radians(-58);       // of the eye about z, from +x; three_quarter and side views
  Real elevation = radians(34);      // of the eye above the horizon; three_quarter view
  Real zoom = 1;                     // > 1: closer than fitted, about the centre of what is fitted
};

struct PictureOptions {
  PictureStyle style = PictureStyle::diagram;
  int width = 1280, height = 720;
  int samples = 4;              // rays per pixel; a denoiser follows, 16 or more for print
  CameraOptions camera;
  bool legend = true;           // diagram: colour bar, scale bar, time and title
  bool film = true;             // film.mp4 from the pictures, where ffmpeg is present
  int frames_per_second = 25;
};

template <class V>
void describe(V& v, CameraOptions& p) {
  v.choice("view", p.view,
           {{"three_quarter", PictureView::three_quarter}, {"top", PictureView::top}, {"side", PictureView::side}},
           "direction from which a fitted camera looks");
  v.value("eye", p.eye, {.unit = "m", .shown = "mm", .help = "place of the camera; needs target too"});
  v.value("target", p.target, {.unit = "m", .shown = "mm", .help = "point the camera looks at"});
  v.value("field_of_view", p.field_of_view,
          {.unit = "rad", .shown = "deg", .min = radians(2), .max = radians(120), .help = "vertical angle of view"});
  v.value("azimuth", p.azimuth,
          {.unit = "rad", .shown = "deg", .min = -2 * pi, .max = 2 * pi, .help = "of the fitted eye about z from +x"});
  v.value("elevation", p.elevation,
          {.unit = "rad", .shown = "deg", .min = -pi / 2, .max = pi / 2, .help = "of the fitted eye above the horizon"});
  v.value("zoom", p.zoom, {.min = 0.05, .max = 100, .help = "above 1: closer than fitted"});
}

template <class V>
void describe(V& v, PictureOptions& p) {
  v.choice("style", p.style, {{"diagram", PictureStyle::diagram}, {"natural", PictureStyle::natural}},
           "diagram: colour bar of liquid content; natural: as a camera would see it");
  v.value("width", p.width, {.min = 64, .max = 8192, .help = "pixels"});
  v.value("height", p.height, {.min = 64, .max = 8192, .help = "pixels"});
  v.value("samples", p.samples, {.min = 1, .max = 4096, .help = "rays per pixel; time grows with it, noise falls"});
  v.group("camera", p.camera, "where the picture is taken from");
  v.value("legend", p.legend, {.help = "draw colour bar, scale bar, time and title (diagram)"});
  v.value("film", p.film, {.help = "join the pictures to film.mp4 where ffmpeg is installed"});
  v.value("frames_per_second", p.frames_per_second, {.min = 1, .max = 240, .help = "of the film"});
}

}  // namespace imbibe
