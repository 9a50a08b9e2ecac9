// Layers of cloth that lie on each other: one network of several woven layers, and where their faces touch.
//
// Layer 0 is the face (largest z), the last one the back; each is a slab of the layers' thickness t, `gap` apart. Nodes
// are numbered layer by layer: the segments of layer 0, of layer 1, ..., then the pores of layer 0, ...
//
// Two crowns that face each other (the lower side of a yarn of one layer, the upper side of a yarn of the next) are
// paraboloids near their tops. With a_x, a_y the radii of curvature of one along x and y (r across a yarn, R + r along
// it; R bending radius of its axis at the crossing, crimp.h), b_x, b_y those of the other, and d the distance of
// their tops in the plane:
//   least gap      g = g_0 + 1/2 [d_x^2/(a_x + b_x) + d_y^2/(a_y + b_y)]
//   where the gap is below g + h: an ellipse of area S h,  S = 2 pi / sqrt[(1/a_x + 1/b_x)(1/a_y + 1/b_y)]
// g_0 m, distance of the two tops in height: `gap`, and what the slabs are thicker than their yarns.
// Crowns are found by place on a grid; those with g below half the mean radius make an edge. So layers of one weave laid
// edge to edge touch at each crossing; pores of both layers that overlap in the plane face each other.
// Assumes rigid, round crowns; yarns that flatten under pressure touch on more. Where a yarn floats it is flatter than
// its crowns: S is then a lower bound. Tested in tests/fabric/layers_test.cpp.
#pragma once

#include <vector>

#include "imbibe/fabric/network.h"

namespace imbibe {

struct Crown {
  Real radius_x = 0, radius_y = 0;  // m, of curvature of its surface at the top
};

// The equations: least gap above g_0 of two crowns whose tops are (dx, dy) apart, and S.
Real crown_gap(const Crown& a, const Crown& b, Real dx, Real dy);
Real contact_area_per_height(const Crown& a, const Crown& b);

// One network of all layers, from above downwards; they share the sheet's size and slab thickness. One layer: itself.
YarnNetwork stack_layers(std::vector<YarnNetwork> layers, Real gap);

}  // namespace imbibe
