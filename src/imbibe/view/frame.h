// What one picture shows, as plain data: independent of the simulation's state, so it can come from a living World
// (frame_from_world.h), from the files of a run (run_frames.h), or be made up by a test.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "imbibe/core/types.h"
#include "imbibe/geometry/bounds.h"
#include "imbibe/geometry/shapes.h"

namespace imbibe {

// Centre lines of all yarns, one after another.
struct DrawnYarns {
  std::vector<Vec3f> points;         // m, world
  std::vector<float> saturation;     // per point, 0..1
  std::vector<Index> first_point{0}; // yarns + 1
  std::vector<float> radius;         // per yarn, m
  std::vector<Vec3f> colour;         // per yarn, linear RGB when dry
  std::size_t yarns() const { return radius.size(); }
};

struct DrawnMesh {
  std::vector<Vec3f> vertices;                  // m
  std::vector<Vec3f> normals;                   // unit, per vertex, outward; may be empty: flat faces
  std::vector<std::array<Index, 3>> triangles;  // counter-clockwise from outside
};

// A cloth drawn as a surface that darkens with what it holds.
struct DrawnCloth {
  std::string name;
  DrawnMesh mesh;
  std::vector<float> saturation;     // per vertex
  std::vector<std::array<float, 2>> uv;  // per vertex, m: where it lies in the cloth, for the weave
  Vec3f colour{0.80f, 0.74f, 0.62f};  // linear RGB when dry
};

// A fixed solid: `mesh` when it has triangles, else `shape` (which is then not a MeshShape).
struct DrawnSolid {
  Shape shape;
  DrawnMesh mesh;
  Vec3f colour{0.55f, 0.55f, 0.58f};  // linear RGB
};

struct Frame {
  Real time = 0;  // s
  std::string title;
  std::string quantity = "Liquid content";  // what the colour bar shows
  std::string quantity_unit = "% of saturation";
  DrawnYarns yarns;
  std::vector<Vec3f> particles;   // m, free liquid
  Real particle_spacing = 0;      // m
  std::vector<DrawnSolid> solids;
  std::vector<DrawnCloth> cloths;
  Vec3f up{0, 0, 1};              // of the cloth, for the lie of the yarn's twist
};

// Appends one yarn; saturation has one value per point.
void add_yarn(DrawnYarns& yarns, const std::vector<Vec3f>& points, const std::vector<float>& saturation, float radius,
              const Vec3f& colour);

// Unit vertex normals of a surface, weighted by area.
void set_normals(DrawnMesh& mesh);

// Bounds of cloth, solids (planes excepted) and of liquid.
Bounds bounds_of_cloth(const Frame& frame);
Bounds bounds_of_solids(const Frame& frame);
Bounds bounds_of_liquid(const Frame& frame);

}  // namespace imbibe
