// The path of a yarn from one crossing to the next, in the plane of its crimp (Peirce, The geometry of cloth
// structure, J. Text. Inst. 28 (1937) T45, flexible-thread model).
//
// The yarn bends around the crossing yarn on an arc of radius R = r_warp + r_weft, the distance at which the two touch,
// runs straight, and bends back around the next one:
//
//   p = (R0 + R1) sin(theta) + L cos(theta),    h = (R0 + R1)(1 - cos(theta)) + L sin(theta)
//   L^2 = p^2 - 2 (R0 + R1) h + h^2,            arc length l = (R0 + R1) theta + L,      crimp = l / p - 1
//   p      m    distance of the two crossings along the yarn
//   h      m    change of height between them; 0 on a float
//   R0, R1 m    bending radii at the two crossings
//   theta  rad  weave angle; L m straight part
//
// Both families bending at no less than R about each other, their axes are nowhere nearer than R: no interpenetration
// (a sinusoid of the same height has a sharper crown and does interpenetrate once p < 4.4 r).
// Assumptions: round, unflattened, flexible yarns. Validity: L^2 >= 0 and the arcs do not overlap; below that pitch
// the cloth is jammed (plain, equal yarns: p < 2 sqrt(3) r). Tested in tests/fabric/crimp_test.cpp.
#pragma once

#include "imbibe/core/types.h"

namespace imbibe {

struct CrimpCurve {
  Real span = 0;        // m, p
  Real from = 0, to = 0;  // m, heights of the ends; both ends are level
  Real radius_from = 0, radius_to = 0;  // m
  Real angle = 0;       // rad, theta
  Real straight = 0;    // m, L
  Real length = 0;      // m, whole arc length
};

// The shortest span that the path has room in: sqrt(2 (R0 + R1) h - h^2).
Real least_span(Real height_change, Real radius_from, Real radius_to);

// span must be at least least_span(...).
CrimpCurve crimp_curve(Real span, Real from, Real to, Real radius_from, Real radius_to);

struct CrimpPoint {
  Real along = 0, height = 0;  // m
};
// The point at `arc` from the start, 0 <= arc <= length.
CrimpPoint point_at(const CrimpCurve& curve, Real arc);
// The arc length from the start to the point at `along`, 0 <= along <= span.
Real arc_at(const CrimpCurve& curve, Real along);

}  // namespace imbibe
