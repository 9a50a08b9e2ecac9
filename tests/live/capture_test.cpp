#include "imbibe/live/capture.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "imbibe/live/protocol.h"
#include "imbibe/scene/builder.h"

namespace imbibe::live {
namespace {

const Library& library() {
  static const Library read = read_library({IMBIBE_SOURCE_DIR});
  return read;
}

Vec3 place(const QuantisedPoints& q, std::size_t i) {
  return {Real(q.origin.x) + Real(q.step.x) * q.xyz[3 * i], Real(q.origin.y) + Real(q.step.y) * q.xyz[3 * i + 1],
          Real(q.origin.z) + Real(q.step.z) * q.xyz[3 * i + 2]};
}

TEST(Capture, AFrameOfManyParticlesShowsSomeAlwaysTheSameAndStaysSmall) {
  World world;
  world.liquid.particle_mass = 1e-9;
  Particles& p = world.liquid.particles;
  for (std::uint64_t i = 0; i < 70000; ++i) {
    p.position.push_back({1e-3f * static_cast<float>(i), 0, 0, 0});
    p.id.push_back(static_cast<decltype(p.id)::value_type>(i));
  }
  const Snapshot snapshot = take_snapshot(world, {}, nullptr);
  EXPECT_EQ(snapshot.particles->every, 5);
  EXPECT_EQ(snapshot.particles->size(), 14000u);
  EXPECT_EQ(snapshot.particle_count, 70000u);
  EXPECT_LT(FrameEncoder(0).encode(snapshot).size(), 200000u);
  std::reverse(p.position.begin(), p.position.end());  // as a sort of the next step may leave them
  std::reverse(p.id.begin(), p.id.end());
  std::vector<Vec3> before, after;
  const Snapshot next = take_snapshot(world, {}, nullptr);
  for (std::size_t i = 0; i < 14000; ++i) before.push_back(place(*snapshot.particles, i)), after.push_back(place(*next.particles, 13999 - i));
  for (std::size_t i = 0; i < 14000; ++i) EXPECT_EQ(before[i].x, after[i].x);
}

// What the page makes of the sheet's nodes and the carried points is where the yarns are.
TEST(Capture, PointsOfYarnsAreFoundFromTheSheetThatTheyRideOn) {
  const Scene scene = read_scene(std::filesystem::path(IMBIBE_SOURCE_DIR) / "scenes/cloth/network_on_hammock.yaml");
  World world = build_world(scene, library());
  Sheet& sheet = world.textiles[0].cloth->soft.sheet;
  for (Vec3& x : sheet.position) x.z += 0.2 * x.x + 5 * x.x * x.y;  // a saddle on a slope
  const Geometry geometry = take_geometry(1, scene, world, library(), {});
  const Snapshot snapshot = take_snapshot(world, {{}}, nullptr);
  ASSERT_TRUE(snapshot.sheets[0]);
  EXPECT_FALSE(snapshot.yarns[0]);
  std::vector<Vec3> nodes, normals(sheet.size());
  for (std::size_t i = 0; i < sheet.size(); ++i) nodes.push_back(place(*snapshot.sheets[0], i));
  const auto& triangles = geometry.sheet_triangles[0];
  for (std::size_t t = 0; t + 2 < triangles.size(); t += 3) {
    const Vec3 n = cross(nodes[triangles[t + 1]] - nodes[triangles[t]], nodes[triangles[t + 2]] - nodes[triangles[t]]);
    for (std::size_t k = 0; k < 3; ++k) normals[triangles[t + k]] += n;
  }
  for (Vec3& n : normals) n = normalized(n);
  const QuantisedPoints& yarns = geometry.yarns[0];
  ASSERT_EQ(geometry.carried[0].size(), yarns.size());
  Real worst = 0;
  for (std::size_t i = 0; i < yarns.size(); ++i) {
    const CarriedPoint& c = geometry.carried[0][i];
    const Real weight[3] = {1 - (c.second + c.third) / 65535.0, c.second / 65535.0, c.third / 65535.0};
    Vec3 at{}, normal{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t node = triangles[3 * c.triangle + k];
      at += weight[k] * nodes[node], normal += weight[k] * normals[node];
    }
    worst = std::max(worst, norm(at + c.height * normalized(normal) - place(yarns, i)));
  }
  EXPECT_LT(worst, 10e-6);  // m: 16 bits of 60 mm along three axes, twice, and in the normals of a yarn's height
}

}  // namespace
}  // namespace imbibe::live
