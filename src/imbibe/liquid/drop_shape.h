// The shape of a drop at rest on a level plane (Young-Laplace, axisymmetric), by integration from its apex.
//
//   dr/ds = cos phi,  dz/ds = sin phi,  dphi/ds = 2 b + c z - sin(phi)/r      (b at the apex, where sin(phi)/r -> b)
//   c = rho g/gamma [1/m2]  0 without gravity      b curvature at the apex [1/m]
//   r distance from the axis, z depth below the apex [m], phi angle of the surface to the level, s length along it [m]
// The wall is where phi = theta, the contact angle; b is found so that the volume is the wanted one. With c = 0 the shape
// is a spherical cap.
// Source: Bashforth & Adams, An attempt to test the theories of capillary action, Cambridge 1883.
// Assumes: at rest, one angle all around, sessile (c >= 0). Fourth-order steps of at most 0.01 rad and of 0.01 V^(1/3):
// relative error of radius and height below 1e-6.
// Tested in tests/liquid/drop_shape_test.cpp: spherical caps, tables of 10 uL of water, puddles.
#pragma once

#include <vector>

#include "imbibe/core/types.h"

namespace imbibe {

struct ProfilePoint {
  Real radius = 0, depth = 0, slope = 0;  // r, z below the apex [m]; phi [rad]
};

struct SessileShape {
  Real apex_curvature = 0;  // b, 1/m; the pressure at the apex is 2 gamma b
  Real angle = 0;           // rad, at the wall
  Real volume = 0;          // m3
  Real base_radius = 0;     // m
  Real height = 0;          // m
  Real centre_height = 0;   // m, of mass, over the wall
  Real mean_square_radius = 0;  // m2, <x2 + y2> over the volume
  std::vector<ProfilePoint> profile;  // from the apex to the wall
};

// A cap of a sphere that its base's plane cuts under the angle with this cosine:
//   V = pi R^3/3 (2 + c)(1 - c)^2      R its sphere's radius [m]; infinite for c = 1
Real cap_volume(Real radius, Real cosine);
Real cap_radius(Real volume, Real cosine);

// The drop of this volume [m3] that meets the wall under `angle` [rad, 0 < angle < pi]. c: rho g/gamma [1/m2], >= 0.
SessileShape sessile_shape(Real volume, Real angle, Real c);

// The shape with this apex curvature [1/m], down to where its surface has the slope `angle`, or to `height` below the apex
// (the other limit infinite), whichever comes first.
SessileShape sessile_profile(Real apex_curvature, Real c, Real angle, Real height, Real longest_step);

// The contact angle [rad] of a drop of this volume whose centre of mass is at this height [m].
Real angle_of_centre_height(Real centre_height, Real volume, Real c);

}  // namespace imbibe
