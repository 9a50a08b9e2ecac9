// A yarn network on a soft sheet: yarns, segments and pores ride on it by their material coordinates.
//
//   to_world(x, y, z) = sum_k w_k x_k + z n,    n = sum_k w_k n_k / |.|
//                       w weights of (x, y) in the triangle of the flat cloth that holds it, x_k its corners in space, n_k
//                       their normals (mean of the triangles around, by area)
//   to_sheet(p)       the inverse by the nearest point of the surface: its (x, y), z the distance on that side
//   gravity           potential g.x of every network node, and g.n across the sheet (wetting/wetting_step.h)
//
// So the network itself stays as it was woven, its contact hierarchy too: a particle is carried into the flat cloth and
// meets it there (docs/decisions/0008). Assumes bends gentler than the cloth is thick, and strains of some per cent, which
// change lengths and openings by as much. Only rectangular sheets.
// Tested in tests/coupling/embedding_test.cpp.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "imbibe/coupling/soft_sheet.h"
#include "imbibe/fabric/network.h"
#include "imbibe/wetting/wetting_step.h"

namespace imbibe {

// Where points of the flat cloth lie in the mesh of its sheet. Immutable; built once.
struct Embedding {
  Real width = 0, height = 0;       // m
  Index columns = 0, rows = 0;      // cells of the grid
  std::vector<std::array<Index, 2>> cell_triangles;
  std::vector<SurfacePoint> node;   // per node of the network
};

Embedding build_embedding(const Sheet& sheet, const YarnNetwork& network);
// (x, y) from the middle of the cloth; what lies beyond an edge belongs to the edge.
SurfacePoint point_at(const Embedding& embedding, const Sheet& sheet, Real x, Real y);

// What changes with the sheet, per step. Not state.
struct EmbeddingScratch {
  std::vector<Vec3> positions;        // of the nodes, for which the rest was made
  std::vector<Vec3> normal;           // unit, per node of the sheet
  std::vector<Real> potential, across;  // gravity per node of the network
  GravityField gravity() const { return {potential, across}; }
};
// Does nothing when the sheet lies as at the last call.
void update(EmbeddingScratch& scratch, const Embedding& embedding, const Sheet& sheet, const YarnNetwork& network,
            const Vec3& gravity);
// The normals alone.
void update_normals(EmbeddingScratch& scratch, const Sheet& sheet);

// The place of a cloth in the world at one instant: a flat one (of a fixed textile), or one bent with its sheet.
class ClothPlace {
 public:
  ClothPlace(const Placement& flat) : flat_(&flat) {}  // implicit: functions for bent cloth take flat ones alike
  // `surface`: where the sheet is at its end; null: only to_world and normal_at may be asked. `reach` m: what is farther
  // from the surface is nowhere near (to_sheet gives z = infinity). All must outlive it.
  ClothPlace(const Embedding& embedding, const Sheet& sheet, const EmbeddingScratch& scratch,
             const MovingMesh* surface = nullptr, Real reach = std::numeric_limits<Real>::infinity())
      : embedding_(&embedding), sheet_(&sheet), scratch_(&scratch), surface_(surface), reach_(reach) {}

  bool is_flat() const { return flat_ != nullptr; }
  Vec3 to_world(const Vec3& p) const { return flat_ ? flat_->to_world(p) : bent_to_world(p); }
  Vec3 to_sheet(const Vec3& w) const { return flat_ ? flat_->to_sheet(w) : bent_to_sheet(w); }
  // Unit normal of the face at (x, y), in the world.
  Vec3 normal_at(const Vec3& p) const { return flat_ ? flat_->n : bent_normal(p); }
  // m/s, of the cloth there; 0 for a flat one.
  Vec3 velocity_at(const Vec3& p) const;
  // Where p lies on the sheet (only of a bent one).
  SurfacePoint surface_point(const Vec3& p) const { return point_at(*embedding_, *sheet_, p.x, p.y); }
  // A small way from `w`, relative to the cloth, in sheet coordinates; and a direction back into the world.
  struct Frame {
    Vec3 at{};           // sheet coordinates of w; z infinite: not near
    Vec3 u{}, v{}, n{};  // unit and square, in the world
    Vec3 velocity{};     // m/s, of the cloth
    Vec3 into_sheet(const Vec3& d) const { return {dot(d, u), dot(d, v), dot(d, n)}; }
    Vec3 into_world(const Vec3& d) const { return d.x * u + d.y * v + d.z * n; }
  };
  Frame frame_near(const Vec3& w) const;
  // The lowest point of a bent cloth, the middle of a flat one: heads of liquid count from it.
  Vec3 foot(const Vec3& gravity) const;

 private:
  Vec3 bent_to_world(const Vec3& p) const;
  Vec3 bent_to_sheet(const Vec3& w) const;
  Vec3 bent_normal(const Vec3& p) const;
  NearestOnSheet nearest(const Vec3& w) const;  // no_index: not near, or beside the outline
  Vec3 material(const NearestOnSheet& near) const;

  const Placement* flat_ = nullptr;
  const Embedding* embedding_ = nullptr;
  const Sheet* sheet_ = nullptr;
  const EmbeddingScratch* scratch_ = nullptr;
  const MovingMesh* surface_ = nullptr;
  Real reach_ = 0;
};

// --- what the cloth carries -------------------------------------------------------------------------------------------

// kg per node of the network -> per node of the sheet, added up.
void add_to_sheet(const Embedding& embedding, const Sheet& sheet, std::span<const Real> network_kg,
                  std::vector<Real>& sheet_kg);

// A particle's mass that joins the cloth there for good: its nodes take it, and its momentum.
void join_sheet(SoftSheet& soft, std::span<const std::uint8_t> held, const SurfacePoint& at, Real kg, const Vec3& velocity);

// Mass that has left since the added mass was last set, and the momentum it took at the cloth's own velocity.
struct MassLeft {
  Real kg = 0;
  Vec3 momentum{};
};
// A particle is born from what the cloth carries, with `velocity`: the cloth gets the recoil.
void leave_sheet(SoftSheet& soft, std::span<const std::uint8_t> held, const SurfacePoint& at, Real kg, const Vec3& velocity,
                 MassLeft& left);

// Sets the sheet's added mass to `wanted` (kg per node): what changes node takes its momentum along. The difference of
// the sums beyond `left` came or went with the cloth's mean velocity (vapour, reservoirs). That the sum of momentum is kept
// is seen to by one small shift of all free nodes' velocity: water moves in cloth by mm/s.
void set_added_mass(SoftSheet& soft, std::span<const std::uint8_t> held, std::span<const Real> wanted,
                    const MassLeft& left = {});

}  // namespace imbibe
