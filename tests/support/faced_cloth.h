// A small cotton cloth with particles of 0.5 mm to lie on its faces, without a world around it.
#pragma once

#include <cmath>
#include <numeric>

#include "imbibe/coupling/exchange_state.h"
#include "imbibe/coupling/face_map.h"
#include "imbibe/liquid/particles.h"
#include "support/woven.h"

namespace imbibe::test {

struct FacedCloth {
  Fabric fabric = woven("cotton", "cotton", 16);
  Placement placement;
  Liquid liquid;
  FaceMap map;
  ExchangeState exchange;

  FacedCloth() {
    liquid.particle_mass = 998.2 * std::pow(0.5e-3, 3);
    map = build_face_map(fabric.network, liquid.spacing());
    exchange.waiting_kg.assign(fabric.network.nodes(), 0);
  }
};

inline Real sum(const std::vector<Real>& kg) { return std::accumulate(kg.begin(), kg.end(), 0.0); }

}  // namespace imbibe::test
