// The run folder of a live session: the scene as it began, every change with its step in changes.jsonl, the rows of
// series.csv, and, while recording, the files that `imbibe run` writes. `imbibe run FOLDER/scene.yaml --changes
// FOLDER/changes.jsonl` makes the same steps again and ends in the same state_hash.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "imbibe/core/output_file.h"
#include "imbibe/io/run_folder.h"
#include "imbibe/scene/live_change.h"
#include "imbibe/scene/scene.h"

namespace imbibe::live {

// What a run folder says of the run of `scene`, whose world was built from it: the same for `run` and `live`.
RunSetup run_setup(const Scene& scene, const World& world, const std::string& command);

struct RecorderOptions {
  std::filesystem::path folder;  // wanted; numbered when it is taken
  bool exactly = false;          // the user named it: never another
  bool overwrite = false;        // replace an earlier run there
  std::string command;
  bool files = false;            // record from the start
};

class Recorder {
 public:
  // Begins a run: `scene` is what the world was built from.
  Recorder(const RecorderOptions& options, const Scene& scene, const World& world);

  const std::filesystem::path& folder() const { return run_->path(); }
  void write_output(const World& world, const StepReport& report) { run_->write_output(world, report); }
  void change(const World& world, const std::vector<std::string>& assignments);
  void record(bool on) { run_->write_files(on), recorded_ = recorded_ || on, recording_ = on; }
  bool recording() const { return recording_; }
  Real bytes() const { return run_->bytes(); }
  // The end of the run, at the state reached.
  void finish(const World& world, RunStatus status, const std::string& reason);
  // Nothing was changed and nothing recorded: the folder may be used again.
  bool untouched() const { return changes_ == 0 && !recorded_; }

 private:
  std::unique_ptr<RunFolder> run_;
  AppendFile log_;
  int changes_ = 0;
  bool recorded_ = false, recording_ = false, finished_ = false;
};

// `wanted`, or wanted_2, wanted_3, ...: the first that does not exist.
std::filesystem::path free_folder(const std::filesystem::path& wanted);

}  // namespace imbibe::live
