// One step of a sheet: inner forces, weight, air, supports, solids, the sheet itself. Takes as many substeps of its own
// as its accuracy asks for.
//
// Every substep: external forces and weight change the velocities; constraints change them by impulses along what they
// constrain, evaluated where the velocities would carry the nodes (backward Euler, so energy can only fall); nodes move.
// All impulses between nodes are equal and opposite, so momentum is kept to rounding:
//   sum m v (after) - sum m v (before) = loads + weight + pins + solids + air     (ClothStepReport)
// Tested in tests/cloth/cloth_step_test.cpp and tests/physics/cloth_test.cpp.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "imbibe/cloth/fabric_hand.h"
#include "imbibe/cloth/sheet.h"
#include "imbibe/core/parameter.h"
#include "imbibe/geometry/shapes.h"

namespace imbibe {

enum class ClothModel { provot, xpbd };

// Springs as in Provot 1995; constants of one spring, whatever its length.
struct ProvotParams {
  Real structural = 50;  // N/m
  Real shear = 20;       // N/m
  Real flexion = 5;      // N/m
  Real limit = 0.10;     // greatest elongation that the correction leaves
};

struct ClothAirParams {
  Real density = 1.2;          // kg/m3
  Real normal_drag = 1.2;      // drag coefficient of the face, on the velocity across it
  Real tangential_drag = 0.02; // friction coefficient along the face
  Vec3 wind{};                 // m/s
};

struct ClothContactParams {
  bool self = true;       // the sheet collides with itself
  Real friction = 0.4;    // cloth on cloth, Coulomb
};

struct ClothParams {
  ClothModel model = ClothModel::xpbd;
  FabricHand hand{};
  ProvotParams provot{};
  Real damping = 1e-3;    // s: stress follows strain + damping * strain rate
  ClothAirParams air{};
  ClothContactParams contact{};
  Real strain_error = 0.002;  // xpbd: strain that the solver may leave beyond the material's own; sets the substeps
  Real longest_substep = 1e-3;   // s
  Real shortest_substep = 1e-6;  // s
};

template <class V>
void describe(V& v, ProvotParams& p) {
  v.value("structural", p.structural, {.unit = "N/m", .min = 0, .max = 1e9, .above_min = true,
                                       .help = "springs between neighbours along weft and warp"});
  v.value("shear", p.shear, {.unit = "N/m", .min = 0, .max = 1e9, .above_min = true,
                             .help = "springs along the diagonals of a cell"});
  v.value("flexion", p.flexion, {.unit = "N/m", .min = 0, .max = 1e9, .above_min = true,
                                 .help = "springs to the neighbour but one"});
  v.value("limit", p.limit, {.unit = "1", .shown = "%", .min = 0, .max = 10, .above_min = true,
                             .help = "elongation above which structural and shear springs are corrected"});
}

template <class V>
void describe(V& v, ClothAirParams& p) {
  v.value("density", p.density, {.unit = "kg/m3", .min = 0, .max = 100, .help = "of the air; 0: no drag"});
  v.value("normal_drag", p.normal_drag, {.unit = "1", .min = 0, .max = 10, .help = "drag coefficient across the face"});
  v.value("tangential_drag", p.tangential_drag, {.unit = "1", .min = 0, .max = 10,
                                                 .help = "friction coefficient along the face"});
  v.value("wind", p.wind, {.unit = "m/s", .help = "velocity of the air"});
}

template <class V>
void describe(V& v, ClothContactParams& p) {
  v.value("self", p.self, {.help = "the sheet collides with itself"});
  v.value("friction", p.friction, {.unit = "1", .min = 0, .max = 10, .help = "coefficient of friction, cloth on cloth"});
}

template <class V>
void describe(V& v, ClothParams& p) {
  v.choice("model", p.model, Choices<ClothModel>{{"provot", ClothModel::provot}, {"xpbd", ClothModel::xpbd}},
           "provot: springs with corrected over-stretch; xpbd: constraints with the fabric's measured stiffness");
  v.group("hand", p.hand, "the fabric's mass and stiffness (provot: mass and thickness only)");
  v.group("provot", p.provot, "springs of the provot model");
  v.value("damping", p.damping, {.unit = "s", .shown = "ms", .min = 0, .max = 10,
                                 .help = "inner damping: stress follows strain + damping * strain rate"});
  v.group("air", p.air, "drag and wind");
  v.group("contact", p.contact, "collisions of the sheet with itself");
  v.value("strain_error", p.strain_error, {.unit = "1", .shown = "%", .min = 0, .max = 1, .above_min = true,
                                           .help = "strain that the solver may add to the material's own"});
  v.value("longest_substep", p.longest_substep, {.unit = "s", .shown = "ms", .min = 0, .max = 1, .above_min = true,
                                                 .help = "longest step of the cloth"});
  v.value("shortest_substep", p.shortest_substep, {.unit = "s", .shown = "us", .min = 0, .max = 1, .above_min = true,
                                                   .help = "shortest step of the cloth; the report says when it binds"});
}

// A solid that the sheet may not enter. `shape` stands where it is at the start of the step.
struct ClothSolid {
  Shape shape;
  Real friction = 0.3;  // Coulomb, cloth on this solid
  Vec3 velocity{};      // m/s, carries the shape through the step
};

struct ClothLoads {
  std::span<const Vec3> force{};  // N on each node during the whole step; empty: none
  Vec3 gravity{0, 0, -9.81};      // m/s2
  std::span<const ClothSolid> solids{};
  bool measure = true;            // fill in strain and energies of the report; costs about one substep
};

struct ClothStepReport {
  int substeps = 0;
  Real substep = 0;             // s, shortest taken
  Real greatest_strain = 0;     // elongation of the most stretched thread at the end of the step
  Real strain_error = 0;        // greatest strain that the solver added to the material's own
  Vec3 load_impulse{};          // N s on the sheet, each summed over nodes and substeps
  Vec3 weight_impulse{};
  Vec3 pin_impulse{};
  Vec3 solid_impulse{};
  Vec3 air_impulse{};
  std::size_t solid_contacts = 0;  // nodes that touched a solid in the last substep
  std::size_t self_contacts = 0;   // pairs that touched in the last substep
  std::size_t swept_hits = 0;      // crossings that the swept test found and prevented
  std::size_t rigid_zones = 0;     // rounds in which nodes had to move as one to prevent a crossing
  std::size_t unresolved_crossings = 0;  // pairs that pins of different motion forced through each other
  Real kinetic_energy = 0;      // J at the end of the step
  Real elastic_energy = 0;
  Real potential_energy = 0;    // J against gravity, zero at the origin
};

// Caches and work space of one sheet; holds no state: a new one gives the same bits.
class ClothScratch {
 public:
  ClothScratch();
  ~ClothScratch();
  ClothScratch(ClothScratch&&) noexcept;
  ClothScratch& operator=(ClothScratch&&) noexcept;

