#include "imbibe/scene/live_change.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>

#include "imbibe/core/output_file.h"
#include "imbibe/scene/builder.h"
#include "imbibe/scene/placement_checks.h"
#include "imbibe/sim/state_fields.h"
#include "imbibe/wetting/conditioning.h"

namespace imbibe {
namespace {

using Json = nlohmann::ordered_json;

// Whether `path` is the key `pattern`, lies inside it or around it; [] in the pattern matches any index.
bool matches(std::string_view path, std::string_view pattern) {
  std::size_t i = 0, k = 0;
  while (k < pattern.size()) {
    if (i == path.size()) return pattern[k] == '.' || pattern[k] == '[';
    if (pattern.substr(k).starts_with("[]")) {
      if (path[i] != '[') return false;
      const std::size_t close = path.find(']', i);
      if (close == std::string_view::npos) return false;
      i = close + 1, k += 2;
    } else {
      if (path[i] != pattern[k]) return false;
      ++i, ++k;
    }
  }
  return i == path.size() || path[i] == '.' || path[i] == '[';
}

constexpr std::array never_live{"version", "title", "output", "picture", "limits"};

constexpr std::array only_at_restart{
    "seed", "domain",
    // resolution and the mass of what is there
    "liquid.particle_mass", "liquid.kind.name", "liquid.kind.density", "liquid.boxes",
    // a drop that has fallen cannot fall otherwise
    "liquid.drops[]",
    // geometry of the cloth
    "textiles[].name", "textiles[].centre", "textiles[].weft_direction", "textiles[].warp_direction", "textiles[].size",
    "textiles[].weave", "textiles[].weave_rows", "textiles[].stripes", "textiles[].thickness", "textiles[].areal_mass",
    "textiles[].porosity", "textiles[].porosity_by", "textiles[].warp_crimp_share", "textiles[].points_per_segment",
    "textiles[].start", "textiles[].warp.density", "textiles[].weft.density", "textiles[].sheet.kind",
    "textiles[].sheet.soft.columns", "textiles[].sheet.soft.rows", "textiles[].sheet.soft.node_distance",
    "textiles[].sheet.soft.mesh", "textiles[].sheet.soft.uv_scale", "textiles[].sheet.soft.transform",
    "textiles[].wetting.cells.cell_size",
    // number of values per node
    "textiles[].wetting.kind", "textiles[].wetting.network.sorption", "textiles[].wetting.network.shells",
    "textiles[].wetting.network.hysteresis", "textiles[].wetting.network.pores",
    "solids[].name", "solids[].shape"};

// The state of one world by field, to be copied into another.
struct Fields {
  std::map<std::string, const void*> found;
  std::string path;
  void group(const std::string& name) { path = name + "/"; }
  template <class T>
  void value(const char* name, const T& x) { found[path + name] = &x; }
  template <class T>
  void array(const char* name, const std::vector<T>& x) { found[path + name] = &x; }
};

struct Carry {
  const Fields& from;
  std::string path{};
  std::vector<std::string> misfits{};
  void group(const std::string& name) { path = name + "/"; }
  // What a change may set anew stays as built.
  bool as_built() const { return path == "air/" || path.starts_with("sources/"); }
  const void* find(const char* name) const {
    const auto at = from.found.find(path + name);
    return at == from.found.end() ? nullptr : at->second;
  }
  template <class T>
  void value(const char* name, T& x) {
    if (as_built() || std::string_view(name) == "gravity") return;
    if (const void* old = find(name)) x = *static_cast<const T*>(old);
  }
  template <class T>
  void array(const char* name, std::vector<T>& x) {
    const void* old = find(name);
    if (!old) return;
    const auto& values = *static_cast<const std::vector<T>*>(old);
    // As many as there happen to be: particles, the parcels of a cloth of cells, and where a sheet is watched for rest (none at first).
    const std::string_view field = name;
    const bool any_number = path == "liquid/" || field.starts_with("parcel_") || field == "calm_place";
    if (!any_number && values.size() != x.size()) misfits.push_back(path + name);
    x = values;
  }
};

// A source goes on where it was. A dropper (or a pipe) whose interval is changed gives next when it would have, or one new
// interval from now, whichever is sooner: never a burst of drops that are overdue by the new interval.
void go_on(const Source& old, Real now, Source& source) {
  source.emitted = old.emitted, source.carried = old.carried, source.supplied_kg = old.supplied_kg;
  if (old.emitted > 0 && source.interval != old.interval) {
    const Real due = old.start + old.emitted * old.interval;
    source.start = std::clamp(due, now, now + source.interval) - old.emitted * source.interval;
  } else {
    source.start = old.emitted > 0 ? old.start : source.start;
  }
}

// A pipe runs to its end in time, with however many particles at its rate from now on.
void go_on_to_its_end(const PipeSpec& pipe, Real duration, Source& source) {
  const Real end = std::min(pipe.stop.value_or(duration), duration), due = source.start + source.emitted * source.interval;
  const Real more = std::floor((end - due) / source.interval + 1e-9) + 1;
  source.count = static_cast<int>(std::clamp<Real>(source.emitted + more, source.emitted, std::numeric_limits<int>::max()));
}

void carry_sources(const Scene& before, const World& running, const Scene& after, World& next) {
  const std::size_t first_pipe = next.sources.size() - after.liquid.pipes.size();
  for (std::size_t i = 0; i < next.sources.size(); ++i) {
    const std::string key = key_of_source(after, i);
    for (std::size_t k = 0; k < running.sources.size(); ++k) {
      if (key_of_source(before, k) != key) continue;
      go_on(running.sources[k], running.time, next.sources[i]);
      if (i >= first_pipe) go_on_to_its_end(after.liquid.pipes[i - first_pipe], after.duration, next.sources[i]);
    }
  }
}

// What the new materials cannot hold goes to the faces.
void expel(Textile& textile) {
  const WettingModel& model = *textile.model;
  for (std::size_t s = 0; s < model.segments; ++s) {
    const YarnWetting& yarn = model.yarns[model.segment_type[s]];
    const Real most = yarn.swelling_regain * model.dry_mass(s);
    Real& sorbed = textile.contents.sorbed_kg[s];
    if (sorbed > most) textile.exchange.waiting_kg[s] += sorbed - most, sorbed = most;
    if (!yarn.wets) textile.exchange.waiting_kg[s] += textile.contents.liquid_kg[s], textile.contents.liquid_kg[s] = 0;
  }
}

// Fibres without liquid are conditioned to a regain that is given anew; the air gives or takes the water.
void condition(const Scene& before, const Scene& after, World& next) {
  for (std::size_t i = 0, index = 0; i < after.textiles.size(); ++i) {
    const TextileSpec& spec = after.textiles[i];
    if (spec.wetting.is_cells()) continue;
    Textile& textile = next.textiles[index++];
    if (!spec.regain || spec.regain == before.textiles.at(i).regain) continue;
    next.ledger.evaporated_kg -=
        condition_dry_fibres(*textile.model, textile.contents, humidity_in_balance(*textile.model, *spec.regain));
  }
}

World carried_world(const Scene& before, const World& running, const Scene& after, const Library& library) {
  const RunningWorld from{before, running, [&](World& next) { carry_sources(before, running, after, next); }};
  World next = build_world(after, library, &from);
  Fields fields;
  visit_state(fields, running);
  Carry carry{fields};
  visit_state(carry, next);
  if (next.textiles.size() != running.textiles.size() || !carry.misfits.empty())
    throw InputError(fmt::format("this does not fit the running state ({}): it takes effect at a restart",
                                 carry.misfits.empty() ? "number of textiles" : carry.misfits.front()));
  for (Textile& textile : next.textiles) expel(textile);
  condition(before, after, next);
  // Whatever rested may move now, and the next textile steps are short again.
  const auto wake = [](SoftSheet& soft) { soft.at_rest = false, soft.calm_s = 0; };
  for (CellCloth& cloth : next.cell_cloths) wake(cloth.soft);
  for (Textile& textile : next.textiles)
    if (textile.cloth) wake(textile.cloth->soft);
  next.pace.resting = false;
  next.pace.calm_since = -1;
  next.pace.wetting_interval = Pace{}.wetting_interval;
  return next;
}

}  // namespace

Effect effect_of(const std::string& path) {
  const auto in = [&](const auto& list) {
    return std::any_of(list.begin(), list.end(), [&](const char* pattern) { return matches(path, pattern); });
  };
  return in(never_live) ? Effect::never : in(only_at_restart) ? Effect::restart : Effect::next_step;
}

Scene changed_scene(const Scene& scene, const std::vector<std::string>& assignments) {
  std::vector<Problem> problems;
  for (const std::string& assignment : assignments) {
    const std::string path = assignment.substr(0, assignment.find('='));
    const bool appends = path == fmt::format("liquid.drops[{}]", scene.liquid.drops.size());
    const Effect effect = effect_of(path);
    if (effect != Effect::next_step && !appends)
      problems.push_back({.key = path, .message = effect == Effect::restart
                                                      ? "takes effect at a restart, not while the simulation runs"
                                                      : "is of files and pictures: the simulation does not follow it"});
  }
  if (!problems.empty()) throw InputError(std::move(problems));
  return read_scene_text(write_scene(scene), "the running scene", assignments);
}

void apply_change(Scene& scene, World& world, const Library& library, Scene changed) {
  World next = carried_world(scene, world, changed, library);
  scene = std::move(changed);
  world = std::move(next);
}

void apply_change(Scene& scene, World& world, const Library& library, const std::vector<std::string>& assignments) {
  apply_change(scene, world, library, changed_scene(scene, assignments));
}

std::string change_line(const LoggedChange& change) {
  Json line;
  line["step"] = change.step;
  line["time_s"] = change.time_s;
  if (change.end) line["end"] = true;
  else line["set"] = change.assignments;
  return line.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::vector<LoggedChange> read_changes(const std::filesystem::path& file) {
  const std::string text = read_whole_file(file);
  std::vector<LoggedChange> changes;
  std::vector<Problem> problems;
  int number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    begin = end + 1, ++number;
    if (line.empty()) continue;
    const auto problem = [&](const char* message) {
      problems.push_back({.file = file.string(), .line = number, .column = 1, .message = message});
    };
    const Json json = Json::parse(line, nullptr, false);
    if (!json.is_object() || !json.contains("step") || !json["step"].is_number_unsigned()) {
      problem("wants {\"step\": number, \"time_s\": number, \"set\": [\"path=value\", ...]}");
      continue;
    }
    LoggedChange change;
    change.step = json["step"].get<std::uint64_t>();
    if (json.contains("time_s") && json["time_s"].is_number()) change.time_s = json["time_s"].get<Real>();
    change.end = json.contains("end") && json["end"] == true;
    if (json.contains("set") && json["set"].is_array()) {
      for (const Json& item : json["set"])
        if (item.is_string()) change.assignments.push_back(item.get<std::string>());
    }
    if (!change.end && change.assignments.empty()) problem("changes nothing: wants \"set\": [\"path=value\", ...]");
    if (!changes.empty() && change.step < changes.back().step) problem("the step is before that of the line above");
    changes.push_back(std::move(change));
  }
  if (!problems.empty()) throw InputError(std::move(problems));
  return changes;
}

bool ChangeReplay::apply_due(Scene& scene, World& world, const Library& library, Real& until) {
  bool changed = false;
  for (; next_ < changes_.size() && changes_[next_].step <= world.step; ++next_) {
    const LoggedChange& change = changes_[next_];
    if (change.step < world.step)
      throw InputError(fmt::format("the change of step {} comes too late: the run is at step {}", change.step, world.step));
    if (change.end) {
      ended_ = true;
    } else {
      apply_change(scene, world, library, change.assignments);
      changed = true;
    }
  }
  if (changed) until = scene.duration;
  return changed;
}

}  // namespace imbibe
