// Fibre, liquid and fabric files: the first byte says which.
#include "fuzz.h"
#include "imbibe/fabric/fibre_file.h"
#include "imbibe/scene/fabric_file.h"
#include "imbibe/scene/library.h"

using namespace imbibe;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const fuzz::MemoryFile file(fuzz::text_of(data + 1, size - 1));
  fuzz::reads([&] {
    if (data[0] == 'f') {
      const FibreRecord record = read_fibre_file(file.path());
      IMBIBE_ASSERT(std::isfinite(record.fibre.density) && record.fibre.density > 0);
      IMBIBE_ASSERT(record.fibre.receding_angle <= record.fibre.advancing_angle);
    } else if (data[0] == 'l') {
      const LiquidRecord record = read_liquid_file(file.path());
      IMBIBE_ASSERT(record.kind.density >= 100 && record.kind.viscosity >= 0 && record.kind.surface_tension >= 0);
    } else {
      read_fabrics(file.path());
    }
  });
  return 0;
}
