// Which nodes a transport step solves, and what it needs to know of them: wet and supplied nodes with two rings of
// neighbours, in the order of their places, with their links as rows.
// Tested through transport.h in tests/wetting/network_test.cpp.
#pragma once

#include "imbibe/wetting/transport.h"

namespace imbibe {

void choose_active(const TransportInput& input, const Contents& contents, TransportWorkspace& work);
// A node at the rim of the set got wet: more rings. False: the set was wide enough.
bool widen_active(const WettingModel& model, TransportWorkspace& work);
// Puts the set in order, gathers its state and its links. A solution in work.saturation is the guess for the wider set.
void gather(const TransportInput& input, const Contents& contents, TransportWorkspace& work);

}  // namespace imbibe
