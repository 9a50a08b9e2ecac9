// Fibres brought into balance with moist air: what a cloth holds before liquid touches it, and what steam or a dry stream
// of air makes of it later.
//
//   W(phi) = sum_f m_f W_f(phi) / sum_f m_f            regain of the whole cloth in balance with air of humidity phi
//
// m_f kg of dry fibre of each kind, W_f its adsorption isotherm (isotherm.h). Conditioning to a regain W finds the one phi
// that gives it, so that warp and weft of different fibres stand in balance with each other as they do in a climate
// chamber. W rises with phi, from 0 to W(1): a cloth cannot be conditioned to more.
// Assumed: it happens at once and everywhere (a chamber takes hours), and only where fibres touch no liquid: liquid holds
// them at an activity of 1 whatever the air is. The water comes from the air or goes to it: the caller books it.
// Tested in tests/wetting/conditioning_test.cpp.
#pragma once

#include "imbibe/wetting/wetting_model.h"

namespace imbibe {

// W(phi) of the dry fibres of `model`, kg/kg.
Real regain_in_balance(const WettingModel& model, Real humidity);

// phi at which the cloth's regain is `regain`. Throws InputError (key `regain`) where that is above W(1).
Real humidity_in_balance(const WettingModel& model, Real regain);

// Sets the fibres of all segments that hold no liquid (and, of a fibre as thick as its yarn, have none in the pores beside
// it) to balance with air of `humidity`. Returns kg that came from the air, negative when it took some.
Real condition_dry_fibres(const WettingModel& model, Contents& contents, Real humidity);

}  // namespace imbibe
