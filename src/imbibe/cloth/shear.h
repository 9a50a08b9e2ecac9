// Shear of four pieces of one colour at once, with the compiler's vector types: they share no node, each lane is one piece, and
// its bits are those of a piece solved alone.
//
//   C = cos(angle between weft and warp) = u_a . u_b,  a = sum weft x~, b = sum warp x~,  u = a/|a|
//   grad_k C = weft_k (u_b - C u_a)/|a| + warp_k (u_a - C u_b)/|b|
// and the impulse of elastic_impulse (impulse.h). Pieces relaxed one by one took more than half of a cloth's time.
// Tested in tests/cloth/shear_test.cpp and by the closed forms.
#pragma once

#include <array>

#include "imbibe/cloth/impulse.h"
#include "imbibe/cloth/lanes.h"

namespace imbibe {

// Of `count` pieces, 1 to 4: adds to `given` what they gave, and puts into `changed` by how much they changed their angles.
template <std::size_t N, class Material>
inline void solve_shear(const ShearPiece<N>* pieces, std::size_t count, const NodeMotion& nodes, const Material* materials,
                        Real dt, Real* given, Reals& changed) {
  const auto lane = [count](std::size_t l) { return l < count ? l : 0; };  // the others repeat the first and give nothing
  const auto of_pieces = [&](auto&& value) {
    return Reals{value(pieces[0]), value(pieces[lane(1)]), value(pieces[lane(2)]), value(pieces[lane(3)])};
  };
  const auto of_nodes = [&](const Vec3* v, std::size_t k) {
    const Vec3 &v0 = v[pieces[0].node[k]], &v1 = v[pieces[lane(1)].node[k]], &v2 = v[pieces[lane(2)].node[k]],
               &v3 = v[pieces[lane(3)].node[k]];
    return Reals3{Reals{v0.x, v1.x, v2.x, v3.x}, Reals{v0.y, v1.y, v2.y, v3.y}, Reals{v0.z, v1.z, v2.z, v3.z}};
  };
  std::array<Reals, N> weft, warp;
  for (std::size_t k = 0; k < N; ++k) {
    weft[k] = of_pieces([k](const ShearPiece<N>& p) { return p.weft[k]; });
    warp[k] = of_pieces([k](const ShearPiece<N>& p) { return p.warp[k]; });
  }
  const Reals step = Reals{} + dt;
  const Reals3 x = of_nodes(nodes.position, 0), v = of_nodes(nodes.velocity, 0);
  std::array<Reals3, N> rate;  // beside the first node
  const Reals none{};
  Reals3 a{none, none, none}, b = a;
  for (std::size_t k = 1; k < N; ++k) {
    rate[k] = of_nodes(nodes.velocity, k) - v;
    const Reals3 ahead = (of_nodes(nodes.position, k) - x) + step * rate[k];
    a += weft[k] * ahead, b += warp[k] * ahead;
  }
  const Reals squared_a = squared_norm(a), squared_b = squared_norm(b);
  const auto has_directions = squared_a * squared_b > 0;  // else it is folded to a line: no gradient
  const Reals inverse_a = has_directions ? 1 / root(squared_a) : none, inverse_b = has_directions ? 1 / root(squared_b) : none;
  const Reals3 ua = inverse_a * a, ub = inverse_b * b;
  const Reals cosine = dot(ua, ub);
  const Reals3 gradient_a = inverse_a * (ub - cosine * ua), gradient_b = inverse_b * (ua - cosine * ub);
  std::array<Reals3, N> gradient;
  Reals mobility{}, change{};
  for (std::size_t k = 0; k < N; ++k) {
    const Reals w = of_pieces([&](const ShearPiece<N>& p) { return nodes.inverse_mass[p.node[k]]; });
    gradient[k] = weft[k] * gradient_a + warp[k] * gradient_b;
    mobility += w * squared_norm(gradient[k]);
    if (k > 0) change += dot(gradient[k], rate[k]);
  }
  const Reals stiffness{materials[0].stiffness, materials[lane(1)].stiffness, materials[lane(2)].stiffness, materials[lane(3)].stiffness};
  const Reals damping{materials[0].damping, materials[lane(1)].damping, materials[lane(2)].damping, materials[lane(3)].damping};
  const Reals before{given[0], given[lane(1)], given[lane(2)], given[lane(3)]};
  const Reals soft = step * stiffness;
  const Reals impulse = ((cosine + change * damping) * soft + before) * (-1 / (1 + soft * (step + damping) * mobility));
  for (std::size_t k = 0; k < N; ++k) {
    const Reals3 impulse_k = impulse * gradient[k];
    for (std::size_t l = 0; l < count; ++l) nodes.give(pieces[l].node[k], {impulse_k.x[l], impulse_k.y[l], impulse_k.z[l]});
  }
  for (std::size_t l = 0; l < count; ++l) given[l] += impulse[l];
  changed = size_of(impulse) * mobility * step;
}

}  // namespace imbibe
