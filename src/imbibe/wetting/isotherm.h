// How much water a fibre substance holds in air of a relative humidity, and the way back.
//
//   adsorption (GAB)   W = m0 C K phi / [(1 - K phi)(1 - K phi + C K phi)]
//   fallback           W = 0.55 W65 phi [1/(0.25 + phi) + 1/(1.25 - phi)]
//   desorption         W_des(phi) = W(phi) + d65 phi (1 - phi)/(0.65 * 0.35)
//
// W regain, kg water per kg dry fibre; phi relative humidity 0..1; m0, C, K fitted per fibre (Fibre::isotherm); W65 the
// regain at 65 %; d65 how far desorption lies above adsorption at 65 %.
// Source: Guggenheim-Anderson-de Boer form as in van den Berg & Bruin 1981; values Morton & Hearle; the fallback is
// the shape common to hygroscopic fibres. GAB is good to phi of about 0.9 and is used to 1.
// Between the two branches a fibre neither takes up nor gives off vapour (scanning curves taken as flat).
// Tested in tests/wetting/models_test.cpp.
#pragma once

#include "imbibe/core/types.h"
#include "imbibe/fabric/fibre.h"

namespace imbibe {

Real gab_regain(const GabIsotherm& isotherm, Real humidity);
Real one_parameter_regain(Real regain_65, Real humidity);

// Adsorption branch of `fibre`: GAB, else its straight line, else the fallback.
Real equilibrium_regain(const Fibre& fibre, Real humidity);
Real desorption_regain(const Fibre& fibre, Real humidity);

// The humidity in equilibrium with `regain` on the adsorption branch; 1 where the fibre holds more than at phi = 1.
Real equilibrium_humidity(const Fibre& fibre, Real regain);
Real desorption_humidity(const Fibre& fibre, Real regain);

}  // namespace imbibe
