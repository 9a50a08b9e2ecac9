// A yarn network with one liquid in it: what every node can hold and how easily liquid passes every edge.
// Derived once from geometry, materials and liquid; immutable afterwards (states are in Contents).
//
// Yarn (family of segments)      formula                                                    source
//   void share        eps_y      1 - phi_y
//   axial permeability   K_a     (8 R_f^2/53) eps_y^3/phi_y^2 / tau^2                        Gebart 1992, hexagonal
//   transverse           K_t     0.231 R_f^2 (sqrt(0.9069/phi_y) - 1)^(5/2) / tau^2          Gebart 1992
//   mean suction         P_h     gamma cos(theta_a + alpha) 2 phi_y/(R_f eps_y)              wetted perimeter / void area
//   entry suction        P_e     P_h 0.5^(1/lambda), so that P_c(1/2) = P_h
// Pore (between four crossings)
//   throat               r_t     w_x w_y/(w_x + w_y)
//   entry suction        P_e,p   2 gamma cos(theta)/r_t, theta the Cassie mean over the yarns around it
//   to emerge            P_open  4 gamma sin(theta)/p_mean                                   entry.h
// tau^2 is the one number per yarn that geometry does not give (2-10, default 4); alpha was calibrated on one class of
// cloth (plain polyester) and is a plain parameter.
#pragma once

#include <compare>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "imbibe/core/parameter.h"
#include "imbibe/core/types.h"
#include "imbibe/fabric/network.h"
#include "imbibe/wetting/along_yarn.h"
#include "imbibe/wetting/contents.h"
#include "imbibe/wetting/sorption.h"

