// One number for the whole state: two worlds with the same number hold the same bits. Written to run.json, stored in
// checkpoints, compared across thread counts. Tested in tests/sim/checkpoint_test.cpp.
#pragma once

#include <cstdint>
#include <string>

#include "imbibe/sim/world.h"

namespace imbibe {

// 64 bits over every field of state_fields.h in its order, lengths of arrays included. Of particle records x, y, z
// only: w is scratch. -0.0 and 0.0 differ, as their bits do.
std::uint64_t state_hash(const World& world);

// As 16 hexadecimal digits.
std::string state_hash_text(const World& world);

}  // namespace imbibe
