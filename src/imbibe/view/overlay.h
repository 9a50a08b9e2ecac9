// What is lettered onto a diagram: title, simulated time, colour bar, scale bar.
#pragma once

#include <string>

#include "imbibe/view/camera.h"
#include "imbibe/view/image.h"

namespace imbibe {

void draw_overlay(Image& image, const Frame& frame, const Camera& camera, Real ground);

// The simulated time with digits that suit it: "t = 0.350 s", "t = 12.5 s", "t = 3 min 20 s", "t = 1 h 05 min".
std::string time_label(Real seconds);

// The largest of 1, 2, 5 times a power of ten that is not above `length`.
Real round_length(Real length);

}  // namespace imbibe
