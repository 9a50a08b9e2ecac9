// The folder of a run: everything it leaves behind, readable at any moment (docs/run_folder.md).
//   scene.yaml run.json log.txt series.csv checkpoint_*.h5 pictures/ film.mp4 report.html
//   files/: meshes and drafts that the scene names, so that the folder may be moved and outlives them
//   liquid.pvd liquid_000000.vtp ...  textile_<name>.pvd ...  textile_<name>_pores.pvd ...
// Nothing is half written under its own name; the row of series.csv comes last, so a time that has a row has its files.
// What the disk refuses is an OutputError, and what was written before stays.
// Tested in tests/io/run_folder_test.cpp.
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
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
  resume,     // go on in it: rows and entries later than the world's time are removed
  overwrite,  // remove what an earlier run left there, and only that; not a run's folder: an InputError
};

inline const std::string run_files_folder = "files";

struct RunSetup {
  std::string command;     // to repeat it, as it would be typed
  std::string title;
  std::string scene_yaml;  // resolved text, runnable again
  std::map<std::string, std::string> files;  // that it names: path in the folder, contents
  std::uint64_t seed = 1;
  int threads = 0;
  Real until_s = 0;
  Real every_s = 0;        // between outputs; 0 = take it from the rows that are there
  // Derived numbers of each textile's fabric, as `imbibe check` prints them: name and text.
  std::vector<std::pair<std::string, std::string>> fabrics;
  MeasureParams measures;
  bool particle_files = true, textile_files = true;
};

enum class RunStatus { running, done, interrupted, failed };

class RunFolder {
 public:
  // Creates the folder (and parents) and writes scene.yaml with its files, and run.json. `world` is the state the run starts or
  // resumes from.
  RunFolder(std::filesystem::path folder, RunSetup setup, ExistingFolder existing, const World& world);

  const std::filesystem::path& path() const { return folder_; }

  // One output time: the .vtp files, their .pvd, a row of series.csv, run.json. The state a run resumes from is left
  // out when it was written already or lies between two output times: a resumed run leaves the same files as one that
  // was never stopped. False when it was left out.
  bool write_output(const World& world, const StepReport& last_step);

  void write_checkpoint(const World& world);

  // Whether the following outputs write .vtp files, of the kinds that the setup asks for, or only their rows.
  void write_files(bool on) { with_files_ = on; }

  // A line of log.txt; a time stamp is put before it.
  void log(const std::string& line);

  // A sentence for the report, e.g. by which mechanism the drop was taken up.
  void note(std::string sentence) { notes_.push_back(std::move(sentence)); }

  // Writes run.json with the final state and `reason` (why it was interrupted or failed).
  void finish(const World& world, RunStatus status, const std::string& reason = "");

  int outputs() const { return outputs_; }

  // Room that the folder takes on the disk, for limits.max_disk: counted once at the start, then by what is written.
  // Pictures are written by others, who say so with `count`.
  Real bytes() const { return bytes_ + checkpoint_bytes_; }
  void count(const std::filesystem::path& written);

 private:
  struct Collection {  // one .pvd and its files
    std::string stem;
    std::vector<PvdEntry> entries;
  };

  void prepare(ExistingFolder existing, const World& world);
  void continue_run(const World& world);
  void remove_later_outputs();
  void count_all();
  void count_checkpoints();
  void write_frame(Collection& collection, const PolyData& data, const World& world);
  void write_run_json(const World& world, RunStatus status, const std::string& reason);
  Real wall_s() const;

  std::filesystem::path folder_;
  RunSetup setup_;
  bool with_files_ = true;
  SeriesFile series_;
  AppendFile log_;
  std::vector<std::string> notes_;
  std::vector<Collection> collections_;  // liquid, then yarns and pores of every textile
  std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
  std::string started_at_;
  Real earlier_wall_s_ = 0;  // of the runs before a resume
  Real run_json_wall_s_ = 0;  // when run.json was last written
  Real bytes_ = 0;             // of all files but the checkpoints
  Real checkpoint_bytes_ = 0;  // of the checkpoints that are kept
  int outputs_ = 0;
  std::optional<Real> skip_until_;  // s, outputs up to this time are there already
};

// The data of the .vtp files.
// `hanging`: particles of drops that hang at cloths, of class 3 and without an id (-1).
PolyData liquid_poly_data(const Liquid& liquid, std::span<const Vec3> hanging = {});
// `saturations`: node_saturations(). Every point of a yarn's line carries the values of the segment it lies on.
PolyData textile_poly_data(const Textile& textile, const std::vector<Real>& saturations);
PolyData pore_poly_data(const Textile& textile, const std::vector<Real>& saturations);
// The moving sheet of a cell cloth as triangles: saturation, cell_kg, velocity, uv (material coordinates, m).
PolyData cell_cloth_poly_data(const CellCloth& cloth);

// The names of the collections of .vtp files before "_000000.vtp" and ".pvd": liquid, then yarns and pores of every
// textile. Names of textiles may differ only in what a file name cannot carry; these differ always.
std::vector<std::string> collection_stems(const World& world);

// `name` with everything that is not a letter, digit, '-' or '_' replaced by '_'.
std::string file_name_part(const std::string& name);

}  // namespace imbibe
