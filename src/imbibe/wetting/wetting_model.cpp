#include "imbibe/wetting/wetting_model.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <fmt/format.h>

#include "imbibe/core/error.h"
#include "imbibe/core/portable.h"
#include "imbibe/wetting/capillary.h"
#include "imbibe/wetting/crossing.h"
#include "imbibe/wetting/entry.h"
#include "imbibe/wetting/face_back.h"
#include "imbibe/wetting/isotherm.h"
#include "imbibe/wetting/swelling.h"

namespace imbibe {
namespace {

// 90 deg in radians has a cosine of 6e-17: what is left by rounding is no suction, and a network driven by it never ends.
constexpr Real neutral_cosine = 1e-9;
constexpr Real least_kunzel_entry = 100;           // Pa, where a yarn known only by A_w has no suction of its own
constexpr Real water_self_diffusion = 2.3e-9;      // m2/s, D* of eq. 10

Real advancing_angle(const Fibre& fibre, const WettingLiquid& liquid) {
  return liquid.advancing_angle >= 0 ? liquid.advancing_angle : fibre.advancing_angle;
}
Real receding_angle(const Fibre& fibre, const WettingLiquid& liquid) {
  return liquid.receding_angle >= 0 ? liquid.receding_angle : fibre.receding_angle;
}

YarnWetting yarn_wetting(const YarnType& type, const WettingParams& p, const WettingLiquid& liquid) {
  const Fibre& fibre = type.fibre;
  YarnWetting yarn;
  yarn.void_share = type.monofilament ? 0 : type.void_share();
  yarn.cos_advancing = portable::cos(advancing_angle(fibre, liquid));
  yarn.sorption_rate = sorption_rate(fibre.diffusivity, fibre.radius);
  yarn.shell_rate = fibre.diffusivity / (fibre.radius * fibre.radius);
  yarn.swelling_regain = fibre.swelling_regain();
  yarn.regain_65 = equilibrium_regain(fibre, 0.65);
  yarn.area_swelling = p.swelling ? fibre.area_swelling : 0;
  const Real coefficient =
      type.absorption_coefficient > 0 ? type.absorption_coefficient : fibre.absorption_coefficient;
  if (p.model == TransportModel::as_printed) {
    yarn.printed_share = fibre.density * yarn.regain_65 / liquid.density;
    yarn.wets = coefficient > 0 && yarn.printed_share > 0;
    if (yarn.wets) yarn.diffusivity = printed_diffusivity(coefficient, liquid.density, yarn.printed_share);
    return yarn;
  }
  if (yarn.void_share <= 0) return yarn;
  yarn.axial = axial_permeability(fibre.radius, type.packing, type.tortuosity_squared);
  yarn.transverse = transverse_permeability(fibre.radius, type.packing, type.tortuosity_squared);
  const auto entry = [&](Real angle) {
    const Real inside = portable::cos(std::min(pi, angle + p.pore_divergence));
    return entry_suction(mean_suction(liquid.surface_tension, inside, fibre.radius, type.packing), p.yarn_size_index);
  };
  yarn.entry = entry(advancing_angle(fibre, liquid));
  yarn.entry_receding = std::max(yarn.entry, entry(receding_angle(fibre, liquid)));
  yarn.wets = portable::cos(std::min(pi, advancing_angle(fibre, liquid) + p.pore_divergence)) > neutral_cosine;
  if (p.model == TransportModel::kunzel) {
    yarn.wets = coefficient > 0;
    yarn.entry = std::max(yarn.entry, least_kunzel_entry);
    yarn.entry_receding = std::max(yarn.entry, yarn.entry_receding);
    yarn.diffusivity = kunzel_diffusivity(coefficient, liquid.density * yarn.void_share);
  }
  return yarn;
}

// What lies around each pore: its yarns' radii, their mean wetting, and the pores beside each segment.
struct PoreSurroundings {
  std::vector<Real> warp_radius, weft_radius, cosine, cosine_receding;
};

PoreSurroundings surroundings(const YarnNetwork& network, const WettingLiquid& liquid) {
  const std::size_t pores = network.pores(), segments = network.segments();
  PoreSurroundings result;
  std::vector<std::array<Real, 6>> sums(pores);
  struct Cosines {
    Real advancing = 0, receding = 0;
  };
  std::vector<Cosines> of_type;
  for (const YarnType& type : network.yarn_types)
    of_type.push_back({portable::cos(advancing_angle(type.fibre, liquid)), portable::cos(receding_angle(type.fibre, liquid))});
  // A pore without yarns around it takes the first ones'.
  const Fibre first = network.yarn_types.empty() ? Fibre{} : network.yarn_types[0].fibre;
  const Cosines fallback{portable::cos(advancing_angle(first, liquid)), portable::cos(receding_angle(first, liquid))};
  for (const Edge& edge : network.edges) {
    if (edge.kind != EdgeKind::segment_pore) continue;
    const std::size_t segment = std::min(edge.a, edge.b), pore = std::max(edge.a, edge.b) - segments;
    const Index type = network.yarn_type[network.segment_yarn[segment]];
    auto& sum = sums[pore];
    const std::size_t family = network.family_of_segment(segment) == Family::warp ? 0 : 2;
    sum[family] += network.yarn_types[type].radius, sum[family + 1] += 1;
    sum[4] += of_type[type].advancing;
    sum[5] += of_type[type].receding;
  }
  for (std::size_t i = 0; i < pores; ++i) {
    const auto& sum = sums[i];
    const Real count = sum[1] + sum[3];
    result.warp_radius.push_back(sum[1] > 0 ? sum[0] / sum[1] : 0);
    result.weft_radius.push_back(sum[3] > 0 ? sum[2] / sum[3] : 0);
    result.cosine.push_back(count > 0 ? sum[4] / count : fallback.advancing);
    result.cosine_receding.push_back(count > 0 ? sum[5] / count : fallback.receding);
  }
  return result;
}

void check_input(const YarnNetwork& network, const WettingLiquid& liquid) {
  std::vector<Problem> problems;
  const auto report = [&](std::string key, std::string message) {
    problems.push_back({.file = {}, .key = std::move(key), .message = std::move(message)});
  };
  if (!(liquid.density > 0)) report("liquid.density", fmt::format("{} kg/m3 is not above 0", liquid.density));
  if (!(liquid.viscosity > 0)) report("liquid.viscosity", fmt::format("{} Pa s is not above 0", liquid.viscosity));
  if (!(liquid.surface_tension > 0)) {
    report("liquid.surface_tension", fmt::format("{} N/m is not above 0", liquid.surface_tension));
  }
  if (!(network.thickness > 0)) report("thickness", fmt::format("{} m is not above 0", network.thickness));
  for (std::size_t i = 0; i < network.yarn_types.size(); ++i) {
    const YarnType& type = network.yarn_types[i];
    const std::string key = fmt::format("yarn_types[{}]", i);
    if (!(type.radius > 0)) report(key + ".radius", fmt::format("{} m is not above 0", type.radius));
    if (!(type.packing > 0 && type.packing <= 1)) {
      report(key + ".packing", fmt::format("{} is outside (0, 1]", type.packing));
    }
    if (!(type.fibre.radius > 0)) report(key + ".fibre.radius", fmt::format("{} m is not above 0", type.fibre.radius));
    if (!(type.fibre.density > 0)) {
      report(key + ".fibre.density", fmt::format("{} kg/m3 is not above 0", type.fibre.density));
    }
    if (!(type.tortuosity_squared > 0)) {
      report(key + ".tortuosity_squared", fmt::format("{} is not above 0", type.tortuosity_squared));
    }
  }
  for (std::size_t i = 0; i < network.pores(); ++i) {
    if (!(network.pore_volume[i] > 0)) {
      report(fmt::format("pores[{}]", i),
             fmt::format("its volume is {} m3: the yarns fill more than the cell; widen the pitch or the thickness",
                         network.pore_volume[i]));
      break;
    }
  }
  if (!problems.empty()) throw InputError(std::move(problems));
}

// To 30 bits: two values that differ by rounding become one, and so do their kinds.
Real rounded(Real value) {
  constexpr std::uint64_t half = std::uint64_t{1} << 21;
  const auto bits = std::bit_cast<std::uint64_t>(value) + half;
  return std::isfinite(value) ? std::bit_cast<Real>(bits & ~(2 * half - 1)) : value;
}

// Each value once, numbered in the order in which they come.
template <class T>
class Numbered {
 public:
  explicit Numbered(std::vector<T>& values) : values_(values) {}
  Index operator()(const T& value) {
    if (!values_.empty() && values_[last_] == value) return last_;
    const auto [at, is_new] = number_.try_emplace(value, static_cast<Index>(values_.size()));
    if (is_new) values_.push_back(value);
    return last_ = at->second;
  }