namespace imbibe {

// The liquid as wetting sees it. Angles below zero: take each fibre's own.
struct WettingLiquid {
  Real density = 998.2;           // kg/m3
  Real viscosity = 1.002e-3;      // Pa s
  Real surface_tension = 0.0728;  // N/m
  Real advancing_angle = -1;      // rad, on every fibre; < 0: the fibre's
  Real receding_angle = -1;       // rad, on every fibre; < 0: the fibre's
};

enum class TransportModel { physical, kunzel, as_printed };
enum class SorptionModel { none, linear, shells, as_printed };
enum class SurfaceTemperature { isothermal, wet_bulb };

struct WettingParams {
  TransportModel model = TransportModel::physical;
  Real crossing_factor = 3;              // eta_c, times the contact patch's own conductance; 0 = no crossing
  Real pore_divergence = radians(10);    // alpha, added to theta_a inside a yarn
  Real yarn_size_index = 5;              // lambda of Brooks-Corey between the fibres
  Real pore_size_index = 2;              // lambda_p of the pores between yarns (corner menisci)
  Real yarn_overfill = 0.02;             // delta: a bulging yarn holds this much more than its voids
  Real pore_overfill = 0.2;              // delta: meniscus of a pore that is about to emerge
  bool pores = true;                     // pores between yarns take part
  bool hysteresis = false;               // fill with theta_a, drain with theta_r
  bool evaporation = true;
  SurfaceTemperature surface_temperature = SurfaceTemperature::isothermal;
  bool swelling = true;
  SorptionModel sorption = SorptionModel::linear;
  int shells = 16;                       // radial shells of a fibre, sorption = shells
  Real wetted_at = 0.1;                  // saturation from which all fibres of a segment are wetted
  Real redistribution_factor = 0.1;      // Kuenzel: D_ww / D_ws once nothing supplies the cloth
  Real printed_pore_velocity = 1e-3;     // m/s, U of eq. 10 as printed
  Real residual = 1e-6;                  // what may be left of a node's equation, in parts of its volume (transport.h)
};

template <class V>
void describe(V& v, WettingParams& p) {
  v.choice("model", p.model,
           {{"physical", TransportModel::physical},
            {"kunzel", TransportModel::kunzel},
            {"as_printed", TransportModel::as_printed}},
           "how liquid moves along yarns: Darcy with Brooks-Corey, Kuenzel's diffusivity from A_w, or the printed eq. 7");
  v.value("crossing_factor", p.crossing_factor,
          {.min = 0, .max = 1000, .help = "eta_c: conductance of a crossing over that of its contact patch; 0 = none"});
  v.value("pore_divergence_deg", p.pore_divergence,
          {.unit = "rad", .shown = "deg", .min = 0, .max = radians(30),
           .help = "alpha: fibres that cross and diverge raise the angle the meniscus must overcome"});
  v.value("yarn_size_index", p.yarn_size_index,
          {.min = 0.5, .max = 50, .help = "Brooks-Corey lambda of the voids between fibres"});
  v.value("pore_size_index", p.pore_size_index,
          {.min = 0.5, .max = 50, .help = "Brooks-Corey lambda of the pores between yarns"});
  v.value("yarn_overfill", p.yarn_overfill, {.min = 1e-3, .max = 0.5, .help = "over-full share of a bulging yarn"});
  v.value("pore_overfill", p.pore_overfill,
          {.min = 1e-3, .max = 1, .help = "over-full share of a pore whose meniscus is about to emerge"});
  v.value("pores", p.pores, {.help = "pores between yarns take part"});
  v.value("hysteresis", p.hysteresis, {.help = "fill with the advancing, drain with the receding angle"});
  v.value("evaporation", p.evaporation, {.help = "exchange vapour with the air at both faces"});
  v.choice("surface_temperature", p.surface_temperature,
           {{"isothermal", SurfaceTemperature::isothermal}, {"wet_bulb", SurfaceTemperature::wet_bulb}},
           "temperature of an evaporating surface");
  v.value("swelling", p.swelling, {.help = "wet fibres swell, pores shrink"});
  v.choice("sorption", p.sorption,
           {{"none", SorptionModel::none},
            {"linear", SorptionModel::linear},
            {"shells", SorptionModel::shells},
            {"as_printed", SorptionModel::as_printed}},
           "water into the fibre substance: linear driving force, radial shells, or the printed eq. 6");
  v.value("shells", p.shells, {.min = 4, .max = 64, .help = "radial shells per fibre"});
  v.value("wetted_at", p.wetted_at,
          {.min = 0, .max = 1, .above_min = true, .help = "saturation from which all fibres of a segment are wetted"});
  v.value("redistribution_factor", p.redistribution_factor,
          {.min = 0, .max = 1, .help = "Kuenzel: D_ww / D_ws once nothing supplies the cloth"});
  v.value("printed_pore_velocity", p.printed_pore_velocity,
          {.unit = "m/s", .min = 0, .max = 10, .help = "U of eq. 10 in the model as printed"});
  v.value("residual", p.residual,
          {.min = 1e-12, .max = 1e-4, .help = "what the solver may leave of a node's equation, in parts of its volume"});
}

inline constexpr std::uint8_t upper_face = 1, lower_face = 2;  // of the sheet, at +z and -z

// One yarn type with the liquid in it.
struct YarnWetting {
  bool wets = false;         // holds and carries liquid between its fibres
  Real void_share = 0;       // eps_y
  Real axial = 0, transverse = 0;  // m2, permeabilities
  Real entry = 0;            // Pa, P_e of filling
  Real entry_receding = 0;   // Pa, P_e of draining (hysteresis)
  Real open = 0;             // Pa, pressure at which a full yarn gives liquid off
  Real cos_advancing = 0;    // of the fibre surface
  Real diffusivity = 0;      // m2/s at saturation: Kuenzel 3.8 (A_w/w_f)^2, or eq. 7 at c_l = 0
  Real printed_share = 0;    // c_s of eq. 7: liquid volume per yarn volume
  Real sorption_rate = 0;    // 1/s, k = 8 D_f/R_f^2
  Real swelling_regain = 0;  // kg/kg, most that the fibre substance takes
  Real regain_65 = 0;
  Real area_swelling = 0;
  Real shell_rate = 0;       // 1/s, D_f/R_f^2
};

// What alike nodes share. The cloth repeats itself, so a sheet of millions of nodes has a few dozen kinds.
struct NodeKind {
  Index type = no_index;      // of a segment: into WettingModel::yarns
  std::uint8_t faces = 0;     // upper_face, lower_face, both; 0 between other layers
  bool wets = false;          // of a pore
  bool pore() const { return type == no_index; }
  Real dry_mass = 0;          // kg, of a segment: dry fibre
  Real yarn_volume = 0;       // m3, of a segment, pi r^2 length: fibres and voids
  Real volume = 0;            // m3 that s = 1 means: voids of the yarn, or the pore (both unswollen)
  Real entry = 0, entry_receding = 0, open = 0;  // Pa, as in YarnWetting
  Real overfill = 0, size_index = 0;
  Real corner_share = 1;      // of a pore: what its menisci hold at P_e once the middle is empty (capillary.h)
  Real supply_conductance = 0;   // liquid on the face -> node, units as LinkKind; pores see capillary.h (a tube) except
                                 // in the model as printed
  Real release_conductance = 0;  // m3/(Pa s), over-full node -> its faces
  Real vapour_area = 0;       // m2, of its faces that see the air
  Real throat = 0, breakthrough = 0;  // of a pore: m, Pa
  Real mouth = 0;             // of a pore: m2, w_x w_y
  auto operator<=>(const NodeKind&) const = default;
};

// What alike links share.
struct LinkKind {
  EdgeKind kind = EdgeKind::along_yarn;
  bool same_material = true;
  bool between_layers = false;  // of pores
  Index contact = no_index;  // face_back: into WettingModel::bridges
  // physical: m3/(Pa s). kunzel, as_printed: m (area/length x void share), multiplied by a diffusivity. Crossing of
  // different materials: `conductance` is the half link on a's side, `conductance_b` on b's.
  Real conductance = 0;
  Real conductance_b = 0;
  Real valve = 0;     // Pa, P_open of a pore-pore link
  auto operator<=>(const LinkKind&) const = default;
};

// The contact of two crowns of facing layers (face_back.h).
struct CrownBridge {
  Real gap = 0, area_per_height = 0;  // m
  Real most = 0;      // m2, area that the edge's conductance stands for
  Real cosines = 0;   // cos theta_a + cos theta_b
  auto operator<=>(const CrownBridge&) const = default;
};

struct WettingModel {
  WettingParams params;
  WettingLiquid liquid;
  std::size_t segments = 0, pores = 0;
  std::size_t nodes() const { return segments + pores; }
  Real thickness = 0;  // m, of one layer, also the length of a pore from face to face
  Real stack_thickness = 0;  // m, of all layers
  Real area = 0;       // m2 of the sheet, one face
  Real greatest_vapour_area = 0;  // m2/m3, of a segment: per volume that it holds

