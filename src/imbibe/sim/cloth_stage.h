// The cloth stage of a step: soft sheets move under the liquid's forces, the liquid's particles meet them on the way, and
// the cells of seed B's cloths exchange liquid.
#pragma once

#include "imbibe/sim/step.h"

namespace imbibe {

// Whether a soft sheet is in motion (those at rest or fixed are not stepped).
bool any_cloth_moves(const World& world);

// s, the longest step that keeps liquid and cloth in touch; infinity without cell cloths.
Real longest_cloth_step(const World& world);

// The soft sheets as walls of the liquid's next step, after those of solids and fixed textiles.
void add_sheet_walls(const World& world, StepScratch& scratch);

// Advances all soft sheets by dt. With `report.liquid_moved` the particles have just moved from scratch.liquid.fields'
// positions to their own: those that crossed a sheet are absorbed or put back.
void step_cloths(World& world, Real dt, StepScratch& scratch, StepReport& report);

}  // namespace imbibe
