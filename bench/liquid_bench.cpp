// Whole steps of the liquid, with a row for each stage.
//   dam_break   the peers' scene: a cube of particles, spacing 5 cm, 5 cm over the floor of a tank; no surface tension;
//               density error 0.05 %, support 2 dx (32 neighbours). The peers' divergence error is 0.1 %; ours 0.03 %, since with
//               0.1 % the density would not hold (pressure.h). The tank is a closed mesh solid (open at the top).
//   dam_fall    its first steps, before the block meets the floor: what the peer's figure for 10^6 was taken from
//   impact      1.64 mL of water, just above a plate at 0.3 m/s, with surface tension and contact angle (fig. 7)
//   impact_without_tension   the same liquid, from the same state, with both turned off: what they add
#include <cmath>

#include "bench.h"
#include "imbibe/geometry/mesh_distance.h"
#include "imbibe/liquid/liquid_step.h"
#include "imbibe/liquid/source.h"

namespace imbibe::bench {
namespace {

// A tank of inner size `inner` standing on z = 0 with its inner corner at the origin, walls of `wall` thickness.
TriangleMesh tank_mesh(const Vec3& inner, Real wall) {
  TriangleMesh mesh;
  const auto box = [&](const Vec3& low, const Vec3& high) {
    for (int k = 0; k < 8; ++k) {
      mesh.vertices.push_back({k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z});
    }
  };
  box({-wall, -wall, -wall}, inner + Vec3{wall, wall, 0});  // 0-7 outside
  box({0, 0, 0}, inner);                                    // 8-15 inside
  const auto quad = [&](Index a, Index b, Index c, Index d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  quad(0, 2, 3, 1), quad(0, 1, 5, 4), quad(1, 3, 7, 5), quad(3, 2, 6, 7), quad(2, 0, 4, 6);             // outside
  quad(8, 9, 11, 10), quad(8, 12, 13, 9), quad(9, 13, 15, 11), quad(11, 15, 14, 10), quad(10, 14, 12, 8);  // inside
  quad(4, 5, 13, 12), quad(5, 7, 15, 13), quad(7, 6, 14, 15), quad(6, 4, 12, 14);                       // rim
  return mesh;
}

struct LiquidScene {
  Liquid liquid;
  LiquidParams params;
  std::vector<Shape> shapes;
  std::vector<Wall> walls;
  bool sheet = false;
  LiquidScratch scratch;
  double held = 0;

  LiquidStepReport step(Liquid& state) {
    walls.clear();
    for (const Shape& shape : shapes) walls.push_back({&shape, {.contact_angle = radians(70)}, {}, sheet});
    return step_liquid(state, params, walls, {0, 0, -9.81}, 1, scratch);
  }
};

LiquidScene dam_break(std::int64_t size, int steps) {
  LiquidScene scene;
  const double before = allocated_bytes();
  const auto side = static_cast<int>(std::lround(std::cbrt(static_cast<double>(size))));
  const Real dx = 0.05, edge = side * dx;
  scene.liquid.particle_mass = scene.liquid.kind.density * dx * dx * dx;
  scene.params.surface_tension = false;
  scene.params.support = 2;
  scene.params.max_density_error = 5e-4;
  scene.params.pressure.tolerance = 3e-4;
  Source source{.form = SourceForm::box, .centre = {edge / 2, edge / 2, edge / 2 + dx}, .size = {edge, edge, edge}};
  emit(source, scene.liquid, 0, 1);
  scene.shapes.emplace_back(std::make_shared<const MeshDistance>(tank_mesh({3 * edge, edge, 2 * edge}, 4 * dx)));
  for (int k = 0; k < steps; ++k) scene.step(scene.liquid);
  scene.held = (allocated_bytes() - before) / static_cast<double>(size);
  return scene;
}

LiquidScene impact(std::int64_t size) {
  LiquidScene scene;
  const double before = allocated_bytes();
  const Real volume = 1.64e-6, radius = std::cbrt(3 * volume / (4 * pi));
  scene.liquid.particle_mass = scene.liquid.kind.density * volume / static_cast<Real>(size);
  Source source;
  source.centre = {0, 0, radius + scene.liquid.spacing()};
  source.volume = volume;
  source.velocity = {0, 0, -0.3};
  emit(source, scene.liquid, 0, 1);
  scene.shapes.emplace_back(Box{{0, 0, -0.5e-3}, {60e-3, 60e-3, 1e-3}});
  const int steps = size > 500'000 ? 10 : 25;
  for (int k = 0; k < steps; ++k) scene.step(scene.liquid);
  scene.held = (allocated_bytes() - before) / static_cast<double>(size);
  return scene;
}

// The block has met the floor: at its first touch the pressure comes from nothing and takes up to 60 iterations, for 97,336
// particles in step 20, for 10^6 in step 40.
constexpr int after_first_touch = 60;

struct DamBreak : LiquidScene {};
struct DamFall : LiquidScene {};
struct Impact : LiquidScene {};

void run_steps(benchmark::State& state, LiquidScene& scene, std::int64_t size) {
  Liquid liquid = scene.liquid;
  LiquidStepReport::Times sum;
  double pressure = 0, correction = 0, steps = 0, error = 0, compression = 0, found = 0;
  for (auto _ : state) {
    const LiquidStepReport r = scene.step(liquid);
    sum.sort += r.times.sort, sum.walls += r.times.walls, sum.lists += r.times.lists, sum.density += r.times.density;
    sum.viscosity += r.times.viscosity, sum.surface += r.times.surface, sum.pressure += r.times.pressure;
    sum.move += r.times.move;
    pressure += r.pressure_iterations, correction += r.divergence_iterations, ++steps;
    error += r.remaining_density_error, compression += r.divergence_error, found += r.density_error;
  }
  report(state, {.items = static_cast<double>(size), .held_bytes_per_item = scene.held});
  const auto stage = [&](const char* name, double seconds) { report_stage(state, name, seconds / steps); };
  stage("sort", sum.sort), stage("walls", sum.walls), stage("lists", sum.lists), stage("density", sum.density);
  stage("viscosity", sum.viscosity), stage("surface", sum.surface), stage("pressure", sum.pressure);
  stage("move", sum.move);
  report_extra(state, "pressure_iterations", pressure / steps);
  report_extra(state, "density_iterations", correction / steps);
  report_extra(state, "density_error_percent", 100 * error / steps);
  report_extra(state, "density_error_found_percent", 100 * found / steps);
  report_extra(state, "divergence_error_percent", 100 * compression / steps);
}

std::int64_t passes(std::int64_t size) { return size <= 10'000 ? 40 : size <= 200'000 ? 10 : 3; }

}  // namespace

void add_liquid_benchmarks(const BenchOptions& options) {
  add_family(options, "liquid/dam_break", {8000, 97'336, 1'000'000}, passes,
             [](benchmark::State& state, std::int64_t size) {
               run_steps(state, shared_fixture<DamBreak>(size, [&] { return DamBreak{dam_break(size, after_first_touch)}; }), size);
             });
  add_family(options, "liquid/dam_fall", {1'000'000}, passes,
             [](benchmark::State& state, std::int64_t size) {
               run_steps(state, shared_fixture<DamFall>(size, [&] { return DamFall{dam_break(size, 5)}; }), size);
             });
  add_family(options, "liquid/impact", {8000, 80'000, 1'000'000}, passes,
             [](benchmark::State& state, std::int64_t size) {
               run_steps(state, shared_fixture<Impact>(size, [&] { return Impact{impact(size)}; }), size);
             });
  add_family(options, "liquid/impact_without_tension", {8000, 80'000}, passes,
             [](benchmark::State& state, std::int64_t size) {
               LiquidScene& scene = shared_fixture<Impact>(size, [&] { return Impact{impact(size)}; });
               scene.params.surface_tension = false;
               run_steps(state, scene, size);
             });
}

}  // namespace imbibe::bench
