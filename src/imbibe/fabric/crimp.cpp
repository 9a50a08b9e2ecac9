#include "imbibe/fabric/crimp.h"

#include <algorithm>

#include "imbibe/core/portable.h"

namespace imbibe {

Real least_span(Real height_change, Real radius_from, Real radius_to) {
  const Real h = std::abs(height_change), radii = radius_from + radius_to;
  return h >= radii ? radii : std::sqrt((2 * radii - h) * h);
}

CrimpCurve crimp_curve(Real span, Real from, Real to, Real radius_from, Real radius_to) {
  CrimpCurve curve{span, from, to, radius_from, radius_to, 0, span, span};
  const Real h = std::abs(to - from), radii = radius_from + radius_to;
  if (h <= 0) return curve;
  // (radii - h, span) is (radii, straight) turned by theta.
  curve.straight = std::sqrt(std::max(span * span - (2 * radii - h) * h, Real(0)));
  curve.angle = portable::atan2(span, radii - h) - portable::atan2(curve.straight, radii);
  curve.length = radii * curve.angle + curve.straight;
  return curve;
}

CrimpPoint point_at(const CrimpCurve& c, Real arc) {
  const Real sign = c.to < c.from ? -1 : 1;
  const Real first = c.radius_from * c.angle, second = first + c.straight;
  if (c.angle <= 0) return {arc, c.from};
  if (arc < first) {
    const Real a = arc / c.radius_from;
    // 1 - cos a = 2 sin^2(a/2): exact for small angles too.
    const Real half = portable::sin(a / 2);
    return {c.radius_from * portable::sin(a), c.from + sign * c.radius_from * 2 * half * half};
  }
  if (arc <= second) {
    const Real along = c.radius_from * portable::sin(c.angle) + (arc - first) * portable::cos(c.angle);
    const Real up = c.radius_from * (1 - portable::cos(c.angle)) + (arc - first) * portable::sin(c.angle);
    return {along, c.from + sign * up};
  }
  const Real a = (c.length - arc) / c.radius_to, half = portable::sin(a / 2);
  return {c.span - c.radius_to * portable::sin(a), c.to - sign * c.radius_to * 2 * half * half};
}

Real arc_at(const CrimpCurve& c, Real along) {
  if (c.angle <= 0) return along;
  const Real bend = c.radius_from * portable::sin(c.angle);
  if (along < bend) return c.radius_from * portable::asin(along / c.radius_from);
  const Real second = c.span - c.radius_to * portable::sin(c.angle);
  if (along <= second) return c.radius_from * c.angle + (along - bend) / portable::cos(c.angle);
  return c.length - c.radius_to * portable::asin(std::min((c.span - along) / c.radius_to, Real(1)));
}

}  // namespace imbibe
