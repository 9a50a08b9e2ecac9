// Steps a World to its end and hands it to observers; knows nothing of files or screens.
#pragma once

#include <functional>

#include "imbibe/sim/step.h"

namespace imbibe {

struct RunHooks {
  // Before every step, and once more at the end: may change the world and the end time (live changes and their replay).
  // True: it did, so work space kept from earlier steps is thrown away.
  std::function<bool(World&, Real& until)> before_step;
  std::function<void(const World&, const StepReport&)> at_output;   // at the start, every `every`, and at the end
  std::function<void(const World&, const StepReport&)> after_step;  // progress, checkpoints
  std::function<bool()> stop_requested;                             // true: finish this step and return
};

struct RunPlan {
  Real until = 0;                 // s
  Real every = 0;                 // s between outputs; <= 0: only at the start and the end
  std::uint64_t max_steps = 0;    // 0 = no limit; more is an InputError (a guard against runaway runs)
  StepOptions step;
};

enum class RunEnd { finished, stopped };

// Output times are multiples of `every`, so a resumed run writes the same ones. Steps land on them exactly.
// Throws NumericalError from step(); `world` is then half-way through the step that failed. world.step says how many
// whole steps were made: as many from an earlier state give the last good one again, to the bit (`remake`).
RunEnd run(World& world, const RunPlan& plan, const RunHooks& hooks);

// Steps `world`, an earlier state of a run of the same plan, to the end of step number `step`, without observers.
// False when `stop_requested` came first.
bool remake(World& world, std::uint64_t step, RunPlan plan, const std::function<bool()>& stop_requested = {});

}  // namespace imbibe
