// A verification case: a scene that the real solver runs, a closed form or a published figure, and how far apart the two
// are. Cases are plain data with one function each; registry.cpp lists them; runner.h runs them; report.h writes them.
//
// Rules of this module:
//   - what is computed comes from build_world(read_scene(file, overrides)) and run(); a reader can repeat each run with
//     `imbibe run FILE --set ...`, and the report prints these commands;
//   - parameters are those of the case's source or the models' defaults; none is chosen for the result;
//   - a check that misses its tolerance is a failed check: it stays in the report with its error.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "imbibe/io/chart.h"
#include "imbibe/scene/builder.h"
#include "imbibe/scene/library.h"
#include "imbibe/scene/scene.h"
#include "imbibe/sim/run.h"
#include "imbibe/sim/world.h"
#include "imbibe/view/image.h"

namespace imbibe::verify {

// One figure against its reference.
struct Check {
  std::string quantity;
  Real measured = 0, reference = 0;  // in `unit`
  std::string unit;
  Real error = 0;                    // relative (1) or in `unit`
  bool relative = true;
  Real tolerance = 0;                // same kind as error
  std::string reason;                // where the tolerance comes from
  bool passed = false;
};

// |measured - reference| / |reference| <= tolerance.
Check near(std::string quantity, Real measured, Real reference, std::string unit, Real tolerance, std::string reason);
// |measured - reference| <= tolerance, both in `unit`.
Check within(std::string quantity, Real measured, Real reference, std::string unit, Real tolerance, std::string reason);
// measured <= bound.
Check at_most(std::string quantity, Real measured, Real bound, std::string unit, std::string reason);
// measured >= bound.
Check at_least(std::string quantity, Real measured, Real bound, std::string unit, std::string reason);

// Errors at several resolutions. `order` is the slope of log(error) over log(step) by least squares.
struct Convergence {
  std::string error_of;   // what the error is of
  std::string step_name;  // e.g. "segment length [mm]"
  struct Row {
    Real step = 0, error = 0;
  };
  std::vector<Row> rows;
  Real order = 0;
};
Convergence convergence_of(std::string error_of, std::string step_name, std::vector<Convergence::Row> rows);

struct ParameterRow {
  std::string name, value;
};

struct CaseResult {
  std::vector<ParameterRow> parameters;
  std::vector<Check> checks;
  std::vector<Convergence> convergence;
  std::vector<Chart> charts;
  std::vector<std::string> notes;      // sentences: what the figures mean, known causes of errors
  std::vector<std::string> commands;   // the runs made, as `imbibe run ...`
  Image picture;                       // empty: none
  std::string picture_caption;
  bool passed() const;
};

// What a case may use; made by the runner.
class CaseRunner {
 public:
  CaseRunner(std::filesystem::path scene_folder, Library library, bool quick, bool pictures)
      : scene_folder_(std::move(scene_folder)), library_(std::move(library)), quick_(quick), pictures_(pictures) {}

  bool quick() const { return quick_; }
  // `full` unless the quick form is wanted.
  template <class T>
  T form(T quick_value, T full_value) const {
    return quick_ ? quick_value : full_value;
  }
  const Library& library() const { return library_; }

  Scene scene(const std::string& name, const std::vector<std::string>& overrides = {}) const;
  // The world of scenes/verify/<name>.yaml; the command that repeats it is noted for the report.
  World world(const std::string& name, const std::vector<std::string>& overrides = {});
  // Runs a world to `until`; `observe` is called at the start, every `every`, and at the end.
  using Observer = std::function<void(const World&, const StepReport&)>;
  void run(World& world, const Scene& scene, const Observer& observe = {}, const Observer& after_step = {}) const;
  // Both at once: the final world.
  World run(const std::string& name, const std::vector<std::string>& overrides = {}, const Observer& observe = {},
            const Observer& after_step = {});
  // The picture of the case.
  void picture(CaseResult& result, const World& world, const Scene& scene, const std::string& caption) const;

  std::vector<std::string> take_commands() { return std::exchange(commands_, {}); }

 private:
  std::filesystem::path scene_folder_;
  Library library_;
  bool quick_ = false, pictures_ = true;
  std::vector<std::string> commands_;
};

struct Case {
  std::string name;          // for the command line: small letters and dashes
  std::string family;        // heading of the report
  std::string title;
  std::string computes;      // what is computed
  std::string formula;       // the reference, in words and symbols
  std::string source;
  std::string assumptions;
  std::string models;        // headers of the models checked, e.g. "wetting/capillary.h", separated by spaces
  CaseResult (*run)(CaseRunner&) = nullptr;
};

// All cases in the order of the report.
const std::vector<Case>& all_cases();

// ---- for cases ---------------------------------------------------------------------------------------------------

// "path=value" with all digits.
std::string set(const std::string& path, Real value, const std::string& unit = "");
// Two curves over the same x, in plain numbers of the given units.
Chart chart_of(std::string title, std::string x_name, std::string x_unit, std::string y_name, std::string y_unit,
               std::vector<Real> x, std::vector<Curve> curves);

}  // namespace imbibe::verify
