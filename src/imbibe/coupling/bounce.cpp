#include "imbibe/coupling/bounce.h"

#include <algorithm>

namespace imbibe {

Bounce bounce(const Vec3& velocity, const Vec3& normal, Real mass, Real restitution, Real friction) {
  const Real approach = -dot(velocity, normal);
  if (approach <= 0) return {velocity, {}};
  const Real normal_change = (1 + restitution) * approach;
  const Vec3 tangential = velocity + approach * normal;
  const Real slip = norm(tangential);
  const Real taken = std::min(friction * normal_change, slip);  // friction stops, it never turns round
  Vec3 after = velocity + normal_change * normal;
  if (slip > 0) after -= (taken / slip) * tangential;
  return {after, mass * (velocity - after)};
}

Bounce rest(const Vec3& velocity, Real mass) { return {{}, mass * velocity}; }

}  // namespace imbibe
