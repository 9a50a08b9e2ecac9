// What rays can meet in a picture: yarns as round curves and solids in one Embree scene, the liquid's surface in
// another (so that shadow rays choose whether water stops them). Lives as long as the picture is drawn.
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
  Vec3f colour;       // linear RGB, dry
  float saturation = 0;
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
  explicit RayScene(const Frame& frame);
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

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
