// Pictures by ray tracing (Embree): round yarns, smooth liquid, solids, soft shadows. No display needed.
// The same bits for any number of threads: every pixel draws its own counter-based samples.
#pragma once

#include "imbibe/scene/picture_options.h"
#include "imbibe/view/camera.h"
#include "imbibe/view/frame.h"
#include "imbibe/view/image.h"

namespace imbibe {

// What stays the same over a film: where it is seen from and the ground under it.
struct Stage {
  Camera camera;
  Real ground = 0;  // m, height of the table
};

// A stage that shows all of the given frames (typically the first and the last of a run).
Stage stage_for(std::span<const Frame* const> frames, const PictureOptions& options);
Stage stage_for(const Frame& frame, const PictureOptions& options);

Image draw_picture(const Frame& frame, const PictureOptions& options);
Image draw_picture(const Frame& frame, const Stage& stage, const PictureOptions& options);

}  // namespace imbibe