 private:
  struct Before {
    bool operator()(const T& a, const T& b) const { return (a <=> b) < 0; }
  };
  std::vector<T>& values_;
  std::map<T, Index, Before> number_;
  Index last_ = 0;
};

std::uint8_t faces_of(const YarnNetwork& network, std::size_t node) {
  return static_cast<std::uint8_t>((network.on_face(node, true) ? upper_face : 0) |
                                   (network.on_face(node, false) ? lower_face : 0));
}
int count_faces(std::uint8_t faces) { return (faces & upper_face ? 1 : 0) + (faces & lower_face ? 1 : 0); }

// The area of the sheet that a segment stands for, before those of its layer are made to add up.
Real plan_area(const YarnNetwork& network, std::size_t s) {
  return network.segment_length[s] * (network.family_of_segment(s) == Family::warp ? network.pitch_x : network.pitch_y);
}

NodeKind segment_kind(const WettingModel& m, const YarnNetwork& network, std::size_t s) {
  const YarnType& type = network.type_of_segment(s);
  const YarnWetting& yarn = m.yarns[m.segment_type[s]];
  const Real length = network.segment_length[s], r = type.radius;
  const bool printed = m.params.model == TransportModel::as_printed;
  NodeKind kind{.type = m.segment_type[s], .faces = faces_of(network, s)};
  kind.yarn_volume = pi * r * r * length;
  const Real solid = type.monofilament ? 1 : type.packing;
  kind.dry_mass = type.linear_density > 0 ? type.linear_density * length : type.fibre.density * solid * kind.yarn_volume;
  kind.volume = !yarn.wets ? 0 : kind.yarn_volume * (printed ? yarn.printed_share : yarn.void_share);
  kind.entry = yarn.entry;
  kind.entry_receding = yarn.entry_receding;
  kind.open = m.liquid.surface_tension / r;
  kind.overfill = m.params.yarn_overfill;
  kind.size_index = m.params.yarn_size_index;
  // From the face to the yarn's middle: half its perimeter over half its radius.
  const Real patch = 0.5 * pi * r * length / (0.5 * r);
  const Real anisotropy = yarn.axial > 0 ? yarn.transverse / yarn.axial : 0;
  const Real to_face = yarn.wets ? yarn.transverse * patch / m.liquid.viscosity : 0;
  kind.release_conductance = kind.faces != 0 ? to_face : 0;
  switch (m.params.model) {
    case TransportModel::physical: kind.supply_conductance = to_face; break;
    case TransportModel::kunzel:
      kind.supply_conductance = yarn.wets ? yarn.void_share * yarn.diffusivity * anisotropy * patch : 0;
      break;
    case TransportModel::as_printed: kind.supply_conductance = yarn.printed_share * yarn.diffusivity * patch; break;
  }
  return kind;
}

// The pressures of a pore, found by trying many menisci: once for each opening and angle.
class PorePressures {
 public:
  explicit PorePressures(Real tension) : tension_(tension) {}
  struct Pair {
    Real open = 0, breakthrough = 0;
  };
  Pair operator()(const PoreOpening& opening, Real cosine) {
    const std::array<Real, 5> key{rounded(opening.gap_x), rounded(opening.gap_y), rounded(opening.radius_x),
                                  rounded(opening.radius_y), rounded(cosine)};
    const auto [at, is_new] = known_.try_emplace(key);
    if (is_new) {
      const PoreOpening alike{.gap_x = key[0], .gap_y = key[1], .radius_x = key[2], .radius_y = key[3]};
      const Real angle = portable::acos(std::clamp<Real>(key[4], -1, 1));
      at->second = {opening_pressure(tension_, angle, alike), breakthrough_pressure(tension_, angle, alike)};
    }
    return at->second;
  }

