#include "imbibe/coupling/film.h"

#include <limits>

#include "imbibe/coupling/wet_wall.h"
#include "imbibe/liquid/drop_shape.h"

namespace imbibe {
namespace {

// Whether liquid stands in the pore's mouth: fed from the face it has the pressure there, within some Pa; what yarns fill is
// held by their suction, a kPa within the first pitch beyond the film.
bool flush(const WettingModel& m, const Contents& contents, Index pore) {
  constexpr Real suction = 0.1;  // of P_e
  return m.pore_wets(pore - m.segments) && node_pressure(m, contents, pore) > -suction * m.entry(pore);
}

struct Film {
  Real cos_angle = 0;           // mean over the patch's particles
  Real cover = 0, reach = 0;    // m2
  Real weight = 0;              // m2, sum of the areas that it is drawn through
  Real beta = 0;
  bool spreads() const { return beta > 0; }
};

std::vector<Film> films_of(const FaceMap& map, const Footprint& f) {
  std::vector<Film> films(f.patches.size());
  for (std::size_t p = 0; p < f.particle.size(); ++p) {
    Film& film = films[f.patch_of[p]];
    for (Index l = f.first_link[p]; l < f.first_link[p + 1]; ++l)
      film.cos_angle += f.links[l].share * cos_wet_face(map.cos_receding[f.links[l].node], 1);
  }
  for (std::size_t i = 0; i < films.size(); ++i) films[i].cos_angle /= static_cast<Real>(f.patches[i].particles);
  return films;
}

// The supply of `node` for the film of `patch`; no_index where another patch has it.
Index supply_for(Footprint& f, Index node, Index patch, bool from_below) {
  Index& s = f.supply_of_node[node];
  if (s == no_index) {
    s = static_cast<Index>(f.supplies.size());
    f.supplies.push_back({.node = node, .pressure = f.patches[patch].pressure, .from_below = from_below});
    f.supply_patch.push_back(patch);
  } else if (f.supply_patch[s] == no_index) {  // only mass that waits there
    f.supply_patch[s] = patch;
    f.supplies[s].pressure = f.patches[patch].pressure;
  }
  return f.supply_patch[s] == patch ? s : no_index;
}

// Flush pores joined to those that a patch covers, as supplies; `reached` per supply: r_k.
void reach_flush_pores(const FaceMap& map, const WettingModel& m, const Contents& contents, Footprint& f,
                      std::vector<Film>& films, std::vector<Real>& reached) {
  for (std::size_t s = 0; s < f.supplies.size(); ++s) {  // grows meanwhile
    reached.resize(f.supplies.size(), 0);
    const FaceSupply supply = f.supplies[s];
    const Index patch = f.supply_patch[s];
    if (supply.node < m.segments || patch == no_index) continue;
    const Real area = map.face_area[supply.node];
    films[patch].cover += area * supply.wetted_share;
    const bool joined = flush(m, contents, supply.node);
    films[patch].reach += area * (joined ? 1 : supply.wetted_share);
    if (!joined) continue;
    reached[s] = 1;
    const std::vector<std::uint8_t>& on_face = supply.from_below ? map.on_lower : map.on_upper;
    for (const Index segment : m.segments_of_pore(supply.node - m.segments)) {
      if (!on_face[segment]) continue;
      const std::span<const Index> pores = m.pores_of_segment(segment);
      const Index beside = supply_for(f, segment, patch, supply.from_below);
      reached.resize(f.supplies.size(), 0);
      if (beside != no_index) reached[beside] += 1 / static_cast<Real>(pores.size());
      for (const Index pore : pores) {
        if (f.supply_of_node[pore] == no_index && flush(m, contents, pore))
          supply_for(f, pore, patch, supply.from_below);
      }
    }
  }
  reached.resize(f.supplies.size(), 0);
  // A segment beside pores that are not flush would fill these: only those count whose pores all are, one n-th from each of n,
  // which adds up to 1 but for rounding.
  constexpr Real all = 1 - 1e-9;
  for (Real& share : reached) share = share >= all ? 1 : 0;
}

}  // namespace

Real cap_base_area(Real volume, Real cos_angle) {
  const Real c = std::clamp<Real>(cos_angle, -1, 1);
  if (c == 1) return std::numeric_limits<Real>::infinity();
  const Real radius = cap_radius(volume, c);
  return pi * (1 - c * c) * radius * radius;
}

void spread_films(const Liquid& liquid, const FaceMap& map, const WettingModel& m, const Contents& contents,
                  const ExchangeState& exchange, Footprint& f) {
  if (f.empty() || m.params.model == TransportModel::as_printed) return;
  std::vector<Film> films = films_of(map, f);
  std::vector<Real> reached;
  reach_flush_pores(map, m, contents, f, films, reached);
  const Real dx = liquid.spacing();
  for (std::size_t i = 0; i < films.size(); ++i) {
    Film& film = films[i];
    if (film.cos_angle <= 0 || film.reach <= film.cover) continue;
    const Real cap = cap_base_area(static_cast<Real>(f.patches[i].particles) * dx * dx * dx, film.cos_angle);
    film.beta = std::clamp<Real>((cap - film.cover) / (film.reach - film.cover), 0, 1);
  }
  for (std::size_t s = 0; s < f.supplies.size(); ++s) {
    const Index patch = f.supply_patch[s];
    if (patch == no_index || !films[patch].spreads()) continue;
    Real& share = f.supplies[s].wetted_share;
    share += films[patch].beta * std::max<Real>(0, reached[s] - share);
    films[patch].weight += share * map.face_area[f.supplies[s].node];
  }
  for (std::size_t s = 0; s < f.supplies.size(); ++s) {
    const Index patch = f.supply_patch[s];
    if (patch == no_index || !films[patch].spreads()) continue;
    FaceSupply& supply = f.supplies[s];
    const Real pool = std::max<Real>(0, f.patches[patch].touching_kg - f.patches[patch].owed_kg);
    supply.available_kg = std::max<Real>(0, exchange.waiting_kg[supply.node]) +
                          pool * supply.wetted_share * map.face_area[supply.node] / films[patch].weight;
  }
}

}  // namespace imbibe
