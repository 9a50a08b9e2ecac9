#include "imbibe/sim/mechanism.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "imbibe/core/portable.h"

namespace imbibe {
namespace {

std::string entry_sentence(const Textile& textile, std::size_t type) {
  const YarnType& yarn = textile.fabric->network.yarn_types[type];
  const YarnWetting& wetting = textile.model->yarns[type];
  const Real angle = degrees(portable::acos(std::clamp(wetting.cos_advancing, -1.0, 1.0)));
  const std::string who = fmt::format("{} at {:.0f}°", yarn.fibre.name, angle);
  if (yarn.monofilament)
    return fmt::format("{}: a monofilament, which holds no liquid between fibres", who);
  if (wetting.wets) {
    // What a single such yarn, fed at one end, takes in the first second, as a length of full yarn.
    const Real reach = std::sqrt(sorptivity_squared(wetting.axial, wetting.entry, textile.model->liquid.viscosity,
                                                    wetting.void_share, textile.model->params.yarn_size_index));
    const std::string sucks = fmt::format("{}: fills by itself, the voids between its fibres suck with {:.2g} kPa at entry",
                                          who, 1e-3 * wetting.entry);
    if (textile.model->params.model != TransportModel::physical) return sucks;
    return fmt::format("{} and fill {:.2g} mm of a single yarn in its first second", sucks, 1e3 * reach);
  }
  return fmt::format("{}: no capillary entry between its fibres", who);
}

std::string pore_sentence(const WettingModel& model) {
  if (model.pores == 0 || !model.params.pores) return "Pores between yarns take no part.";
  Real suction = 0, open = std::numeric_limits<Real>::infinity(), breakthrough = open;
  bool wets = false;
  for (std::size_t i = 0; i < model.pores; ++i) {
    const NodeKind& pore = model.pore(i);
    wets = wets || pore.wets;
    suction = std::max(suction, pore.entry);
    open = std::min(open, pore.open);
    breakthrough = std::min(breakthrough, pore.breakthrough);
  }
  if (wets)
    return fmt::format("Pores between yarns fill with up to {:.0f} Pa of suction and hold until {:.0f} Pa.", suction, open);
  return fmt::format("Pores between yarns stay shut: liquid must press with {:.0f} Pa to break through.", breakthrough);
}

std::string layer_sentence(const Textile& textile) {
  const YarnNetwork& network = textile.fabric->network;
  std::vector<std::string> parts(static_cast<std::size_t>(network.layers));
  std::vector<Real> yarns(parts.size(), 0), pores(parts.size(), 0);
  for (std::size_t node = 0; node < network.nodes(); ++node)
    (network.is_pore(node) ? pores : yarns)[static_cast<std::size_t>(network.layer_of(node))] +=
        textile.contents.liquid_kg[node];
  for (std::size_t l = 0; l < parts.size(); ++l)
    parts[l] = fmt::format("{} {:.3g} mg ({:.3g} mg of it in pores)", l == 0 ? "upper layer" : fmt::format("layer {}", l + 1),
                           1e6 * (yarns[l] + pores[l]), 1e6 * pores[l]);
  return fmt::format("{}: {}; liquid passes from layer to layer where crowns touch, by the menisci between them.",
                     textile.name, fmt::join(parts, ", "));
}

}  // namespace

std::vector<std::string> explain_uptake(const World& world) {
  std::vector<std::string> sentences;
  for (const Textile& textile : world.textiles) {
    std::string entry;
    for (std::size_t type = 0; type < textile.fabric->network.yarn_types.size(); ++type) {
      const std::string sentence = entry_sentence(textile, type);
      if (entry.find(sentence) != std::string::npos) continue;  // warp and weft alike
      if (!entry.empty()) entry += "; ";
      entry += sentence;
    }
    sentences.push_back(fmt::format("{}: {}. {}", textile.name, entry, pore_sentence(*textile.model)));
    if (textile.fabric->network.layers > 1) sentences.push_back(layer_sentence(textile));
    const Real force = textile.exchange.normal_force;
    Real room = 0;
    for (std::size_t s = 0; s < textile.model->segments; ++s)
      room += textile.model->liquid.density * textile.model->volume(s);
    sentences.push_back(fmt::format(
        "{}: {:.3g} mg between fibres (room for {:.3g}), {:.3g} mg in pores, {:.3g} mg in fibre substance (with the regain at the start); "
        "{} particles were taken whole, {} came back; the liquid pressed with {:.3g} mN at the end.",
        textile.name, 1e6 * total_yarn_kg(*textile.model, textile.contents), 1e6 * room,
        1e6 * total_pore_kg(*textile.model, textile.contents),
        1e6 * total_sorbed_kg(*textile.model, textile.contents), textile.exchange.absorbed_particles,
        textile.exchange.released_particles, 1e3 * force));
  }
  return sentences;
}

}  // namespace imbibe
