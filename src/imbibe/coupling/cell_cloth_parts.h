// What the parts of a cloth of cells share (cell_cloth.cpp, cell_drops.cpp); not for others.
#pragma once

#include "imbibe/coupling/cell_cloth.h"

namespace imbibe {

// Mass that changes node takes its momentum along.
void carry(CellCloth& cloth, std::span<const std::uint8_t> held, Index from, Index to, Real kg);

// Drops that hang where cells have room again, and nothing leaks, are drawn back into the cloth.
void draw_back(CellCloth& cloth, std::span<const std::uint8_t> held);

// Drops fall where they have grown to their greatest mass; what comes faster than drops can fall leaves as a stream.
void release_waiting(CellCloth& cloth, SoftSheetScratch& scratch, Liquid& liquid, const Vec3& gravity, const SolidAt& solid_at,
                     CellExchangeReport& report);

}  // namespace imbibe
