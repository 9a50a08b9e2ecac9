// The liquid that lies on a sheet: which particles touch it, over which nodes they lie, and the supply that each node
// of the network sees.
//
// A particle touches when its distance from the sheet's surface is below touch_distance. It covers A_p = dx^2 of the
// face and is spread over the nodes within `reach` by the face kernel W:
//   share_pk = A_k W(|x_p - x_k|) / sum_k' A_k' W(|x_p - x_k'|)     (sums to 1 over the nodes of a particle)
//   f_k      = min(1, sum_p A_p W(|x_p - x_k|))                      wetted share of node k
//   M_k      = sum_p share_pk m_p (1 - owed/touching mass)           what node k may take in this step
// A patch is a set of touching particles joined through common nodes: one pool of debt and one pressure,
//   p = min( F_n / A,  rho max(g h + v^2 / 2) + 2 gamma / R ),  A = sum of A_p over all patches.
// F_n is the averaged normal force of the liquid on the sheet: at rest its weight and the pull 2 pi a gamma sin(theta) of
// the contact line, in an impact also the momentum given up. The second form is the total head of the liquid (h height over
// the face, v speed, R radius of a drop of all of it), which no steady pressure exceeds: in the first touch of an impact a
// force averaged over 2 ms stands on an area of a few particles and says nothing.
// Raw particle pressures are too noisy for thresholds of some 100 Pa. Several patches share F_n by area.
#pragma once

#include <span>
#include <vector>

#include "imbibe/core/types.h"
#include "imbibe/coupling/embedding.h"
#include "imbibe/coupling/exchange_state.h"
#include "imbibe/coupling/face_map.h"
#include "imbibe/fabric/network.h"
#include "imbibe/liquid/particles.h"
#include "imbibe/wetting/contents.h"

namespace imbibe {

struct FootprintLink {
  Index node = 0;
  Real share = 0;  // of the particle's mass, 0..1
};

struct FootprintPatch {
  std::size_t particles = 0;
  Real area = 0;       // m2
  Real touching_kg = 0;
  Real owed_kg = 0;    // taken already, particles not yet removed
  Real pressure = 0;   // Pa
};

// Besides the particles, mass that waits at a node to become a particle (ExchangeState::waiting_kg) lies on the face as a
// film of one spacing and may be taken back: such a node has a supply too, without a patch when no particle covers it.
struct Footprint {
  std::vector<Index> particle;        // touching particles, ascending
  std::vector<Index> patch_of;        // patch of each touching particle
  std::vector<std::uint8_t> on_back;  // 1: under the sheet
  std::vector<Index> first_link;      // size particles + 1
  std::vector<FootprintLink> links;
  std::vector<FaceSupply> supplies;   // one per covered node, in order of first contact
  std::vector<Index> supply_patch;    // no_index: only waiting mass
  std::vector<FootprintPatch> patches;
  std::vector<Index> supply_of_node;  // scratch: no_index but for covered nodes
  bool empty() const { return particle.empty(); }
};

// Fills `footprint` (its memory is reused). Does not change any state.
void find_footprint(const Liquid& liquid, const YarnNetwork& network, const ClothPlace& place, const FaceMap& map,
                    const Vec3& gravity, const ExchangeState& exchange, Footprint& footprint);

// m; nearer than this to a face a particle touches it: the first layer of particles above the wall.
inline Real touch_distance(Real spacing) { return 0.9 * spacing; }

}  // namespace imbibe
