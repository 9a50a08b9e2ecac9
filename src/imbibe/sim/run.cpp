#include "imbibe/sim/run.h"

#include <fmt/format.h>

#include "imbibe/core/error.h"

namespace imbibe {

// The first multiple of `every` after `time`, or `until` when that comes first. A multiple within a billionth of
// `time` counts as reached, since sums of steps are rounded.
static Real next_output(Real time, Real every, Real until) {
  if (every <= 0) return until;
  const Real next = (std::floor(time / every * (1 + 1e-9) + 1e-9) + 1) * every;
  return next < until * (1 - 1e-9) ? next : until;
}

RunEnd run(World& world, const RunPlan& plan, const RunHooks& hooks) {
  StepScratch scratch;
  StepReport report;
  emit_due(world);  // the first output shows the drops that hang there at the start
  if (hooks.at_output) hooks.at_output(world, report);
  StepOptions options = plan.step;
  const std::uint64_t first_step = world.step;
  Real until = plan.until;
  for (;;) {
    if (hooks.before_step && hooks.before_step(world, until)) {
      auto networks = std::move(scratch.textiles);  // these know which model they are of
      scratch = {};
      scratch.textiles = std::move(networks);
    }
    if (hooks.stop_requested && hooks.stop_requested()) return world.time < until ? RunEnd::stopped : RunEnd::finished;
    if (world.time >= until) return RunEnd::finished;
    options.until = next_output(world.time, plan.every, until);
    report = step(world, options, scratch);
    // A step that ends by another bound may stop a rounding error before an output; the next one counts from the one after.
    const bool reached = world.time >= options.until || next_output(world.time, plan.every, until) > options.until;
    if (hooks.after_step) hooks.after_step(world, report);
    if (reached && hooks.at_output) hooks.at_output(world, report);
    if (plan.max_steps > 0 && world.step - first_step >= plan.max_steps)
      throw InputError(fmt::format("stopped after {} steps at t = {:.6g} s: the limit limits.max_steps is reached",
                                   plan.max_steps, world.time));
  }
}

bool remake(World& world, std::uint64_t step, RunPlan plan, const std::function<bool()>& stop_requested) {
  plan.max_steps = 0;
  RunHooks hooks;
  hooks.stop_requested = [&] { return world.step >= step || (stop_requested && stop_requested()); };
  if (world.step < step) run(world, plan, hooks);
  return world.step == step;
}

}  // namespace imbibe
