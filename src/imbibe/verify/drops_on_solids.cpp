// The contact angle on what is not a plane: a ball, the tip of a cone, a woven sheet. Drops at rest without gravity, so that
// every free surface is part of a sphere.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "imbibe/liquid/drop_shape.h"
#include "imbibe/verify/families.h"
#include "imbibe/verify/resting.h"

namespace imbibe::verify {
namespace {

// Where a spherical surface of radius R meets the solid: its slope to the level, the base's radius, the apex over the solid's
// top.
struct CapOnSolid {
  Real slope = 0;                 // rad
  Real base_radius = 0, height = 0;  // m
};

// On a ball of radius b: the circle of contact at the polar angle psi, where the ball's own slope is psi and the liquid's theta +
// psi:
//   a = b sin(psi) = R sin(theta + psi),  V = cap_volume(R, theta + psi) - cap_volume(b, psi)
// V grows with psi: bisection.
CapOnSolid cap_on_ball(Real volume, Real theta, Real b) {
  Real low = 0, high = pi - theta;
  for (int i = 0; i < 60; ++i) {
    const Real psi = 0.5 * (low + high), radius = b * std::sin(psi) / std::sin(theta + psi);
    (cap_volume(radius, std::cos(theta + psi)) - cap_volume(b, std::cos(psi)) < volume ? low : high) = psi;
  }
  const Real psi = 0.5 * (low + high), phi = theta + psi, radius = b * std::sin(psi) / std::sin(phi);
  return {phi, b * std::sin(psi), radius * (1 - std::cos(phi)) - b * (1 - std::cos(psi))};
}

// On the tip of a cone whose side falls by the angle alpha: the liquid's slope is phi = theta + alpha,
//   V = cap_volume(R, phi) - pi/3 a^3 tan(alpha),  a = R sin(phi):  V grows with R^3
CapOnSolid cap_on_cone(Real volume, Real theta, Real alpha) {
  const Real phi = theta + alpha, c = std::cos(phi), s = std::sin(phi), t = std::tan(alpha);
  const Real radius = std::cbrt(volume / (cap_volume(1, c) - pi / 3 * s * s * s * t));
  return {phi, radius * s, radius * (1 - c) - radius * s * t};
}

// Drops of 10 uL of these angles (set by the keys), born 30 degrees taller; theory(volume, angle) is the shape wanted.
template <class Theory>
CaseResult drops_at_rest(CaseRunner& runner, const std::string& scene, const std::vector<std::string>& angle_keys, const std::vector<Real>& angles,
                         Theory&& theory) {
  CaseResult r;
  const Real volume = 10e-9, units = 8, middle = angles[angles.size() / 2];
  std::vector<Real> shown;
  Real fastest = 0;
  for (const Real angle : angles) {
    std::vector<Convergence::Row> rows;
    for (const Real across : runner.quick() ? std::vector<Real>{8} : angle == middle ? std::vector<Real>{7, 10, 13} : std::vector<Real>{10}) {
      std::vector<std::string> o{set("liquid.drops[0].cap_angle", angle + 30, "deg"), resolution(volume, across)};
      for (const std::string& key : angle_keys) o.push_back(set(key, angle, "deg"));
      World w;
      const Resting d = settle(runner, scene, o, units, &w);
      const CapOnSolid wanted = theory(w, volume, radians(angle));
      rows.push_back({1 / across, d.fit - angle});
      if (across < 8) continue;  // for the convergence alone: coarser than the figures asked for
      const std::string name = fmt::format("{:g} deg, {:g} particles per radius: ", angle, across);
      r.checks.push_back(within(name + "angle, fitted profile", d.fit, angle, "deg", 5, "as on a plane"));
      add_shape_checks(r, name, d, w, wanted.base_radius, wanted.height);
      r.checks.push_back(at_most(name + "capillary number of the residual motion", w.liquid.kind.viscosity * d.speed / w.liquid.kind.surface_tension, 1e-3, "1", "as on a plane, where the liquid is water"));
      fastest = std::max(fastest, d.speed);
      r.checks.push_back(near(name + "liquid on the solid", 1e9 * w.liquid.mass() / w.liquid.kind.density, 1e9 * volume, "uL", 1e-3, "nothing is taken up; the drop's volume is a whole number of particles"));
      if (angle == angles.back()) runner.picture(r, w, runner.scene(scene, o), fmt::format("The drop of {:g} degrees", angle));
    }
    shown.push_back(angle + rows.back().error);
    if (rows.size() > 1) r.convergence.push_back(convergence_of(fmt::format("{:g} deg: angle [deg]", angle), "spacing over radius", rows));
  }
  r.charts.push_back(chart_of("Angle that the drop shows", "angle asked for", "deg", "angle", "deg", angles, {{"asked for", angles, ""}, {"shown", shown, ""}}));
  r.parameters = {{"drop", "10 uL of 50 mPa s, with water's surface tension, no gravity; born 30 degrees taller"}, {"time", fmt::format("{:g} capillary times, mean of the last {:g}", units, averaged)}};
  r.notes.push_back("The liquid has fifty times water's viscosity, so that its swing is over after some four capillary times; where it rests does not depend on it.");
  r.notes.push_back(fmt::format("Residual motion: at most {:.1f} mm/s (root mean square). It is what is left of the drop's swing and rocking, and sliding as a whole: "
                                "nothing drives a drop back to its place on a ball, and the tip of a cone and the crowns of a weave drive it off.", 1e3 * fastest));
  return r;
}

std::vector<Real> angles_on_solids(const CaseRunner& runner) { return runner.form(std::vector<Real>{90}, std::vector<Real>{60, 90, 120}); }

CaseResult on_ball(CaseRunner& runner) {
  CaseResult r = drops_at_rest(runner, "drop_on_ball", {"solids[0].contact_angle"}, angles_on_solids(runner), [](const World& w, Real volume, Real theta) {
    return cap_on_ball(volume, theta, std::get<Sphere>(w.solids[0].shape).radius);
  });
  r.parameters.push_back({"ball", "4 mm in radius, three times the radius of the drop's own ball"});
  return r;
}

CaseResult on_cone(CaseRunner& runner) {
  CaseResult r = drops_at_rest(runner, "drop_on_cone", {"solids[0].contact_angle"}, angles_on_solids(runner), [](const World& w, Real volume, Real theta) {
    const Cone& cone = std::get<Cone>(w.solids[0].shape);
    return cap_on_cone(volume, theta, std::atan2(cone.height, cone.radius));
  });
  r.parameters.push_back({"cone", "its side falls by 20 degrees: the surface meets the level under 20 degrees more than the angle"});
  return r;
}

CaseResult on_weave(CaseRunner& runner) {
  const std::vector<Real> angles = runner.form(std::vector<Real>{100}, std::vector<Real>{90, 100, 120});
  CaseResult r = drops_at_rest(runner, "drop_on_weave", {"textiles[0].contact_angle", "textiles[0].receding_angle"}, angles, [](const World&, Real volume, Real theta) {
    const SessileShape cap = sessile_shape(volume, theta, 0);
    return CapOnSolid{theta, cap.base_radius, cap.height};
  });
  r.parameters.push_back({"sheet", "polypropylene, 12 tex, 30 x 28 yarns per cm, 0.2 mm thick; the fibre's own angle is 100 degrees"});
  r.notes.push_back("Yarns are finer than particles: the liquid feels the dry face as a plane with the fibres' own angle (Cassie and Baxter's share of liquid in the face is that of its saturation, none here). "
                    "Below 90 degrees yarns drink, so 60 degrees has no drop at rest. Advancing and receding angle are the same.");
  return r;
}

}  // namespace

void add_drops_on_solids(std::vector<Case>& cases) {
  const std::string family = "Surface tension and contact angle";
  const std::string models = "liquid/surface_tension.h liquid/contact_angle.h liquid/boundary.h liquid/drop_measure.h";
  cases.push_back({"drop-on-ball", family, "A drop on a ball shows its contact angle", "angle, base, height, volume, force on a ball three times its size", "two spherical caps that meet under the angle",
                   "geometry; force -2 pi a gamma sin(theta + psi)", "no gravity, one angle", models, on_ball});
  cases.push_back({"drop-on-cone", family, "A drop on the tip of a cone shows its contact angle", "angle, base, height, volume, force on a cone", "a spherical cap that meets the cone's side under the angle",
                   "geometry; force -2 pi a gamma sin(theta + alpha)", "no gravity, one angle", models, on_cone});
  cases.push_back({"drop-on-weave", family, "A drop on a woven sheet that does not drink shows its fibres' angle", "angle, base, height, volume, force on polypropylene", "spherical cap of the given angle",
                   "geometry; force -2 pi a gamma sin(theta)", "no gravity, one angle; a face that is dry", models + " coupling/wet_wall.h", on_weave});
}

}  // namespace imbibe::verify
