// The folder of a run: everything it leaves behind, readable at any moment (docs/run_folder.md).
//   scene.yaml run.json log.txt series.csv liquid.pvd liquid_000000.vtp ... textile_<name>.pvd textile_<name>_000000.vtp
//   ... textile_<name>_pores.pvd ... checkpoint_*.h5 pictures/ film.mp4 report.html
// Tested in tests/io/run_folder_test.cpp.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "imbibe/io/series.h"
#include "imbibe/io/vtk.h"
#include "imbibe/sim/step.h"
#include "imbibe/sim/world.h"

namespace imbibe {

enum class ExistingFolder {
  refuse,     // a folder that is not empty is an InputError
  resume,     // go on in it: rows and files later than the world's time are removed
  overwrite,  // remove what an earlier run left there (only names that a run writes)
};

struct RunSetup {
  std::string command;     // to repeat it, as it would be typed
  std::string title;
  std::string scene_yaml;  // resolved text, runnable again
  std::uint64_t seed = 1;
  int threads = 0;
  Real until_s = 0;
  // Derived numbers of each textile's fabric, as `imbibe check` prints them: name and text.
  std::vector<std::pair<std::string, std::string>> fabrics;
  MeasureParams measures;
  bool particle_files = true, textile_files = true;
};

enum class RunStatus { running, done, interrupted, failed };

class RunFolder {
 public:
  // Creates the folder (and parents) and writes scene.yaml and run.json. `world` is the state the run starts or
  // resumes from.
  RunFolder(std::filesystem::path folder, RunSetup setup, ExistingFolder existing, const World& world);

  const std::filesystem::path& path() const { return folder_; }

  // One output time: a row of series.csv, the .vtp files and their .pvd. Does nothing if this time was written
  // already (the first one after a resume).
  void write_output(const World& world, const StepReport& last_step);

  void write_checkpoint(const World& world);

  // A line of log.txt; a time stamp is put before it.
  void log(const std::string& line);

  // A sentence for the report, e.g. by which mechanism the drop was taken up.
  void note(std::string sentence) { notes_.push_back(std::move(sentence)); }

  // Writes run.json with the final state and `reason` (why it was interrupted or failed).
  void finish(const World& world, RunStatus status, const std::string& reason = "");

  int outputs() const { return outputs_; }

 private:
  void prepare(ExistingFolder existing, const World& world);
  void write_run_json(const World& world, RunStatus status, const std::string& reason);
  void write_frame(const std::string& stem, const PolyData& data, const VtkTime& when, std::vector<PvdEntry>& entries);

  std::filesystem::path folder_;
  RunSetup setup_;
  SeriesFile series_;
  AppendFile log_;
  std::vector<std::string> notes_;
  std::vector<std::pair<std::string, std::vector<PvdEntry>>> collections_;  // stem -> entries
  std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
  Real earlier_wall_s_ = 0;  // of the runs before a resume
  std::string started_at_;
  int outputs_ = 0;
  std::optional<Real> last_output_time_;
};

// The data of the .vtp files.
PolyData liquid_poly_data(const Liquid& liquid);
PolyData textile_poly_data(const Textile& textile);
PolyData pore_poly_data(const Textile& textile);

// `name` with everything that is not a letter, digit, '-' or '_' replaced by '_'.
std::string file_name_part(const std::string& name);

}  // namespace imbibe
