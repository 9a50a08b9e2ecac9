// A soft, moving sheet as a wall of the liquid, two-sided, and what the liquid's pressure and it do to each other.
//
//   D(u)_i = sum_j V (u_i - u_j).grad W_ij + 2 (u_i - w_i).P_i,   w_i = sum_n b_in w_n         (pressure.h has w = 0)
//   dw_n   = dt/m_n sum_i m 2 k_i b_in P_i                        what the pressure gives a node
// b weights of the corners of the sheet's triangle nearest to particle i, w_n, m_n velocity and mass of node n (held: no
// answer), P_i the sheet's part of the wall gradient at i (boundary.h), m particle mass, k pressure over density.
// On a sheet whose threads resist (SheetResistance) dw is what they leave of it, w = S J with S symmetric.
// The nodes' answer stands inside the operator of the solve, A_i += 2 P_i.sum_n b_in dw_n/dt, which stays symmetric and
// positive: a light cloth under a heavy liquid (0.1 kg/m2 under 5 kg/m2) makes an explicit exchange unstable at any step
// (added mass). The cloth's own forces follow in its step; over a step the pair meets as an inelastic impact.
// What the liquid gets from a foot, the foot's nodes get back: impulse, N s.
// Tested in tests/liquid/sheet_wall_test.cpp.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "imbibe/core/types.h"
#include "imbibe/geometry/moving_mesh.h"
#include "imbibe/liquid/particles.h"

namespace imbibe {

// What in a sheet resists a push besides the masses of its nodes. Linear and symmetric.
class SheetResistance {
 public:
  virtual ~SheetResistance() = default;
  virtual void begin(std::span<const Index> pushed, Real dt) = 0;
  virtual std::span<const Index> nodes() const = 0;       // whose velocities change: pushed ones and those tied to them
  virtual void resist(std::span<Vec3> velocity) = 0;      // m/s: in J/m, 0 where not pushed; out S J
};

// One sheet for the duration of a step.
struct SheetWall {
  const MovingMesh* surface = nullptr;      // where it is now: its end
  std::span<const Vec3> velocity{};         // m/s per node
  std::span<const Real> inverse_mass{};     // 1/kg per node; 0: held
  Real half_thickness = 0;                  // m
  SheetResistance* resistance = nullptr;    // none: nodes answer by their masses alone
  std::vector<Vec3> impulse{};              // N s per node, given by the liquid in this step; added to
  std::vector<float> dragging{};            // kg per node, of liquid that sticks to it (viscosity.cpp)
  Real pressing = 0;                        // N s, by the pressure alone, along the normals into the sheet; added to
};

// Where a particle near a sheet stands on it.
struct SheetFoot {
  Index wall = 0, particle = 0;
  std::array<Index, 3> node{};
  std::array<float, 3> weight{};
  Vec3f velocity{};  // m/s, of the sheet there at the start of the step
  Vec3f push{};      // P of this foot, weighted as boundary.push, 1/m
  Vec3 impulse{};    // N s given to the sheet here
};

// The feet of one solve, with the nodes that answer.
class SheetContacts {
 public:
  // feet: of all particles, by rising particle. Returns nothing to do when there are none.
  void begin(std::span<SheetFoot* const> feet, std::span<SheetWall* const> walls, Real particle_mass, Real dt);
  bool empty() const { return feet_.empty(); }

  // 2 w_i.P_i of each foot added to rate[particle] (scaled by `scale`), with the nodes' present velocities.
  void add_rate(std::vector<float>& rate, float scale) const;
  // Node accelerations per k (k in position.w): kept as the answer of the direction.
  void answer(std::span<const Float4> k);
  // 2 P_i.(answer at i), added to applied[particle].
  void add_answer(std::vector<float>& applied) const;
  // w += scale * answer.
  void advance(Real scale);
  // The diagonal's part at each foot: 4 m |P|^2 sum b^2/m_n.
  void add_diagonal(std::vector<float>& factor) const;
  // Books m dt 2 k P of the final pressure as impulse of the nodes.
  void book(std::span<const float> k, Real dt);

 private:
  Vec3 at(const SheetFoot& foot, const std::vector<Vec3>& nodal) const;
  Real inverse_mass(const SheetFoot& foot, std::size_t corner) const;

  std::vector<SheetFoot*> feet_;
  std::vector<SheetWall*> walls_;
  std::vector<std::size_t> first_node_;   // of each wall in the arrays below
  std::vector<Vec3> velocity_, answer_;
  std::vector<std::size_t> touched_;      // nodes under a foot and what is tied to them, each once: only they answer
  std::vector<Index> pushed_;
  Real particle_mass_ = 0;
};

}  // namespace imbibe