  // Materials
  std::vector<Fibre> fibres;          // per yarn type
  std::vector<YarnWetting> yarns;     // per yarn type

  // Nodes: numbers of their kinds, whose values are rounded to 30 bits (1e-9), so that rounding makes no kinds of its own.
  std::vector<NodeKind> kinds;
  std::vector<Index> kind;
  std::vector<Index> segment_type;
  std::vector<Vec3> centre;
  const NodeKind& at(std::size_t node) const { return kinds[kind[node]]; }
  Real volume(std::size_t node) const { return at(node).volume; }
  Real entry(std::size_t node) const { return at(node).entry; }
  Real entry_receding(std::size_t node) const { return at(node).entry_receding; }
  Real open(std::size_t node) const { return at(node).open; }
  Real overfill(std::size_t node) const { return at(node).overfill; }
  Real size_index(std::size_t node) const { return at(node).size_index; }
  Real supply_conductance(std::size_t node) const { return at(node).supply_conductance; }
  Real release_conductance(std::size_t node) const { return at(node).release_conductance; }
  Real vapour_area(std::size_t node) const { return at(node).vapour_area; }
  std::uint8_t faces(std::size_t node) const { return at(node).faces; }
  Real dry_mass(std::size_t segment) const { return at(segment).dry_mass; }
  Real yarn_volume(std::size_t segment) const { return at(segment).yarn_volume; }
  // `pore` counts from 0.
  const NodeKind& pore(std::size_t pore) const { return at(segments + pore); }
  bool pore_wets(std::size_t i) const { return pore(i).wets; }
  Real pore_throat(std::size_t i) const { return pore(i).throat; }
  Real pore_open(std::size_t i) const { return pore(i).open; }
  Real pore_breakthrough(std::size_t i) const { return pore(i).breakthrough; }
  Real pore_mouth(std::size_t i) const { return pore(i).mouth; }

