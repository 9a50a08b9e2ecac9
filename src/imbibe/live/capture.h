// Takes what the page shows from a World: snapshots for frames, geometry and texts for the scene message, the contents
// of one node for picking. Tested in tests/live/capture_test.cpp, and with the page in viewer/test/live.test.mjs.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "imbibe/io/series.h"
#include "imbibe/live/snapshot.h"
#include "imbibe/scene/library.h"
#include "imbibe/scene/scene.h"
#include "imbibe/sim/step.h"
#include "imbibe/sim/world.h"

namespace imbibe::live {

// The columns of a frame's values: those of series.csv, then these.
struct LiveColumns {
  Real speed = 0;          // simulated per wall-clock second
  int step_bound = 0;      // index into step_bounds()
  bool converged = true;
};
const std::vector<std::string>& live_columns();      // all names
const std::vector<std::string>& step_bounds();       // names of what held a step
int step_bound_index(const char* name);

std::vector<double> live_values(const SeriesRow& row, const LiveColumns& more);

// Centre lines are thinned to this many steps per half loop; the page draws round curves through them.
inline constexpr int shown_steps_per_segment = 4;

QuantisedPoints sheet_points(const SoftSheet& soft);
// Centre lines, thinned to what the page draws, of all points of a textile's yarns in the world.
QuantisedPoints thinned_points(const YarnNetwork& network, std::span<const Vec3> all);

// `before`: the snapshot made last; what has not changed is shared with it. Positions of resting liquid are not looked
// at again.
Snapshot take_snapshot(const World& world, const std::vector<std::vector<Real>>& saturations, const Snapshot* before);

struct SceneTexts {
  int swatch = 0;
  bool replay = false;
  std::string folder;          // where the run is written, for the page to name
  std::string history_json = "[]";  // rows of a finished run; those of a running one follow (Feed::history_json)
};
Geometry take_geometry(std::uint32_t generation, const Scene& scene, const World& world, const Library& library,
                       const SceneTexts& texts);

// What a node holds, as JSON text for the page; "" when there is no such node. `place`: where it is, m, when the world
// does not know (a replayed sheet).
std::string inspect(const World& world, std::size_t textile, std::size_t node, const Vec3* place = nullptr);

}  // namespace imbibe::live
