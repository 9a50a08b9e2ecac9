#include "imbibe/liquid/liquid_kind.h"

namespace imbibe {

Real capillary_length(const LiquidKind& kind, Real gravity) {
  return std::sqrt(kind.surface_tension / (kind.density * gravity));
}
Real ohnesorge_number(const LiquidKind& kind, Real length) {
  return kind.viscosity / std::sqrt(kind.density * kind.surface_tension * length);
}
Real bond_number(const LiquidKind& kind, Real length, Real gravity) {
  return kind.density * gravity * length * length / kind.surface_tension;
}

}  // namespace imbibe