 private:
  Real tension_;
  std::map<std::array<Real, 5>, Pair> known_;
};

NodeKind pore_kind(const WettingModel& m, const YarnNetwork& network, const PoreSurroundings& around,
                   PorePressures& pressures, std::size_t i) {
  const Real tension = m.liquid.surface_tension;
  const Real cosine = std::clamp<Real>(around.cosine[i], -1, 1);
  const PoreOpening opening{.gap_x = network.pore_opening_x[i], .gap_y = network.pore_opening_y[i],
                            .radius_x = around.warp_radius[i], .radius_y = around.weft_radius[i]};
  const PorePressures::Pair pressure = pressures(opening, cosine);
  NodeKind kind{.faces = faces_of(network, m.segments + i), .wets = cosine > neutral_cosine};
  kind.throat = network.pore_throat[i];
  kind.entry = std::max<Real>(0, throat_suction(tension, cosine, kind.throat));
  kind.entry_receding = std::max(kind.entry, throat_suction(tension, around.cosine_receding[i], kind.throat));
  kind.open = pressure.open;
  kind.breakthrough = pressure.breakthrough;
  kind.mouth = opening.gap_x * opening.gap_y;
  kind.volume = m.params.pores ? network.pore_volume[i] : 0;
  kind.overfill = m.params.pore_overfill;
  kind.size_index = m.params.pore_size_index;
  if (kind.volume > 0) kind.corner_share = pore_ring_share(opening.radius_x, opening.radius_y, kind.throat, kind.volume);
  // Half the way from face to face on average.
  const int faces = count_faces(kind.faces);
  kind.release_conductance = faces > 0 ? tube_conductance(kind.throat, m.liquid.viscosity, 0.5 * m.thickness) : 0;
  const Real printed = printed_pore_diffusivity(water_self_diffusion, kind.throat, m.params.printed_pore_velocity) *
                       kind.mouth / (0.5 * m.thickness);
  kind.supply_conductance = m.params.model == TransportModel::as_printed ? printed : 0;
  kind.vapour_area = faces * network.pore_area[i];
  return kind;
}

// A bulging yarn gives off where its pores do: the mean of their opening pressures; 0 where it has none.
std::vector<Real> openings_beside(const WettingModel& m, const YarnNetwork& network) {
  std::vector<Real> sum(m.segments, 0);
  std::vector<std::uint8_t> count(m.segments, 0);
  for (const Edge& edge : network.edges) {
    if (edge.kind != EdgeKind::segment_pore) continue;
    const Index segment = std::min(edge.a, edge.b), pore = std::max(edge.a, edge.b);
    sum[segment] += m.open(pore);
    ++count[segment];
  }
  for (std::size_t s = 0; s < m.segments; ++s) sum[s] = count[s] > 0 ? sum[s] / count[s] : 0;
  return sum;
}

void add_nodes(WettingModel& m, const YarnNetwork& network) {
  const auto round = [](NodeKind kind) {
    for (Real* value : {&kind.dry_mass, &kind.yarn_volume, &kind.volume, &kind.entry, &kind.entry_receding, &kind.open,
                        &kind.supply_conductance, &kind.release_conductance, &kind.vapour_area, &kind.throat,
                        &kind.breakthrough, &kind.mouth, &kind.corner_share})
      *value = rounded(*value);
    return kind;
  };
  Numbered<NodeKind> number(m.kinds);
  m.kind.resize(m.nodes());
  m.centre.reserve(m.nodes());
  for (std::size_t i = 0; i < m.nodes(); ++i) m.centre.push_back(network.node_centre(i));
  const PoreSurroundings around = surroundings(network, m.liquid);
  PorePressures pressures(m.liquid.surface_tension);
  for (std::size_t i = 0; i < m.pores; ++i)
    m.kind[m.segments + i] = number(round(pore_kind(m, network, around, pressures, i)));
  std::vector<Real> area(static_cast<std::size_t>(network.layers), 0);
  for (std::size_t s = 0; s < m.segments; ++s) area[static_cast<std::size_t>(network.layer_of(s))] += plan_area(network, s);
  const std::vector<Real> opening = m.params.pores ? openings_beside(m, network) : std::vector<Real>(m.segments, 0);
  for (std::size_t s = 0; s < m.segments; ++s) {
    NodeKind kind = segment_kind(m, network, s);
    if (opening[s] > 0) kind.open = opening[s];
    // The faces that see the air, shared by the segments of their layer: a boundary layer of millimetres does not see the
    // gaps. Vapour through a covered face, past the other layer, is left out.
    const Real sum = area[static_cast<std::size_t>(network.layer_of(s))];
    kind.vapour_area = sum > 0 ? plan_area(network, s) * count_faces(kind.faces) * m.area / sum : 0;
    m.kind[s] = number(round(kind));
  }
  for (const NodeKind& kind : m.kinds) {
    if (kind.type == no_index || kind.volume <= 0) continue;
    m.greatest_vapour_area = std::max(m.greatest_vapour_area, kind.vapour_area / kind.volume);
  }
}

bool same_material(const WettingModel& m, Index type_a, Index type_b) {
  if (type_a == type_b) return true;
  const YarnWetting &a = m.yarns[type_a], &b = m.yarns[type_b];
  return a.entry == b.entry && a.entry_receding == b.entry_receding && a.transverse == b.transverse &&
         a.diffusivity == b.diffusivity && a.void_share == b.void_share && a.printed_share == b.printed_share;
}

// What an axial flow is multiplied by: K/eta, or D times the share of the section that holds liquid.
Real axial_factor(const WettingModel& m, const YarnWetting& yarn) {
  switch (m.params.model) {
    case TransportModel::physical: return yarn.axial / m.liquid.viscosity;
    case TransportModel::kunzel: return yarn.void_share * yarn.diffusivity;
    case TransportModel::as_printed: return yarn.printed_share * yarn.diffusivity;
  }
  return 0;
}

Real transverse_factor(const WettingModel& m, const YarnWetting& yarn) {
  if (m.params.model == TransportModel::as_printed) return axial_factor(m, yarn);
  return yarn.axial > 0 ? axial_factor(m, yarn) * yarn.transverse / yarn.axial : 0;
}

// Facing pores of two layers: both throats, each over half its layer.
void set_facing_pores(const WettingModel& m, std::size_t a, std::size_t b, LinkKind& link) {
  const auto half = [&](std::size_t pore) {
    if (m.params.model != TransportModel::as_printed)
      return tube_conductance(m.pore_throat(pore), m.liquid.viscosity, 0.5 * m.thickness);
    return printed_pore_diffusivity(water_self_diffusion, m.pore_throat(pore), m.params.printed_pore_velocity) *
           m.pore_mouth(pore) / (0.5 * m.thickness);
  };
  link.valve = std::max(m.pore_open(a), m.pore_open(b));
  link.conductance = 1 / (1 / half(a) + 1 / half(b));
}

// Sets the conductance; false where no liquid can pass.
bool set_conductance(const WettingModel& m, const YarnNetwork& network, const Edge& edge, LinkKind& link) {
  const auto yarn_of = [&](Index s) -> const YarnWetting& { return m.yarns[m.segment_type[s]]; };
  const auto along = [&](Index s, Real length) {
    const Real r = network.type_of_segment(s).radius;
    return axial_factor(m, yarn_of(s)) * pi * r * r / length;
  };
  switch (link.kind) {
    case EdgeKind::along_yarn:
      link.conductance = along(edge.a, 0.5 * (network.segment_length[edge.a] + network.segment_length[edge.b]));
      break;
    case EdgeKind::crossing:
    case EdgeKind::face_back: {
      const bool layers = link.kind == EdgeKind::face_back;
      const Real factor = layers ? 1 : m.params.crossing_factor;
      const auto half = [&](Index s) {
        const Real r = network.type_of_segment(s).radius;
        const bool printed = m.params.model == TransportModel::as_printed;
        // As printed: eta D over the same distance as along the yarn; crossing_factor 3 stands for eta = 1.
        if (printed) return (layers ? 1 : factor / 3) * along(s, network.segment_length[s]);
        const Real patch = layers ? m.bridges[link.contact].most : contact_patch(r);
        return factor * transverse_factor(m, yarn_of(s)) * patch / contact_distance(r);
      };
      link.same_material = same_material(m, m.segment_type[edge.a], m.segment_type[edge.b]);
      const Real a = half(edge.a), b = half(edge.b);
      if (!(a > 0 && b > 0)) return false;
      link.conductance = link.same_material ? 2 / (1 / a + 1 / b) : 2 * a;
      link.conductance_b = 2 * b;
      break;
    }
    case EdgeKind::segment_pore: {
      const std::size_t pore = edge.b - m.segments;
      const Real length = network.segment_length[edge.a];
      const bool warp = network.family_of_segment(edge.a) == Family::warp;
      const Real gap = warp ? network.pore_opening_y[pore] : network.pore_opening_x[pore];
      const Real pitch = warp ? network.pitch_y : network.pitch_x;
      const Real lateral = transverse_factor(m, yarn_of(edge.a)) * 0.4 * pi * length;
      link.conductance = yarn_pore_conductance(lateral, along(edge.a, length), 0.5 * std::max(0.0, pitch - gap), gap);
      break;
    }
    case EdgeKind::pore_pore: {
      const std::size_t a = edge.a - m.segments, b = edge.b - m.segments;
      if (network.layer_of(edge.a) != network.layer_of(edge.b)) {
        link.between_layers = true;
        set_facing_pores(m, a, b, link);
        break;
      }
      const Vec3 offset = m.centre[edge.b] - m.centre[edge.a];
      const bool in_x = std::abs(offset.x) > std::abs(offset.y);
      const auto& gap = in_x ? network.pore_opening_y : network.pore_opening_x;
      const Real free_along = in_x ? 0.5 * (network.pore_opening_x[a] + network.pore_opening_x[b])
                                   : 0.5 * (network.pore_opening_y[a] + network.pore_opening_y[b]);
      const Real distance = norm(offset), width = 0.5 * (gap[a] + gap[b]);
      const Real height = 0.5 * std::max<Real>(0, m.thickness - (distance - free_along));
      link.valve = 0.5 * (m.pore_open(a) + m.pore_open(b));
      link.conductance = slot_conductance(width, height, m.liquid.viscosity, distance);
      if (m.params.model == TransportModel::as_printed) {
        const Real radius = 0.5 * (m.pore_throat(a) + m.pore_throat(b));
        link.conductance = printed_pore_diffusivity(water_self_diffusion, radius, m.params.printed_pore_velocity) *
                           width * m.thickness / distance;
      }
      break;
    }
  }
  return link.conductance > 0;
}

CrownBridge bridge_of(const WettingModel& m, const YarnNetwork& network, const Edge& edge, const FaceContact& contact) {
  const Real narrow = std::min(network.type_of_segment(edge.a).radius, network.type_of_segment(edge.b).radius);
  const auto cosine = [&](Index s) { return m.yarns[m.segment_type[s]].cos_advancing; };
  return {rounded(contact.gap), rounded(contact.area_per_height), rounded(contact_patch(narrow)),
          rounded(cosine(edge.a) + cosine(edge.b))};
}

struct NumberedLink {
  Index a = 0, b = 0, link = 0;
};

// The links of the network, a below b; segment and pore side by side have one in any case.
std::vector<NumberedLink> find_links(WettingModel& m, const YarnNetwork& network) {
  const std::size_t first_contact = network.edges.size() - network.face_contacts.size();
  Numbered<LinkKind> number(m.links);
  Numbered<CrownBridge> bridge(m.bridges);
  std::vector<NumberedLink> found;
  found.reserve(network.edges.size());
  for (std::size_t e = 0; e < network.edges.size(); ++e) {
    Edge edge = network.edges[e];
    if (edge.a > edge.b) edge = {edge.b, edge.a, edge.kind};
    const bool beside = edge.kind == EdgeKind::segment_pore, with_pore = beside || edge.kind == EdgeKind::pore_pore;
    LinkKind link{.kind = edge.kind};
    if (edge.kind == EdgeKind::face_back)
      link.contact = bridge(bridge_of(m, network, edge, network.face_contacts[e - first_contact]));
    const bool possible = with_pore ? m.params.pores : m.volume(edge.a) > 0 && m.volume(edge.b) > 0;
    const bool open = possible && set_conductance(m, network, edge, link);
    if (!open && !beside) continue;
    if (!open) link = {.kind = edge.kind};
    for (Real* value : {&link.conductance, &link.conductance_b, &link.valve}) *value = rounded(*value);
    found.push_back({edge.a, edge.b, number(link)});
  }
  return found;
}

void build_rows(WettingModel& m, const std::vector<NumberedLink>& found) {
  m.row_start.assign(m.nodes() + 1, 0);
  for (const NumberedLink& link : found) ++m.row_start[link.a + 1], ++m.row_start[link.b + 1];
  for (std::size_t i = 0; i < m.nodes(); ++i) m.row_start[i + 1] += m.row_start[i];
  m.row_other.resize(m.row_start.back());
  m.row_link.resize(m.row_start.back());
  std::vector<Index> next(m.row_start.begin(), m.row_start.end() - 1);
  const auto put = [&](Index node, Index other, Index link) {
    m.row_other[next[node]] = other, m.row_link[next[node]++] = link;
  };
  for (const bool to_segments : {true, false}) {
    for (const auto& [a, b, link] : found) {
      if ((b < m.segments) == to_segments) put(a, b, link);
      if ((a < m.segments) == to_segments) put(b, a, link);
    }
  }
}

void order_by_place(WettingModel& m, const YarnNetwork& network) {
  struct Place {
    Real row, x;  // row: of pitches
    Index node;
    auto operator<=>(const Place&) const = default;
  };
  std::vector<Place> places;
  places.reserve(m.nodes());
  const Real pitch = network.pitch_y > 0 ? network.pitch_y : network.thickness;
  for (Index i = 0; i < m.nodes(); ++i) places.push_back({std::floor(m.centre[i].y / pitch + 1e-6), m.centre[i].x, i});
  std::sort(places.begin(), places.end());
  m.by_place.reserve(m.nodes());
  for (const Place& place : places) m.by_place.push_back(place.node);
}

}  // namespace

WettingModel build_wetting_model(const YarnNetwork& network, const WettingParams& params,
                                 const WettingLiquid& liquid) {
  check_input(network, liquid);
  WettingModel m;
  m.params = params;
  m.liquid = liquid;
  m.segments = network.segments();
  m.pores = network.pores();
  m.thickness = network.layer_thickness();
  m.stack_thickness = network.thickness;
  m.area = network.size_x * network.size_y;
  for (const YarnType& type : network.yarn_types) {
    m.fibres.push_back(type.fibre);
    m.yarns.push_back(yarn_wetting(type, params, liquid));
  }
  m.segment_type.reserve(m.segments);
  for (std::size_t s = 0; s < m.segments; ++s) m.segment_type.push_back(network.yarn_type[network.segment_yarn[s]]);
  add_nodes(m, network);
  build_rows(m, find_links(m, network));
  order_by_place(m, network);
  if (params.sorption == SorptionModel::shells) m.shells = build_radial_shells(params.shells);
  return m;
}

}  // namespace imbibe
