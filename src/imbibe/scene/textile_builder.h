// A woven textile from its part of a scene: fabric with the textile's contact angles, wetting model, contents, and the
// indices of its nodes. With a running textile given, what the change leaves alone is shared with it: the fabric while
// its description is the same (with other contact angles a copy that has them), the model while fabric, numbers and
// liquid are the same, else the network's order; the contents are copied. All of it equals what would be built.
// Tested in tests/scene/live_change_test.cpp.
#pragma once

#include <string>

#include "imbibe/fabric/fibre_file.h"
#include "imbibe/scene/builder.h"
#include "imbibe/scene/scene.h"
#include "imbibe/sim/world.h"

namespace imbibe {

// What a textile was built from, and what it is now.
struct RunningTextile {
  const TextileSpec* spec = nullptr;  // null: there is none
  const Textile* textile = nullptr;
};
// Of the scene's textile i; none for cloths of cells.
RunningTextile running_textile(const RunningWorld* running, std::size_t i);

// Name, place and fabric. Throws InputError with keys below `key`.
Textile woven_textile(const TextileSpec& spec, const FibreLibrary& fibres, const std::string& key,
                      const RunningTextile& running);

// Model, contact and indices, for the liquid of the world. Throws InputError with keys of the network's.
void set_wetting(const TextileSpec& spec, const World& world, Textile& textile, const RunningTextile& running);

// What it holds, in the air of the world. Throws InputError with keys of the textile's.
void set_contents(const TextileSpec& spec, const Air& air, Textile& textile, const RunningTextile& running);

}  // namespace imbibe
