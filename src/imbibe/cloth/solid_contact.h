// Nodes against solids: no node ends a substep inside a solid, and friction holds it there.
//
//   gap(x) = distance(x) - thickness/2
//   normal impulse: the least J_n >= 0 with gap(x + dt v) >= min(0, gap(x)) + dt v_out
//   friction: the velocity along the face falls by min(|v_t|, mu J_n/m)
//   cling: J_n may pull, to at most cling * area * dt, while the node is closer than the bridges are long
//
// Nodes are held off by half the thickness and by the rise of the solid over the flat triangles between them, h^2/4R for
// right triangles of legs h on a radius R: else a ball looks through the cloth that lies on it.
//
// A node that starts inside (a solid put over the cloth) is led out at the speed v_out, so that it gains no energy to speak
// of. The path is searched from its start by steps of the distance to the solid (sphere tracing, Hart 1996), so a thin
// solid is not jumped over; and a node is not looked at again before it has moved as far as it was away.
// Tested in tests/cloth/solid_contact_test.cpp.
#pragma once

#include "imbibe/cloth/cloth_step.h"

namespace imbibe {

struct SolidTouch {
  Vec3 impulse{};       // N s on the node
  bool touches = false;
  Real clearance = 0;   // m the node may move before it is to be looked at again
};

struct SolidNode {
  Vec3 position{}, velocity{};
  Real inverse_mass = 0;
  Real half_thickness = 0;
  Real pull = 0;  // N, greatest cling
};

// m, how far a round solid rises over a flat right triangle of legs `edge` whose corners lie on it; 0 for flat ones and for
// meshes, whose roundness is not known.
Real rise_between_nodes(const Shape& shape, Real edge);

// `moved`: how far the solid has moved since its shape was given.
SolidTouch touch_solid(const ClothSolid& solid, const Vec3& moved, const SolidNode& node, Real dt);

}  // namespace imbibe
