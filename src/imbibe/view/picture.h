// Pictures by ray tracing (Embree): round yarns, smooth liquid, solids, soft shadows. No display needed.
// The same bits for any number of threads: every pixel draws its own counter-based samples.
#pragma once

#include <memory>
#include <span>

#include "imbibe/scene/picture_options.h"
#include "imbibe/view/camera.h"
#include "imbibe/view/frame.h"
#include "imbibe/view/image.h"

namespace imbibe {

// What stays the same over a film: where it is seen from, the ground under it, and the extent of what it shows.
struct Stage {
  Camera camera;
  Real ground = 0;        // m, height of the table
  Vec3 centre{};          // m
  Real content_size = 1;  // m
};

// A stage that shows all of the given frames (typically the first and the last of a run).
Stage stage_for(std::span<const Frame* const> frames, const PictureOptions& options);
Stage stage_for(const Frame& frame, const PictureOptions& options);

// Draws the frames of a film. What looks as in the frame before is not traced again; each picture is, bit for bit, what
// draw_picture makes of its frame alone.
class PictureSeries {
 public:
  PictureSeries(Stage stage, PictureOptions options);
  ~PictureSeries();
  PictureSeries(PictureSeries&&) noexcept;

  Image draw(const Frame& frame);
  // Share of the last picture that was traced.
  Real traced_share() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

Image draw_picture(const Frame& frame, const PictureOptions& options);
Image draw_picture(const Frame& frame, const Stage& stage, const PictureOptions& options);

}  // namespace imbibe
