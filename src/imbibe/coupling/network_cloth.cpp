#include "imbibe/coupling/network_cloth.h"

#include <algorithm>

#include "imbibe/core/portable.h"

namespace imbibe {
namespace {

constexpr Real bridged_at = 0.1;      // saturation of the yarns from which all crowns that meet are bridged
constexpr Real waking_share = 0.005;  // of its mass that a resting sheet gains or loses before it is stepped again

// What the cloth is to carry, per node of the sheet: scratch.sheet_kg.
void find_wanted_mass(const NetworkCloth& cloth, const Contents& contents, const ExchangeState& exchange,
                      WeighScratch& scratch) {
  const std::vector<Real>& air = *cloth.air_kg;
  std::vector<Real>&held = scratch.network_kg, &wanted = scratch.sheet_kg;
  held.resize(air.size());
  for (std::size_t k = 0; k < held.size(); ++k) {
    held[k] = contents.liquid_kg[k] - air[k] + exchange.waiting_kg[k];
    if (k < contents.sorbed_kg.size()) held[k] += contents.sorbed_kg[k];
  }
  wanted.assign(cloth.soft.sheet.size(), 0);
  add_to_sheet(*cloth.embedding, cloth.soft.sheet, held, wanted);
  // What is borrowed lies among what is held; its place makes no difference that could be seen.
  Real more = 0;
  for (const Real kg : wanted) more += std::max(kg, 0.0);
  const Real share = more > 0 ? std::min(1.0, cloth.borrowed_kg / more) : 0;
  for (Real& kg : wanted) kg -= share * std::max(kg, 0.0);
}

// Sums over the yarns at each node of the sheet, by their length.
void sum_yarns(const NetworkCloth& cloth, const YarnNetwork& network, const WettingModel& model, const Contents& contents,
               WeighScratch& m) {
  const Sheet& sheet = cloth.soft.sheet;
  for (auto* values : {&m.length, &m.swollen, &m.softened, &m.filled}) values->assign(sheet.size(), 0);
  for (std::size_t s = 0; s < network.segments(); ++s) {
    const YarnWetting& yarn = model.yarns[model.segment_type[s]];
    const Real now = node_regain(model, contents, s);
    // Regain is proportional to the sorbed mass, so that of the air follows from the conditioned contents.
    const Real sorbed = contents.sorbed_kg[s], in_air = sorbed > 0 ? now * (*cloth.air_kg)[s] / sorbed : yarn.regain_65;
    const Real room = yarn.swelling_regain - in_air;
    const Real swollen = room > 0 ? std::clamp((now - in_air) / room, 0.0, 1.0) : 0;
    const Real filled = yarn.wets ? std::min(1.0, saturation(model, contents, s)) : 0;
    const Real own = cloth.wet.softening > 0 ? cloth.wet.softening : network.type_of_segment(s).fibre.wet_softening;
    const SurfacePoint& at = cloth.embedding->node[s];
    for (std::size_t c = 0; c < 3; ++c) {
      const Index n = sheet.triangles[at.triangle][c];
      const Real weight = at.weight[c] * network.segment_length[s];
      m.length[n] += weight, m.swollen[n] += weight * swollen, m.filled[n] += weight * filled;
      m.softened[n] += weight * own * swollen;
    }
  }
}

}  // namespace

NetworkCloth make_network_cloth(SoftSheet soft, const YarnNetwork& network, const WettingModel& model, const Air& air,
                                const WetClothParams& wet) {
  NetworkCloth cloth;
  cloth.soft = std::move(soft);
  cloth.embedding = std::make_shared<const Embedding>(build_embedding(cloth.soft.sheet, network));
  const Contents conditioned = conditioned_contents(model, air);
  std::vector<Real> kg = conditioned.liquid_kg;
  for (std::size_t s = 0; s < conditioned.sorbed_kg.size(); ++s) kg[s] += conditioned.sorbed_kg[s];
  cloth.air_kg = std::make_shared<const std::vector<Real>>(std::move(kg));
  cloth.wet = wet;
  return cloth;
}

Real cling_pressure(Real crowns_per_area, Real crown_radius, Real surface_tension, Real cos_receding) {
  return crowns_per_area * 2 * pi * crown_radius * surface_tension * std::max(cos_receding, 0.0);
}

void weigh(NetworkCloth& cloth, std::span<const std::uint8_t> held, const YarnNetwork& network,
           const WettingModel& model, const Contents& contents, const ExchangeState& exchange, const MassLeft& left,
           WeighScratch& scratch) {
  Sheet& sheet = cloth.soft.sheet;
  find_wanted_mass(cloth, contents, exchange, scratch);
  set_added_mass(cloth.soft, held, scratch.sheet_kg, left);
  sum_yarns(cloth, network, model, contents, scratch);
  const WeighScratch& means = scratch;
  const YarnType& yarn = network.yarn_types.front();
  const Real cling = cling_pressure(0.5 / (network.pitch_x * network.pitch_y), yarn.radius,
                                    model.liquid.surface_tension, portable::cos(yarn.fibre.receding_angle));
  const Real damping = cloth.wet.damping > 0 ? cloth.wet.damping : cloth.soft.cloth.damping;
  for (std::size_t n = 0; n < sheet.size(); ++n) {
    if (!(means.length[n] > 0)) continue;
    sheet.stiffness_factor[n] = 1 - means.softened[n] / means.length[n];
    sheet.damping_added[n] = damping * means.swollen[n] / means.length[n];
    sheet.cling[n] = cling * std::min(1.0, means.filled[n] / means.length[n] / bridged_at);
  }
  wake_if_heavier(cloth.soft, waking_share);
}

}  // namespace imbibe
