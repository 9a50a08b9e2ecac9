// Shear of four cells at once.
#include "imbibe/cloth/shear.h"

#include <gtest/gtest.h>

#include "imbibe/cloth/elastic.h"
#include "imbibe/core/random.h"

namespace imbibe {
namespace {

struct Cells {
  std::vector<ShearPiece<4>> pieces;
  std::vector<Vec3> position, velocity, held;
  std::vector<Real> inverse_mass, given;
  std::vector<PieceMaterial> materials;

  explicit Cells(std::size_t count) : held(4 * count), given(count), materials(count, {0.3, 2e-3}) {
    for (std::size_t c = 0; c < count; ++c) {
      const auto n = static_cast<Index>(4 * c);
      pieces.push_back({{n, n + 1, n + 2, n + 3}, {-100, 100, -100, 100}, {-100, -100, 100, 100}, 2.5e-5});
      for (std::uint64_t k = 0; k < 4; ++k) {
        const RandomCounter id{3, 4 * c + k, 0};
        const auto any = [&](int part) { return uniform(id, part) - 0.5; };
        position.push_back({5e-3 * (k % 2 + 0.3 * any(0)), 5e-3 * (k / 2 + 0.3 * any(1)), 2e-3 * any(2)});
        velocity.push_back({any(3), any(4), any(5)});
        inverse_mass.push_back(c == 1 && k == 2 ? 0 : 3e5);  // one node is pinned
      }
    }
  }
  NodeMotion nodes() { return {position.data(), velocity.data(), inverse_mass.data(), held.data()}; }
};

TEST(Shear, FourCellsAtOnceHaveTheBitsOfCellsAlone) {
  for (const std::size_t count : {1u, 2u, 3u, 4u}) {
    Cells together(count), alone(count);
    Reals changed, one;
    solve_shear(together.pieces.data(), count, together.nodes(), together.materials.data(), 5e-4, together.given.data(), changed);
    for (std::size_t c = 0; c < count; ++c) {
      solve_shear(&alone.pieces[c], 1, alone.nodes(), &alone.materials[c], 5e-4, &alone.given[c], one);
      EXPECT_EQ(one[0], changed[c]);
    }
    EXPECT_EQ(together.velocity, alone.velocity);
    EXPECT_EQ(together.held, alone.held);
    EXPECT_EQ(together.given, alone.given);
  }
}

TEST(Shear, ItsImpulseIsTheForceOfTheCosinesEnergyInAShortStep) {
  // J grad C -> -dt k C grad C = -dt dE/dx, E = k C^2/2, by differences; the angle moves by dt k/m over edges 2e-4 times itself.
  Cells cell(1);
  cell.materials[0].damping = 0;
  for (Vec3& v : cell.velocity) v = {};
  const Real dt = 1e-7, step = 1e-8;
  const auto energy = [&] {
    const auto& p = cell.pieces[0];
    const Real cosine = dot(normalized(linear_form(cell.position.data(), p.node, p.weft)),
                            normalized(linear_form(cell.position.data(), p.node, p.warp)));
    return 0.5 * 0.3 * cosine * cosine;
  };
  std::vector<Vec3> force(4);
  Real greatest = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    for (Real Vec3::*part : {&Vec3::x, &Vec3::y, &Vec3::z}) {
      const Real place = cell.position[k].*part;
      cell.position[k].*part = place + step;
      const Real above = energy();
      cell.position[k].*part = place - step;
      force[k].*part = (energy() - above) / (2 * step);
      cell.position[k].*part = place;
    }
    greatest = std::max(greatest, norm(force[k]));
  }
  Reals changed;
  solve_shear(cell.pieces.data(), 1, cell.nodes(), cell.materials.data(), dt, cell.given.data(), changed);
  for (std::size_t k = 0; k < 4; ++k)
    EXPECT_LT(norm(cell.velocity[k] / (dt * cell.inverse_mass[k]) - force[k]), 1e-3 * greatest);
}

TEST(Shear, ACellThatIsFoldedToALineGetsNothing) {
  Cells cells(2);
  for (std::size_t k = 0; k < 4; ++k) cells.position[k] = {}, cells.velocity[k] = {};
  Reals changed;
  solve_shear(cells.pieces.data(), 2, cells.nodes(), cells.materials.data(), 5e-4, cells.given.data(), changed);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(cells.velocity[k], Vec3{});
  EXPECT_EQ(changed[0], 0);
  EXPECT_GT(changed[1], 0);
  for (const Vec3& v : cells.velocity) EXPECT_TRUE(is_finite(v));
}

}  // namespace
}  // namespace imbibe
