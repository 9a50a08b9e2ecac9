// series.csv: one row per output time, what every curve of a run is drawn from. The first columns are fixed
// (docs/run_folder.md); later ones may be added at the end, so read by name.
// Tested in tests/io/series_test.cpp.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "imbibe/core/output_file.h"
#include "imbibe/sim/measures.h"
#include "imbibe/sim/step.h"
#include "imbibe/sim/world.h"

namespace imbibe {

struct SeriesRow {
  Real time_s = 0;
  MassBalance mass;
  std::size_t particles = 0;
  // Areas are summed over the textiles, extents and maxima are the greatest, mean_saturation is over all yarns.
  Real wet_area_m2 = 0, wet_extent_warp_m = 0, wet_extent_weft_m = 0;
  Real mean_saturation = 0, max_saturation = 0;
  Real step_s = 0;
  std::uint64_t steps = 0;
  Real wet_pore_area_m2 = 0, pore_saturation = 0, max_regain = 0;
  Real density_error = 0;       // peak of one particle in the last step
  DensityRecord density;        // of all steps so far
  std::uint64_t contacts = 0, absorbed_particles = 0, released_particles = 0, bounces = 0;
  Real wet_height_m = 0;        // from the lowest wet node to the highest, of the textile where it is greatest
  Real lowest_cloth_m = 0;      // z of the lowest node of the soft sheets; 0 without any
  Real waiting_kg = 0, owed_kg = 0;  // between books and particles: part of the balance
};

SeriesRow series_row(const World& world, const StepReport& last_step, const MeasureParams& params = {});

const std::vector<std::string>& series_columns();
// The numbers of a row, one per column.
std::vector<double> series_values(const SeriesRow& row);
// The line of a row, numbers so that they read back to the same bits, without line end.
std::string series_line(const SeriesRow& row);

// The open file. Every row is on its way to the disk when write() returns.
class SeriesFile {
 public:
  SeriesFile() = default;
  explicit SeriesFile(const std::filesystem::path& path);  // writes the header line when the file is new
  void write(const SeriesRow& row);

 private:
  AppendFile file_;
};

// Cuts rows later than `time_s` (and a half row) off the end, before a run is resumed.
void cut_series(const std::filesystem::path& path, Real time_s);

// A table read back: numbers by column name. A half last row is left out.
struct SeriesTable {
  std::vector<std::string> columns;
  std::vector<std::vector<Real>> values;  // per column
  const std::vector<Real>& column(const std::string& name) const;  // InputError when there is none
  std::size_t rows() const { return values.empty() ? 0 : values.front().size(); }
};
SeriesTable read_series(const std::filesystem::path& path);

}  // namespace imbibe
