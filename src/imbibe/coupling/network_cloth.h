// What the water of a yarn network does to the soft sheet that it rides on (embedding.h), node by node of the sheet:
//
//   weight      added mass = sum of (contents - conditioned contents + what waits to drip) - borrowed
//   stiffness   x (1 - alpha w),   w = (W - W_air) / (W_full - W_air)          PHYSICS: k (1 - alpha W/W_sat) by fibre
//   damping     + beta w                                                       beta default: the dry cloth's own damping
//   cling       p = n 2 pi r gamma cos(theta_r) b(s)                           on what the sheet touches
//
//   W      kg/kg  regain of the fibres, W_air in balance with the air, W_full when swollen; measured stiffness is W_air's
//   alpha  1      fibre's wet softening (fibres/*.yaml): viscose .5, wool .4, nylon .2, cotton, polyester 0
//   n      1/m2   crowns of one face that meet what lies on it: half the crossings
//   r      m      radius of the yarns' crowns; 2 pi r gamma cos(theta): a liquid bridge between two equal balls of radius r
//                 close together, whatever its volume (Israelachvili, Intermolecular and Surface Forces, 17.11)
//   b      1      share of crowns that are bridged: min(1, s/0.1), s saturation of the yarns
// "borrowed": mass that the network has taken from particles which are still whole; it weighs, and has its momentum, with
// them. A particle that dies joins with its momentum, one that is born takes its own (embedding.h).
// Cling is a cap on the pull: real faces meet on fewer crowns, and hairs hold them apart.
// Tested in tests/coupling/network_cloth_test.cpp.
#pragma once

#include <memory>

#include "imbibe/coupling/cell_cloth.h"
#include "imbibe/coupling/embedding.h"
#include "imbibe/coupling/exchange_state.h"
#include "imbibe/wetting/wetting_model.h"

namespace imbibe {

struct NetworkCloth {
  SoftSheet soft;
  std::shared_ptr<const Embedding> embedding;
  std::shared_ptr<const std::vector<Real>> air_kg;  // per node of the network: conditioned contents, part of the dry cloth
  WetClothParams wet;                               // 0: by fibre
  Real borrowed_kg = 0;                             // state
};

NetworkCloth make_network_cloth(SoftSheet soft, const YarnNetwork& network, const WettingModel& model, const Air& air,
                                const WetClothParams& wet);

// Pa, the greatest pull of liquid bridges at one face.
Real cling_pressure(Real crowns_per_area, Real crown_radius, Real surface_tension, Real cos_receding);

// Work space of weigh(), kept between steps.
struct WeighScratch {
  std::vector<Real> network_kg, sheet_kg;                 // what is held, per node of each
  std::vector<Real> length, swollen, softened, filled;    // per node of the sheet, means over yarns by length
};
// Sets added mass, stiffness, damping and cling of the sheet's nodes.
void weigh(NetworkCloth& cloth, std::span<const std::uint8_t> held, const YarnNetwork& network, const WettingModel& model,
           const Contents& contents, const ExchangeState& exchange, const MassLeft& left, WeighScratch& scratch);

}  // namespace imbibe
