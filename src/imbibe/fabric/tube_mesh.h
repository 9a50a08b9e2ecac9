// Triangle tubes of yarns, made where they are needed (near liquid, for pictures and files), never stored for all.
//
// Rings of `sides` corners stand square to the centre line at its points; corners lie on the round yarn, so the mesh
// lies inside it by at most r (1 - cos(pi / sides)) across plus the sag of the centre line between two points. The
// yarn lies in a plane, so rings need no twist: one axis of every ring is the plane's normal. A ring depends only on
// the yarn and its point: the last ring of a segment is, bit for bit, the first ring of the next, and segments put one
// after another close the yarn. Counter-clockwise seen from outside. Tested in tests/fabric/tube_mesh_test.cpp.
#pragma once

#include "imbibe/core/parameter.h"
#include "imbibe/fabric/network.h"
#include "imbibe/geometry/triangle_mesh.h"

namespace imbibe {

struct TubeParams {
  int sides = 12;
  int every_point = 1;   // 2 = every second point of the centre line; must divide points_per_segment
  bool caps = false;     // close the two ends
};

template <class V>
void describe(V& v, TubeParams& p) {
  v.value("sides", p.sides, {.min = 3, .max = 256, .help = "corners around the yarn"});
  v.value("every_point", p.every_point, {.min = 1, .max = 64, .help = "rings at every n-th point of the centre line"});
  v.value("caps", p.caps, {.help = "close the ends of each piece"});
}

// Appends to `mesh`. Throws InputError where the params do not fit the network.
void append_segment_tube(const YarnNetwork& network, Index segment, const TubeParams& params, TriangleMesh& mesh);
void append_yarn_tube(const YarnNetwork& network, Index yarn, const TubeParams& params, TriangleMesh& mesh);

TriangleMesh segment_tube(const YarnNetwork& network, Index segment, const TubeParams& params = {});
TriangleMesh yarn_tube(const YarnNetwork& network, Index yarn, const TubeParams& params = {});
TriangleMesh fabric_tubes(const YarnNetwork& network, const TubeParams& params = {});  // all yarns

// Unit direction of the centre line at a point of a yarn (number in network.points), by central differences.
Vec3 yarn_direction(const YarnNetwork& network, Index yarn, Index point);

// Greatest distance of a flat side from the round yarn: r (1 - cos(pi / sides)).
Real tube_deviation(Real radius, int sides);

}  // namespace imbibe
