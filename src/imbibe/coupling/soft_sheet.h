// A soft sheet as the liquid meets it: the cloth's state, the surface over the last step, and the books of its supports.
//
//   impulse at a point of a triangle  v_k += w_k J/m_k        w weights of the corners; a held node's part goes to its support
//   inverse mass felt there           1/m_s = sum_k w_k^2/m_k over the nodes that are free
//   impact  v' = v_s + e |v - v_s| d,  J = m_eff (v' - v rel.),  1/m_eff = 1/m_p + 1/m_s
//           d: R = V - 2 (V.N) N turned by a random angle up to `scatter`, away from the sheet    (seed B 5.6, e = 1)
//   absorbed particle  v_k' = (m_k v_k + m_p v_p)/(m_k + m_p)
// The relative speed never grows, so neither does the energy: dE = m_eff/2 (e^2 - 1) |V|^2.
// Momentum: what a particle loses, as stored, is what the sheet and its supports get, to rounding of doubles.
// Tested in tests/coupling/soft_sheet_test.cpp.
#pragma once

#include <span>
#include <vector>

#include "imbibe/cloth/cloth_step.h"
#include "imbibe/cloth/thread_answer.h"
#include "imbibe/core/random.h"
#include "imbibe/coupling/cell_flow.h"
#include "imbibe/geometry/moving_mesh.h"
#include "imbibe/liquid/occupancy.h"
#include "imbibe/liquid/particles.h"
#include "imbibe/liquid/sheet_wall.h"
#include "imbibe/liquid/wall.h"

namespace imbibe {

// What acts on a sheet as a whole: N and N m about the origin (or their integrals over time).
struct SheetLoad {
  Vec3 force{}, moment{};
};

// A sheet that has kept its shape for half a second rests: it is held where it is, as by supports, until its mass or the mean
// load of the liquid is another than when it came to rest. Books: momentum of the sheet = support_impulse + liquid_impulse
// + what liquid taken in brought + weight of the moving sheet and air; the weight of a resting or fixed one its supports take.
struct SoftSheet {
  Sheet sheet;
  ClothParams cloth;
  Real contact_angle = pi / 2;    // rad, of the liquid on the sheet's faces
  Vec3 support_impulse{};         // N s, given to the sheet by pins, solids and rest since the start (state)
  Vec3 liquid_impulse{};          // N s, given to the sheet by free liquid since the start (state)
  SheetLoad given{};              // N s and N m s, by free liquid in this step (state)
  SheetLoad load{};               // by free liquid, running mean (state)
  Real calm_s = 0;                // s for which it has hardly moved (state)
  std::vector<Vec3> calm_place;   // m per node, where it was when that began (state)
  Real mass_at_rest = 0;          // kg, when it came to rest (state)
  SheetLoad load_at_rest{};       // then (state)
  bool at_rest = false;           // it is not stepped until something changes (state)
  bool moves() const { return !sheet.fixed && !at_rest; }
};

struct SheetHit {
  Index particle = no_index;
  MovingCrossing crossing;
};

// The threads of a soft sheet as the liquid's solver meets them.
class ThreadResistance : public SheetResistance {
 public:
  void set(const SoftSheet& soft, std::span<const Real> inverse_mass, ClothScratch& scratch);
  void begin(std::span<const Index> pushed, Real dt) override;
  std::span<const Index> nodes() const override { return threads.nodes(); }
  void resist(std::span<Vec3> velocity) override { threads.resist(velocity); }
  ThreadAnswer threads;

