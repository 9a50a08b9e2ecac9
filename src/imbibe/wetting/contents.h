// What the nodes of a yarn network hold: the state of the wetting model. Plain and copyable.
#pragma once

#include <vector>

#include "imbibe/core/types.h"

namespace imbibe {

struct Air {
  Real temperature = 293.15;  // K
  Real humidity = 0.65;       // relative, 0..1
  Real mass_transfer = 5e-3;  // m/s, h_m of vapour at the cloth's faces (Lewis; 3-10 mm/s in still to moving air)
};

struct Contents {
  std::vector<Real> sorbed_kg;  // per segment: water inside the fibre substance
  std::vector<Real> liquid_kg;  // per node: capillary water in the yarn (segments), free water in the pore (pores)
  // Optional radial shells of the fibre (sorption model `shells`), segment-major; empty otherwise.
  std::vector<Real> shell_regain;
  // Drainage branch of contact-angle hysteresis: the highest saturation since the node was last dry, per node; empty
  // without hysteresis.
  std::vector<Real> reached_saturation;
};

// Liquid resting on a face of the textile over one node, as the coupling layer sees it in one exchange step.
struct FaceSupply {
  Index node = 0;
  Real wetted_share = 0;    // 0..1, share of the node's face that is covered
  Real pressure = 0;        // Pa, of the liquid at the face
  Real available_kg = 0;    // the most that may be taken in this step
  bool from_below = false;  // the liquid stands at the lower face (-z of the sheet): its pore fills upwards
};

}  // namespace imbibe
