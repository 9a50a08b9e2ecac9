// Drops that come to rest on a plane, another solid or a sheet: what the cases about them share.
#pragma once

#include "imbibe/verify/case.h"

namespace imbibe::verify {

constexpr Real water_density = 998.2;

Real volume_of(Real radius);

// A particle mass that puts `across` particles on the radius of a ball of this volume, of a liquid as dense as water.
std::string resolution(Real volume, Real across);

// sqrt(rho R^3/gamma).
Real capillary_time(const World& w, Real radius);

struct Moments {
  Vec3 centre{}, momentum{};
  Real xx = 0, yy = 0, zz = 0, speed = 0;
};
Moments moments(const Liquid& liquid);

// Capillary times at the end of a run over which a resting drop is averaged: about one oscillation, the slowest being that
// of the tallest drop.
constexpr Real averaged = 4;

// Means of drop_measure.h's figures over the last oscillation of the run. The drop of the scene is born upright on its only
// solid, or on its textile, whose face is a plane to it.
struct Resting {
  Real fit = 0, slope = 0, base_slope = 0;  // degrees
  Real base = 0, height = 0, volume = 0, force = 0, speed = 0;
};
Resting settle(CaseRunner& runner, const std::string& scene, std::vector<std::string> overrides, Real units, World* kept = nullptr);

// Base radius, height, volume and net force of a drop at rest in that world against those wanted [m].
void add_shape_checks(CaseResult& r, const std::string& name, const Resting& d, const World& w, Real base_radius, Real height);

}  // namespace imbibe::verify