 private:
  const SoftSheet* soft_ = nullptr;
  std::span<const Real> inverse_mass_;
  ClothScratch* scratch_ = nullptr;
};

// Whether a push of the liquid is resisted by more than the masses of nodes.
bool threads_resist(const SoftSheet& soft);

// Work space and caches of one sheet; not state.
struct SoftSheetScratch {
  ClothScratch cloth;
  MovingMesh surface;             // over the last step
  std::vector<Vec3> before;       // positions before it
  std::vector<Vec3> wall_velocity;  // m/s per node, mean over the cloth's step: what the liquid meets
  std::vector<std::uint8_t> held;  // per node: a support holds it, or rest does
  std::vector<Real> inverse_mass;  // 1/kg per node, 0: held
  ThreadResistance resistance;
  SheetWall wall;                  // what the liquid's solver sees of it
  std::vector<SheetHit> hits;      // of the liquid's particles in this step
  std::vector<std::vector<SheetHit>> hit_tiles;
  std::vector<Vec3> footprint;     // where a particle that is taken in goes, m in the sheet
  Occupancy occupancy;             // where leaks may be born
  CellFlowScratch cells;           // of a cloth of cells
};

// Which nodes are held at the sheet's time: by pins, or all of them because it is fixed or at rest.
void find_held(const SoftSheet& soft, std::vector<std::uint8_t>& held);

Vec3 velocity_at(const Sheet& sheet, const SurfacePoint& at);
Real inverse_mass_at(const Sheet& sheet, std::span<const std::uint8_t> held, const SurfacePoint& at);
// A particle on a sheet that does not move, or held at all corners, meets an infinite mass (0).

// J in N s, by liquid, on a node or at a point of the sheet. What held nodes get goes to their supports at once:
// support_impulse -= their part.
void give_impulse(SoftSheet& soft, std::span<const std::uint8_t> held, Index node, const Vec3& impulse);
void give_impulse(SoftSheet& soft, std::span<const std::uint8_t> held, const SurfacePoint& at, const Vec3& impulse);

// Mass m with velocity v joins node k for good: momentum kept. The caller sets added_mass to include it afterwards.
void merge_into_node(SoftSheet& soft, std::span<const std::uint8_t> held, Index node, Real kg, const Vec3& velocity);

struct ImpactParams {
  Real restitution = 0.3;  // e, of the speed
  Real scatter = 0.35;     // rad
  Real friction = 0.3;     // Coulomb, of a particle that stays
  Real rest_speed = 0.02;  // m/s: slower approaches do not bounce but stay on the face
};

// Velocity of a particle after it met a surface that moves with v_surface; n unit, towards the particle.
Vec3 velocity_after_impact(const Vec3& velocity, const Vec3& v_surface, const Vec3& n, Real particle_mass,
                           Real surface_inverse_mass, const ImpactParams& params, const RandomCounter& random);

// Particles whose way from `before` to `now` crosses the sheet in its last step, by rising particle.
void find_sheet_hits(const MovingMesh& surface, std::span<const Float4> before, std::span<const Float4> now,
                     std::vector<SheetHit>& hits, std::vector<std::vector<SheetHit>>& tiles);

// Puts a particle that crossed back: onto the material point it met, `gap` over the face it came from, so that no other
// layer lies between. Returns its place.
Vec3 place_over(const MovingMesh& surface, const MovingCrossing& crossing, Real gap);

// Throws all particles back that crossed the sheet in its last step, onto the side they came from, `gap` m over it; the
// sheet gets their impulse. Returns how many.
std::size_t throw_back(SoftSheet& soft, SoftSheetScratch& scratch, Liquid& liquid, std::span<const Float4> before,
                       Real gap, const ImpactParams& impact, std::uint64_t seed, std::uint64_t step);

// A step of sheet and liquid:
//   advance_sheet      the cloth's own step, under all forces but the liquid's
//   sheet_as_wall      where it was at the start, with its mean velocity over the step, for the liquid's step of the same dt
//   take_wall_impulse  what the liquid gave it changes velocity AND place: v += J/m, x += dt J/m, as far as its own layers let
//                      it (push_cloth). The liquid moved with the sheet so pushed; a push in velocity alone would let a taut
//                      sheet drift into what lies on it, by T dt/m (0.3 m/s for 4 kg/m2 on a shirt at 1 ms), step after
//                      step. A resting sheet wakes here when the mean load is no longer the one it rests under.
//   finish_sheet       sets scratch.surface over the whole step, for the swept contact
// Of a sheet at rest or fixed nothing is computed but whether it is to wake.
ClothStepReport advance_sheet(SoftSheet& soft, SoftSheetScratch& scratch, const Vec3& gravity,
                              std::span<const ClothSolid> solids, Real dt);
Wall sheet_as_wall(const SoftSheet& soft, SoftSheetScratch& scratch);
void take_wall_impulse(SoftSheet& soft, SoftSheetScratch& scratch, const Vec3& gravity, Real dt);
void finish_sheet(SoftSheet& soft, SoftSheetScratch& scratch, Real dt);

// Wakes a resting sheet whose mass has changed by more than `share`.
void wake_if_heavier(SoftSheet& soft, Real share = 0.002);

}  // namespace imbibe
