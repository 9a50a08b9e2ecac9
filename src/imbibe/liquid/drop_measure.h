// What a drop of particles at rest on a plane shows: contact angle by three estimators, base radius, height, volume. On
// another solid of revolution, whose axis is the drop's, by the first of them.
//
// The surface is where the liquid's part of the kernel, C/(1 - lambda) with lambda the wall's, is 1/2. On a surface of
// curvature kappa (sum of both principal ones) that level lies H^2 kappa M0 inside, M0 = 0.0347; it is put back there.
// It is looked for along rays from the drop's centre of mass, from inside, so spray around it does not matter.
//   fit      least squares of the Young-Laplace profile (drop_shape.h; free: apex curvature and height; c is given) to all
//            points farther than dx from the wall: angle where it meets the wall. Base radius, height and volume are the
//            fit's.
//   slope    cot(theta) = -dr/dz at the wall, from r^2(z) next to it (mean around the axis, dx < z < 4 dx, at most 0.6 h):
//            a straight line through its difference from the fit's. Of the fit only the curvature there is used.
//   centre   from the height of the centre of mass for the nominal volume (particles x mass / density): the least noise,
//            but wrong when the volume is.
// The wall's part of the kernel is a half-space's at the same distance: points lie a spacing off, where the difference of a ball
// of ten supports is 0.003.
// Of a lattice cut to shape at R/dx = 8 and more each gives its angle within 2 degrees between 30 and 150
// (tests/liquid/drop_measure_test.cpp).
#pragma once

#include "imbibe/geometry/shapes.h"
#include "imbibe/liquid/drop_shape.h"
#include "imbibe/liquid/particles.h"

namespace imbibe {

struct DropMeasure {
  Real fit_angle = 0;      // rad
  Real slope_angle = 0;    // rad, on a plane
  Real centre_angle = 0;   // rad, on a plane
  Real base_radius = 0;    // m, of the fitted profile at the wall
  Real height = 0;         // m, of its apex over the frame's origin
  Real base_slope = 0;     // rad, of the fitted profile to the level where it meets the wall: the fit's angle on a plane
  Real volume = 0;         // m3, between the fitted profile and the wall
  Real apex_curvature = 0; // 1/m
  Real fit_deviation = 0;  // m, root mean square distance of the surface points from the profile
  Vec3 centre{};           // m, of mass
  std::size_t points = 0;  // on the surface
};

// The liquid is one drop on the plane; gravity [m/s2, >= 0] acts against the plane's normal.
// Throws NumericalError when there is no such drop (fewer than 50 surface points).
DropMeasure measure_sessile_drop(const Liquid& liquid, const Plane& wall, Real gravity);

// The same on a solid of revolution about the line through frame.point along frame.normal; the solid's surface goes through that
// point and falls away from it.
DropMeasure measure_drop_on(const Liquid& liquid, const Shape& solid, const Plane& frame, Real gravity);

}  // namespace imbibe
