// Files of a run folder that resume, render and report read back: series.csv, .pvd and .vtp; the first byte says which.
#include "fuzz.h"
#include "imbibe/io/series.h"
#include "imbibe/io/vtk.h"
#include "imbibe/view/vtp_reader.h"

using namespace imbibe;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const fuzz::MemoryFile file(fuzz::text_of(data + 1, size - 1));
  fuzz::reads([&] {
    if (data[0] == 's') {
      const SeriesTable table = read_series(file.path());
      if (table.rows() > 0) table.column("time_s");
    } else if (data[0] == 'p') {
      read_pvd(file.path());
    } else {
      read_vtp(file.path());
    }
  });
  return 0;
}
