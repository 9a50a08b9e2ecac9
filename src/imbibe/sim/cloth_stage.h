// The cloth stage of a step: soft sheets move under the liquid's forces, the liquid's particles meet them on the way, and
// the cells of seed B's cloths exchange liquid.
#pragma once

#include "imbibe/sim/step.h"

namespace imbibe {

// Whether a soft sheet is in motion (those at rest or fixed are not stepped).
bool any_cloth_moves(const World& world);
bool any_network_cloth_moves(const World& world);
bool any_threads_resist(const World& world);  // soft_sheet.h

// s, the longest step that keeps liquid and cloth in touch; infinity without soft sheets.
Real longest_cloth_step(const World& world);

// Surfaces and frames of the soft sheets as they lie now. Before anything asks for places on them.
void ready_cloths(const World& world, StepScratch& scratch);

// The place of a textile, flat or bent; for as long as world and scratch stay as they are.
ClothPlace place_of(const World& world, std::size_t textile, const StepScratch& scratch);
SoftSheetScratch& sheet_of(const World& world, std::size_t textile, StepScratch& scratch);

// The cell cloths as walls of the liquid's next step, after those of solids and textiles.
void add_sheet_walls(const World& world, StepScratch& scratch);

// The cloths' own step of dt, before the liquid's.
void advance_cloths(World& world, Real dt, StepScratch& scratch, StepReport& report);

// After the liquid's step of the same dt (none when nothing moves): what it gave the sheets, then its particles against
// them. With `report.liquid_moved` the particles have just moved from scratch.liquid.fields' positions to their own: those
// that crossed a sheet are absorbed or put back. Then the cells.
void meet_cloths(World& world, Real dt, StepScratch& scratch, StepReport& report);

}  // namespace imbibe