  // Links, as the rows of a matrix: those of node i are [row_start[i], row_start[i+1]), to segments first, then to pores.
  // Each stands in the rows of both its nodes; a is the node with the lower number. Segment and pore that lie side by
  // side have a link even where no liquid can pass (conductance 0): swelling and fibres without voids ask for it.
  std::vector<LinkKind> links;
  std::vector<CrownBridge> bridges;
  std::vector<Index> row_start;       // nodes + 1
  std::vector<Index> row_other, row_link;
  // All nodes by place, pitch row after pitch row and along each row: neighbours in the cloth stand close together in
  // the linear systems too, whose incomplete factors then keep their links.
  std::vector<Index> by_place;

  // Who lies beside whom, pores as node numbers.
  std::span<const Index> segments_of_pore(std::size_t pore) const {
    const std::size_t node = segments + pore;
    return {row_other.data() + row_start[node], first_pore(node)};
  }
  std::span<const Index> pores_of_segment(std::size_t segment) const {
    return {first_pore(segment), row_other.data() + row_start[segment + 1]};
  }
  const Index* first_pore(std::size_t node) const {
    const Index* entry = row_other.data() + row_start[node];
    const Index* end = row_other.data() + row_start[node + 1];
    while (entry != end && *entry < segments) ++entry;
    return entry;
  }

  RadialShells shells;                // sorption = shells
};

inline Retention retention_of(const NodeKind& kind) {
  return {kind.entry, kind.size_index, kind.open, kind.overfill, kind.corner_share};
}
// p(s) of a node on its filling branch; a pore that does not wet pushes its liquid out at every content.
Sloped filling_pressure(const NodeKind& node, Real saturation);
inline Sloped filling_pressure(const WettingModel& model, std::size_t node, Real saturation) {
  return filling_pressure(model.at(node), saturation);
}
// As above; below the highest saturation reached since the node was dry, the draining branch and the way to it.
Sloped hysteretic_pressure(const WettingModel& model, std::size_t node, Real saturation, Real reached);

// Throws InputError where network and parameters make no model (pores without volume, a yarn with no radius, ...).
WettingModel build_wetting_model(const YarnNetwork& network, const WettingParams& params, const WettingLiquid& liquid);

// Fibres at their regain in the air, no liquid between them.
Contents conditioned_contents(const WettingModel& model, const Air& air);

// Volume that saturation 1 means now, swelling counted (m3).
Real current_volume(const WettingModel& model, const Contents& contents, std::size_t node);

// Liquid per what the node holds when full: 0 .. 1 + overfill. A yarn whose fibres do not wet holds none: 0. A
// monofilament: its sorbed water between the regain at 65 % relative humidity (0) and full swelling (1).
Real saturation(const WettingModel& model, const Contents& contents, std::size_t node);

// Liquid pressure of the node, Pa (negative: suction).
Real node_pressure(const WettingModel& model, const Contents& contents, std::size_t node);

// kg water per kg dry fibre of a segment.
Real node_regain(const WettingModel& model, const Contents& contents, std::size_t segment);

// Sums in fixed order, kg.
Real total_sorbed_kg(const WettingModel& model, const Contents& contents);
Real total_yarn_kg(const WettingModel& model, const Contents& contents);
Real total_pore_kg(const WettingModel& model, const Contents& contents);

}  // namespace imbibe