  std::vector<Vec3> pin_impulse;    // N s on the sheet during the last step, one per pin
  std::vector<Vec3> solid_impulse;  // N s on the sheet during the last step, one per solid

  struct Work;
  Work& work() { return *work_; }

 private:
  std::unique_ptr<Work> work_;
};

// Advances the sheet by dt (s). A fixed sheet is left as it is, at no cost. Throws NumericalError when a node's position
// is no longer finite.
ClothStepReport step_cloth(Sheet& sheet, const ClothParams& params, const ClothLoads& loads, Real dt,
                           ClothScratch& scratch);

// Impulses (N s per node) of something that went along with the sheet during its last step of dt: they change velocity AND
// place, v += J/m, x += dt J/m. Layers that would cross on that way stop each other, by equal and opposite impulses: a sheet
// that starts without crossings has none after it. inverse_mass: 1/kg per node, 0 where a support holds it. threads, begun for the
// nodes with impulses: J/m is what they leave of it.
class ThreadAnswer;
struct PushReport {
  Vec3 pin_impulse{};           // N s on the sheet, by supports
  std::size_t swept_hits = 0;   // crossings prevented
  std::size_t unresolved_crossings = 0;
};
PushReport push_cloth(Sheet& sheet, const ClothParams& params, std::span<const Real> inverse_mass,
                      std::span<const Vec3> impulse, Real dt, ClothScratch& scratch, ThreadAnswer* threads = nullptr);

// Joules stored in the threads of the sheet as it is.
Real elastic_energy(const Sheet& sheet, const ClothParams& params, ClothScratch& scratch);

}  // namespace imbibe
