// Light in a picture: what a ray from the camera brings back, linear RGB with white paper at 1.
// Direct light of a disc in the sky and of the sky itself by one sample each; light that other surfaces throw back is
// a constant share, which is enough for cloth. Water refracts (Snell) and reflects (Fresnel) in the natural style; in a
// diagram it tints by the length of the way through it and does not bend the view, so that the cloth can be read.
#pragma once

#include <vector>

#include "imbibe/scene/picture_options.h"
#include "imbibe/view/denoise.h"
#include "imbibe/view/pixel_samples.h"
#include "imbibe/view/ray_scene.h"

namespace imbibe {

struct Look {
  PictureStyle style = PictureStyle::diagram;
  Vec3f to_light;                 // unit, towards the middle of the light
  Vec3f to_window;                // unit, the bright window that water mirrors
  float light_size = 0.1f;        // tangent of its angular radius
  Vec3f light{1, 1, 1};           // irradiance on a surface that faces it, over pi
  Vec3f sky_up, sky_horizon;      // radiance
  Vec3f returned;                 // radiance that blocked sky is replaced by
  Vec3f ground;                   // linear RGB
  float ground_height = 0;        // m
  float content_size = 1;         // m
  Vec3f centre;                   // of what is shown, on the ground
  Vec3f water_absorption;         // 1/m
  Vec3f water_scattered;          // radiance that replaces absorbed light in a diagram
  float pixel_angle = 1e-3f;      // rad
  float contact_gap = 0;          // m, water nearer than this to a solid touches it
};

struct LookInput {
  PictureStyle style = PictureStyle::diagram;
  Vec3f right, forward;           // of the camera
  float ground_height = 0;
  float content_size = 1;         // m
  Vec3f centre;
  float liquid_depth = 1e-3f;     // m, typical way of light through the liquid
  float pixel_angle = 1e-3f;
  float contact_gap = 0;          // m
};
Look look_for(const LookInput& input);

// What one camera sample brings back: light, and the first surface behind any water (denoise.h).
// `touched` collects the yarn points whose saturation went into it (with repetitions).
TracedPixel trace(const RayScene& scene, const Look& look, const Ray& ray, const PixelSamples& samples,
                  std::vector<Index>& touched);

// What of a saturation is visible, as a small whole number: seed A's level in a diagram, steps of 1/32 in the natural
// style. Pictures depend on saturations through this alone, so a film redraws only where it has changed.
std::uint8_t shown_saturation(PictureStyle style, float saturation);
float shown_value(PictureStyle style, std::uint8_t shown);

// Share of light reflected by a smooth surface between media; `cosine` on the side of index n1. 1 = total reflection.
float fresnel_reflectance(float cosine, float n1, float n2);

// Colour of cloth wetted to `saturation`: water between fibres lowers the contrast of their surfaces, so light goes
// deeper and more of it is lost (Lekner & Dorf, Applied Optics 27, 1988, as a shape only).
Vec3f wet_colour(const Vec3f& dry, float saturation);

}  // namespace imbibe
