// Water between the fibre substance and what surrounds it: the liquid in its yarn or pores (sorption.h), and the air
// (evaporation.h). Local to a node and exact in time, so it is split from transport.
//
// Liquid first: a segment's fibres sorb from its own capillary water on the wetted share of their surface; fibres of a
// yarn without voids sorb from the pores beside it. Then vapour: while a node holds liquid it gives off at activity 1;
// for the rest of the step its fibres exchange with the air through their own inner resistance. A pore gives off on the
// part of its cell whose yarns are dry, so a cell with anything wet in it evaporates as one face.
// Tested in tests/wetting/network_test.cpp (drying) and behaviour_test.cpp.
#pragma once

#include "imbibe/wetting/wetting_model.h"

namespace imbibe {

// Sorption from liquid over dt; conserves mass node by node.
void sorb_liquid(const WettingModel& model, Contents& contents, Real dt);

// Exchange with the air over dt; returns kg given to the air.
Real exchange_vapour(const WettingModel& model, Contents& contents, const Air& air, Real dt);

}  // namespace imbibe
