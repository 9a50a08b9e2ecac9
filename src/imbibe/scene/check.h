// What `imbibe check` prints: the numbers that follow from a scene, before anything runs. All estimates say so.
// Tested in tests/scene/check_test.cpp.
#pragma once

#include <string>

#include "imbibe/scene/builder.h"

namespace imbibe {

// Key figures of one drop or box of liquid.
struct DropNumbers {
  Real radius = 0;            // m, of the ball (of equal volume, for a box)
  Real mass = 0;              // kg
  Real particles = 0;
  Real particles_across = 0;  // diameter over spacing
  Real bond_number = 0;       // rho g R^2 / gamma
  Real weber_number = 0;      // rho v^2 2R / gamma
  Real capillary_number = 0;  // eta v / gamma
};
DropNumbers drop_numbers(const Source& source, const Liquid& liquid, Real gravity);

// The whole report as text, ends with a newline.
std::string check_report(const Scene& scene, const World& world);

// Only the part of one textile: its fabric and what the liquid makes of it. Also shown in the run's report.
std::string textile_report(const World& world, std::size_t textile);

}  // namespace imbibe
