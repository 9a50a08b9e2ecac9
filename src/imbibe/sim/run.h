// Steps a World to its end and hands it to observers; knows nothing of files or screens.
#pragma once

#include <functional>

#include "imbibe/sim/step.h"

namespace imbibe {

struct RunHooks {
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
// Throws NumericalError from step(), after which `world` is the last state reached.
RunEnd run(World& world, const RunPlan& plan, const RunHooks& hooks);

}  // namespace imbibe
