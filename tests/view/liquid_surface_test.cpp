#include "imbibe/view/liquid_surface.h"

#include <gtest/gtest.h>

#include <map>

#include "view/scenes.h"

namespace imbibe {
namespace {

constexpr Real spacing = 0.5e-3;
Real volume_of(std::size_t particles) { return static_cast<Real>(particles) * spacing * spacing * spacing; }

TEST(LiquidSurface, ABallEnclosesItsParticlesVolume) {
  // Measured when the parameters were chosen: 5 % below at 4 spacings, 2.4 % at 6, 0.5 % at 10; the error of a
  // surface placed within a twentieth of a spacing falls as 1 / radius.
  for (const auto& [radius, tolerance] : {std::pair{6.0, 0.04}, std::pair{10.0, 0.015}}) {
    const auto particles = test::ball_of_particles({0.01, -0.02, 0.03}, radius * spacing, spacing);
    const Real volume = enclosed_volume(liquid_surface(particles, spacing));
    EXPECT_NEAR(volume / volume_of(particles.size()), 1, tolerance) << radius << " spacings";
  }
}

TEST(LiquidSurface, ABallIsRoundNotABagOfBalls) {
  const Vec3 centre{0.003, 0.001, 0};
  const DrawnMesh mesh = liquid_surface(test::ball_of_particles(centre, 8 * spacing, spacing), spacing);
  Real sum = 0, squares = 0, worst_normal = 1;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vec3 out = Vec3(mesh.vertices[v]) - centre;
    const Real r = norm(out);
    sum += r, squares += r * r;
    worst_normal = std::min(worst_normal, dot(out / r, Vec3(mesh.normals[v])));
  }
  const Real n = static_cast<Real>(mesh.vertices.size()), mean = sum / n;
  // Particles themselves are rough by 0.3 spacings of shaking and half a spacing of lattice steps.
  EXPECT_LT(std::sqrt(squares / n - mean * mean), 0.2 * spacing);
  EXPECT_GT(worst_normal, std::cos(radians(25)));
}

TEST(LiquidSurface, IsClosedEveryEdgeOnceInEachDirection) {
  auto particles = test::ball_of_particles({0, 0, 0}, 4 * spacing, spacing);
  const auto other = test::ball_of_particles({7 * spacing, 0, 0}, 4 * spacing, spacing);  // overlaps: one body
  particles.insert(particles.end(), other.begin(), other.end());
  particles.push_back(Vec3f{0.02f, 0, 0});  // a lone one
  const DrawnMesh mesh = liquid_surface(particles, spacing);
  std::map<std::pair<Index, Index>, int> balance;
  for (const auto& t : mesh.triangles)
    for (std::size_t c = 0; c < 3; ++c) {
      const Index a = t[c], b = t[(c + 1) % 3];
      balance[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  ASSERT_FALSE(balance.empty());
  for (const auto& [edge, sum] : balance) ASSERT_EQ(sum, 0) << edge.first << "-" << edge.second;
}

TEST(LiquidSurface, ALoneParticleIsABallOfAboutItsOwnVolume) {
  // Half a dozen cells across: its volume depends on where it lies in the grid. Mean over places.
  Real sum = 0;
  for (int i = 0; i < 20; ++i) {
    const Real shift = 0.0137 * i * spacing;
    const Vec3f particle[] = {Vec3f(Vec3{shift, 2 * shift, 3 * shift})};
    sum += enclosed_volume(liquid_surface(particle, spacing)) / volume_of(1);
  }
  EXPECT_GT(sum / 20, 0.6);
  EXPECT_LT(sum / 20, 1.4);
}

TEST(LiquidSurface, FarApartDropsCostNoGridBetweenThem) {
  std::vector<Vec3f> particles{Vec3f{0, 0, 0}, Vec3f{10, 10, 10}};  // 20,000 spacings apart
  const DrawnMesh mesh = liquid_surface(particles, spacing);
  EXPECT_GT(mesh.triangles.size(), 20u);
  EXPECT_LT(mesh.triangles.size(), 2000u);
}

TEST(LiquidSurface, DoesNotDependOnTheOrderOfParticles) {
  auto particles = test::ball_of_particles({0, 0, 0}, 4 * spacing, spacing);
  const DrawnMesh a = liquid_surface(particles, spacing);
  std::reverse(particles.begin(), particles.end());
  const DrawnMesh b = liquid_surface(particles, spacing);
  ASSERT_EQ(a.vertices.size(), b.vertices.size());
  // Sums over neighbours run in another order: a few units of the last float digit, relative to the spacing.
  for (std::size_t v = 0; v < a.vertices.size(); ++v)
    EXPECT_LT(norm(Vec3(a.vertices[v]) - Vec3(b.vertices[v])), 1e-3 * spacing);
}

TEST(LiquidSurface, NoParticlesNoSurface) { EXPECT_TRUE(liquid_surface({}, spacing).triangles.empty()); }

}  // namespace
}  // namespace imbibe
