// What rays can meet in a picture: yarns as round curves and solids in one Embree scene, the liquid's surface in
// another (so that shadow rays choose whether water stops them). From frame to frame of a film, cloth and solids that did
// not move keep their trees.
#pragma once

#include <memory>

#include "imbibe/view/frame.h"

namespace imbibe {

struct Ray {
  Vec3f origin, direction;  // direction: unit
};

struct SolidHit {
  float distance = 0;
  Vec3f normal;       // unit, smooth, towards the side the ray comes from
  Vec3f flat_normal;  // of the geometry itself, same side
  bool yarn = false;
  bool cut_end = false;  // of a yarn
  bool cloth = false;    // a cloth drawn as a surface
  float u = 0, v = 0;    // m, cloth: where in it
  Vec3f colour;       // linear RGB, dry
  float saturation = 0;   // interpolated
  Index point = no_index; // of the yarns, the nearest before the hit; point + 1 is the nearest after it
  Index nearest = no_index;
  float nearest_saturation = 0;  // of the nearest point: one colour per segment
  // Yarns: where on the yarn, for the lie of its fibres.
  float along = 0;    // m from the yarn's start
  float around = 0;   // rad about the yarn's axis, 0 towards the cloth's face
  float radius = 0;   // m
  Vec3f axis;         // unit, of the yarn
};

struct LiquidHit {
  float distance = 0;
  Vec3f normal;  // unit, smooth, out of the liquid
  bool entering = false;
};

class RayScene {
 public:
  RayScene();
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  // Takes over the frame's contents; `frame` is not needed afterwards. True: yarns and solids stand where they stood.
  bool update(const Frame& frame);

  bool meets_solid(const Ray& ray, float limit, SolidHit& hit) const;
  bool meets_liquid(const Ray& ray, float limit, LiquidHit& hit) const;
  bool solid_between(const Ray& ray, float limit) const;
  bool liquid_between(const Ray& ray, float limit) const;
  bool has_liquid() const;
  // A step off a surface that is safely above the rounding of hits, m.
  float skin() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace imbibe
