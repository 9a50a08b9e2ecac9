// An open triangle surface that moves during a step, and the earliest crossing of a moving point with it: every vertex and
// the point go straight from where they start to where they end.
//
// At time t in [0, 1] the point p lies in the plane of triangle (a, b, c) where f(t) = (p - a).((b - a) x (c - a)) = 0,
// a cubic. It is cut at the extrema of f into pieces that rise or fall, each piece holds at most one root, found by halving.
// Inside the triangle is asked with a slack of 1e-9: triangles that share an edge leave no gap between them.
// Both sides of the surface are alike. Pure; nothing is allocated in a query.
// Tested in tests/geometry/moving_mesh_test.cpp against 10^6 points and an oracle.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "imbibe/core/types.h"
#include "imbibe/geometry/hierarchy.h"
#include "imbibe/geometry/triangle_mesh.h"

namespace imbibe {

// A point of a surface: weights of the triangle's corners, which add up to 1.
struct SurfacePoint {
  Index triangle = no_index;
  std::array<Real, 3> weight{};
};

struct MovingCrossing {
  SurfacePoint at;
  Real time_fraction = 0;
  Vec3 normal{};  // unit, of the triangle at that time, towards where the point came from
};

// One triangle. nullopt: no crossing in [0, 1]. A start on the plane itself is no crossing.
std::optional<MovingCrossing> cross_moving_triangle(const Vec3& p0, const Vec3& p1, const std::array<Vec3, 3>& start,
                                                    const std::array<Vec3, 3>& end);

// The surface over one step. `mesh` holds the vertices at the end.
struct MovingMesh {
  std::vector<Vec3> start;  // m, vertices at the start
  TriangleMesh mesh;        // vertices at the end
  BoxHierarchy swept;       // boxes of the triangles' ways
  BoxHierarchy at_end;      // boxes of the triangles at the end
  std::vector<Bounds> boxes;  // work space
  bool empty() const { return mesh.triangles.empty(); }
};

// Sets the step's start and end. The trees are built once and then refitted while the triangles stay the same.
void set_step(MovingMesh& moving, std::span<const Vec3> start, std::span<const Vec3> end,
              std::span<const std::array<Index, 3>> triangles);

// The earliest crossing of the way p0 -> p1 with any triangle; of several at one time the lowest triangle.
std::optional<MovingCrossing> first_crossing(const MovingMesh& moving, const Vec3& p0, const Vec3& p1);

// The nearest point of the surface at the end, and where it lies.
struct NearestOnSheet {
  SurfacePoint at;
  Vec3 point{};            // m
  Vec3 normal{};           // unit, towards p; the triangle's own where p lies on the surface
  Real distance = 0;       // m, >= 0
  Real side = 1;           // +1 on the side of the triangles' normals, -1 behind
  bool on_border = false;  // the nearest point lies on the outline of the surface: p is beside it
};
// Nothing nearer than `limit` (m): at.triangle is no_index.
NearestOnSheet nearest_on(const MovingMesh& moving, const Vec3& p,
                          Real limit = std::numeric_limits<Real>::infinity());

}  // namespace imbibe
