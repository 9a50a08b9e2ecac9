// The page's controls, made from the parameter descriptions of a scene (core/parameter.h): one per key of the scene as
// it stands, list items included, with name, value, unit, range, help, and when a change of it takes effect
// (scene/live_change.h). No parameter is named here.
// Tested in tests/live/controls_test.cpp.
#pragma once

#include <string>
#include <vector>

#include "imbibe/scene/library.h"
#include "imbibe/scene/live_change.h"
#include "imbibe/scene/parameter_table.h"
#include "imbibe/scene/scene.h"
#include "imbibe/sim/world.h"

namespace imbibe::live {

struct Control {
  ParameterRow row;            // path with list indices; fallback: the value as written, "" = not given
  std::vector<Real> numbers;   // the value in the shown unit; empty when it is not numbers or not given
  Real low = -unlimited, high = unlimited;  // range in the shown unit
  Effect effect = Effect::next_step;
};

std::vector<Control> controls_of(const Scene& scene);

// As JSON rows for the page. `world` gives what a key that is not written stands for now (a fibre's own angle).
std::string controls_json(const Scene& scene, const World& world, const Library& library);

}  // namespace imbibe::live
