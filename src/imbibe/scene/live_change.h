// Changes of a running simulation, as `path=value` assignments like those of `--set`, and the log that reruns them.
//
// The scene with the change is read and checked as any scene, the world is built from it, and the state of the running
// world is carried over: whatever the scene builds (angles, models, solver settings, air, gravity, sources) is new,
// whatever the steps made (sim/state_fields.h) is kept, and so every liquid's mass. Fabrics, models and meshes that the
// change leaves alone are shared with the running world (textile_builder.h): equal to the bit, and no stall. What a material of new fibres cannot
// hold is expelled: water above the new fibres' greatest regain, and liquid in yarns that no longer wet, go to the
// yarn's faces, where they become drops. A changed `regain` conditions the fibres that touch no liquid (conditioning.h); the
// water of it is booked with what went to the air.
// A change that would alter the size or meaning of the state (counts, resolution, sorption shells) is refused: it takes
// effect at a restart.
//
// The log (changes.jsonl, one JSON object per line):
//   {"step": 120, "time_s": 0.0123, "set": ["textiles[0].contact_angle=60 deg"]}    before the step after step 120
//   {"step": 900, "time_s": 0.9, "end": true}                                       here the run was ended
// A rerun with the log makes the same steps and ends in the same bits.
// Tested in tests/scene/live_change_test.cpp.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "imbibe/scene/library.h"
#include "imbibe/scene/scene.h"
#include "imbibe/sim/world.h"

namespace imbibe {

enum class Effect {
  next_step,  // while it runs
  restart,    // only in a world built anew: geometry, resolution, what was poured already
  never,      // of files and pictures, not of the simulation
};

// By path alone. What is not named in the list behind this takes effect at the next step, unless apply_change finds
// that it does not fit the state.
Effect effect_of(const std::string& path);

// The scene with the assignments, or an InputError with every problem.
Scene changed_scene(const Scene& scene, const std::vector<std::string>& assignments);

// Goes on with the changed scene, or throws and leaves both as they were.
void apply_change(Scene& scene, World& world, const Library& library, Scene changed);

// Applies the assignments to both, or throws InputError with every problem and leaves both as they were. An index one
// past the end of a list appends: `liquid.drops[2]={centre: ..., volume: ...}`.
void apply_change(Scene& scene, World& world, const Library& library, const std::vector<std::string>& assignments);

inline constexpr const char* changes_file = "changes.jsonl";

struct LoggedChange {
  std::uint64_t step = 0;
  Real time_s = 0;
  std::vector<std::string> assignments;
  bool end = false;  // the run was ended here
};

std::string change_line(const LoggedChange& change);  // with its line end
// Throws InputError with line numbers. Steps must not decrease.
std::vector<LoggedChange> read_changes(const std::filesystem::path& file);

// Applies, at each step, the changes that were logged there; for RunHooks::before_step and stop_requested.
class ChangeReplay {
 public:
  explicit ChangeReplay(std::vector<LoggedChange> changes) : changes_(std::move(changes)) {}
  // True when something was changed; `until` follows the scene's duration.
  bool apply_due(Scene& scene, World& world, const Library& library, Real& until);
  bool ended() const { return ended_; }

 private:
  std::vector<LoggedChange> changes_;
  std::size_t next_ = 0;
  bool ended_ = false;
};

}  // namespace imbibe
