// Numbers with units: the first byte chooses the wanted unit; what is read is a finite number.
#include <cmath>

#include "fuzz.h"

using namespace imbibe;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static constexpr const char* wanted[] = {"m", "kg", "s", "1", "K", "rad", "kg/m", "1/m", "m3", "Pa s", "N/m", "kg/m2"};
  if (size == 0) return 0;
  const char* unit = wanted[data[0] % std::size(wanted)];
  const std::string text = fuzz::text_of(data + 1, size - 1);
  fuzz::reads([&] { IMBIBE_ASSERT(std::isfinite(parse_quantity(text, unit))); });
  return 0;
}
