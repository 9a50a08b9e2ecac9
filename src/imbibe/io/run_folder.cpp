#include "imbibe/io/run_folder.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <ctime>
#include <nlohmann/json.hpp>

#include "imbibe/core/error.h"
#include "imbibe/io/machine.h"
#include "imbibe/sim/checkpoint.h"
#include "imbibe/sim/state_hash.h"

namespace imbibe {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

// The first line of a run folder's scene.yaml: tells a scene that a run wrote from a user's own of that name.
const std::string resolved_scene_mark = "# Resolved by Imbibe: every value of the run's scene; runs again.\n";

std::string now_utc() { return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr))); }

const char* name_of(RunStatus status) {
  switch (status) {
    case RunStatus::running: return "running";
    case RunStatus::done: return "done";
    case RunStatus::interrupted: return "interrupted";
    case RunStatus::failed: return "failed";
  }
  return "";
}

// JSON has no NaN or infinity: null says that there is no number.
Json number(Real x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

bool is_numbered(const std::string& name, const std::string& start, const std::string& end) {
  if (name.size() <= start.size() + end.size() || !name.starts_with(start) || !name.ends_with(end)) return false;
  return std::isdigit(static_cast<unsigned char>(name[name.size() - end.size() - 1])) != 0;
}

// A file that a run writes, by its name alone; also its unfinished form.
bool is_name_of_a_run(std::string name) {
  if (name.ends_with(".part")) name.resize(name.size() - 5);
  static const std::vector<std::string> fixed{"scene.yaml", "run.json",   "log.txt",    "series.csv",
                                              "film.mp4",   "report.html", "liquid.pvd", "changes.jsonl"};
  if (std::find(fixed.begin(), fixed.end(), name) != fixed.end()) return true;
  return (name.starts_with("textile_") && name.ends_with(".pvd")) || is_numbered(name, "textile_", ".vtp") ||
         is_numbered(name, "liquid_", ".vtp") || is_numbered(name, "checkpoint_", ".h5");
}

// Copies of the scene's files that an earlier run made, as its run.json says.
std::vector<fs::path> copies_of_earlier_run(const fs::path& folder) {
  std::vector<fs::path> copies;
  if (!fs::exists(folder / "run.json")) return copies;
  const Json run = Json::parse(read_whole_file(folder / "run.json"), nullptr, false);
  if (!run.is_object() || !run.contains("files") || !run["files"].is_array()) return copies;
  for (const Json& name : run["files"]) {
    if (!name.is_string()) continue;
    const fs::path path(name.get<std::string>());
    const bool inside = path.parent_path() == run_files_folder && path.has_filename() && path.filename() != "..";
    if (inside && fs::exists(folder / path)) copies.push_back(folder / path);
  }
  return copies;
}

void remove_earlier_run(const fs::path& folder) {
  std::vector<fs::path> old = copies_of_earlier_run(folder);
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (!entry.is_directory() && is_name_of_a_run(entry.path().filename().string())) old.push_back(entry.path());
  }
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder / "pictures", none)) {
    if (is_numbered(entry.path().filename().string(), "picture_", ".png")) old.push_back(entry.path());
  }
  for (const fs::path& path : old) {
    std::error_code error;
    fs::remove(path, error);
    if (error) throw OutputError(path, "cannot remove", error.value());
  }
}

Real bytes_of(const fs::path& file) {
  std::error_code gone;
  const std::uintmax_t bytes = fs::file_size(file, gone);
  return gone ? 0 : static_cast<Real>(bytes);
}

// A scene that a run wrote, rather than a user's own of that name.
bool is_resolved_scene(const fs::path& file) {
  return fs::exists(file) && read_whole_file(file).starts_with(resolved_scene_mark);
}

// A time belongs to the grid of output times, `every` s apart or as the rows so far are.
bool is_output_time(Real time, Real every, const std::vector<Real>& rows) {
  if (every <= 0 && rows.size() < 2) return false;
  const Real intervals = every > 0 ? time / every : (time - rows[0]) / (rows[1] - rows[0]);
  return std::abs(intervals - std::round(intervals)) < 1e-6;
}

}  // namespace

std::string file_name_part(const std::string& name) {
  std::string out = name;
  for (char& c : out) {
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-') c = '_';
  }
  return out.empty() ? "_" : out;
}

std::vector<std::string> collection_stems(const World& world) {
  std::vector<std::string> taken;
  const auto add = [&](const std::string& wanted) {
    std::string stem = wanted;
    for (int i = 2; std::find(taken.begin(), taken.end(), stem) != taken.end(); ++i) {
      stem = fmt::format("{}-{}", wanted, i);
    }
    taken.push_back(stem);
    return stem;
  };
  add("liquid");
  for (const Textile& textile : world.textiles) add(add("textile_" + file_name_part(textile.name)) + "_pores");
  for (const CellCloth& cloth : world.cell_cloths) add("textile_" + file_name_part(cloth.name));
  return taken;
}

RunFolder::RunFolder(fs::path folder, RunSetup setup, ExistingFolder existing, const World& world)
    : folder_(std::move(folder)), setup_(std::move(setup)), started_at_(now_utc()) {
  for (std::string& stem : collection_stems(world)) collections_.push_back({std::move(stem), {}});
  prepare(existing, world);
  if (!setup_.files.empty()) {
    std::error_code error;
    fs::create_directories(folder_ / run_files_folder, error);
    if (error) throw OutputError(folder_ / run_files_folder, "cannot create the folder", error.value());
  }
  for (const auto& [name, contents] : setup_.files) write_whole_file(folder_ / name, contents);
  count_all();
  write_whole_file(folder_ / "scene.yaml", resolved_scene_mark + setup_.scene_yaml);
  write_run_json(world, RunStatus::running, "");
  series_ = SeriesFile(folder_ / "series.csv");
  log_ = AppendFile(folder_ / "log.txt");
  log(fmt::format("{} version {}: {}", existing == ExistingFolder::resume ? "resumed" : "started", IMBIBE_VERSION,
                  setup_.command));
}

void RunFolder::count(const fs::path& written) {
  bytes_ += bytes_of(written);
}

void RunFolder::count_all() {
  bytes_ = 0;
  std::error_code none;
  for (const auto& entry : fs::recursive_directory_iterator(folder_, none)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_regular_file(none) && !is_numbered(name, "checkpoint_", ".h5")) count(entry.path());
  }
  count_checkpoints();
}

void RunFolder::count_checkpoints() {
  checkpoint_bytes_ = 0;
  for (const fs::path& path : list_checkpoints(folder_)) checkpoint_bytes_ += bytes_of(path);
}

void RunFolder::prepare(ExistingFolder existing, const World& world) {
  std::error_code error;
  if (fs::exists(folder_, error) && !fs::is_directory(folder_, error)) {
    throw InputError(folder_.string() + " is a file, not a folder; choose another run folder with -o");
  }
  fs::create_directories(folder_, error);
  if (error) throw OutputError(folder_, "cannot create the run folder", error.value());
  fs::directory_iterator entries(folder_, error);
  if (error) throw OutputError(folder_, "cannot read the run folder", error.value());
  // A run that was killed in its first moments leaves unfinished files only, or its scene but no run.json yet.
  const bool empty = std::all_of(begin(entries), end(entries), [](const fs::directory_entry& entry) {
    return entry.path().extension() == ".part" && is_name_of_a_run(entry.path().filename().string());
  });
  const bool of_a_run = fs::exists(folder_ / "run.json") || is_resolved_scene(folder_ / "scene.yaml");
  switch (existing) {
    case ExistingFolder::refuse:
      if (!empty) {
        throw InputError(fmt::format("run folder {} is not empty: {}choose another with -o", folder_.string(),
                                     of_a_run ? "go on with --resume, replace it with --overwrite, or " : ""));
      }
      break;
    case ExistingFolder::overwrite:
      if (!empty && !of_a_run) {
        throw InputError(folder_.string() + " holds no run, so nothing there is overwritten; choose another with -o");
      }
      remove_earlier_run(folder_);
      break;
    case ExistingFolder::resume:
      if (!of_a_run) throw InputError(folder_.string() + " holds no run to resume");
      continue_run(world);
      break;
  }
}

void RunFolder::continue_run(const World& world) {
  // Rows are compared with a little room: a time is a sum of steps.
  const Real until = world.time * (1 + 1e-12);
  cut_series(folder_ / "series.csv", until);
  std::vector<Real> rows;
  if (fs::exists(folder_ / "series.csv")) rows = read_series(folder_ / "series.csv").column("time_s");
  outputs_ = static_cast<int>(rows.size());
  const bool written = !rows.empty() && rows.back() >= world.time * (1 - 1e-12);
  if (written || !is_output_time(world.time, setup_.every_s, rows)) skip_until_ = until;
  if (rows.empty()) skip_until_.reset();
  for (Collection& collection : collections_) {
    collection.entries = read_pvd(folder_ / (collection.stem + ".pvd"));
    std::erase_if(collection.entries, [&](const PvdEntry& entry) { return entry.time_s > until; });
  }
  // A later checkpoint that could not be read would only stand in the way of the next ones.
  for (const fs::path& path : list_checkpoints(folder_)) {
    if (path.filename().string() > fmt::format("checkpoint_{:09}.h5", world.step)) {
      std::error_code ignored;
      fs::remove(path, ignored);
    }
  }
  // So are files and pictures of later outputs: they come again, or belong to a run that is no more.
  remove_later_outputs();
  if (!fs::exists(folder_ / "run.json")) return;
  const Json earlier = Json::parse(read_whole_file(folder_ / "run.json"), nullptr, false);
  if (earlier.is_object()) {
    earlier_wall_s_ = earlier.value("wall_s", 0.0);
    started_at_ = earlier.value("started_at", started_at_);
  }
}

void RunFolder::remove_later_outputs() {
  std::vector<fs::path> later;
  std::error_code none;
  for (const fs::path& folder : {folder_, folder_ / "pictures"}) {  // half written when the run was killed
    for (const auto& entry : fs::directory_iterator(folder, none)) {
      if (entry.path().extension() == ".part" && entry.is_regular_file(none)) later.push_back(entry.path());
    }
  }
  for (const Collection& collection : collections_) {
    for (int i = outputs_;; ++i) {
      const fs::path path = folder_ / fmt::format("{}_{:06}.vtp", collection.stem, i);
      if (!fs::exists(path, none)) break;
      later.push_back(path);
    }
  }
  for (int i = outputs_;; ++i) {
    const fs::path path = folder_ / "pictures" / fmt::format("picture_{:06}.png", i);
    if (!fs::exists(path, none)) break;
    later.push_back(path);
  }
  for (const fs::path& path : later) fs::remove(path, none);
}

Real RunFolder::wall_s() const {
  return earlier_wall_s_ + std::chrono::duration<Real>(std::chrono::steady_clock::now() - started_).count();
}

void RunFolder::write_frame(Collection& collection, const PolyData& data, const World& world) {
  const std::string file = fmt::format("{}_{:06}.vtp", collection.stem, outputs_);
  write_vtp(folder_ / file, data, {world.time, world.step});
  count(folder_ / file);
  // Listed only now that it is there; an entry of the same number is of a run that stopped in between.
  std::erase_if(collection.entries, [&](const PvdEntry& entry) { return entry.file == file; });
  collection.entries.push_back({world.time, file});
  write_pvd(folder_ / (collection.stem + ".pvd"), collection.entries);
}

bool RunFolder::write_output(const World& world, const StepReport& last_step) {
  if (skip_until_ && world.time <= *skip_until_) return false;
  if (with_files_ && setup_.particle_files) write_frame(collections_[0], liquid_poly_data(world.liquid, hanging_liquid(world)), world);
  if (with_files_ && setup_.textile_files) {
    for (std::size_t i = 0; i < world.textiles.size(); ++i) {
      const std::vector<Real> saturations = node_saturations(world.textiles[i], world.air);
      write_frame(collections_[1 + 2 * i], textile_poly_data(world.textiles[i], saturations), world);
      write_frame(collections_[2 + 2 * i], pore_poly_data(world.textiles[i], saturations), world);
    }
    for (std::size_t i = 0; i < world.cell_cloths.size(); ++i)
      write_frame(collections_[1 + 2 * world.textiles.size() + i], cell_cloth_poly_data(world.cell_cloths[i]), world);
  }
  series_.write(series_row(world, last_step, setup_.measures));
  ++outputs_;
  // Replacing a file waits for the disk on common file systems (15 ms per output were measured with all of them), and
  // nobody reads this one more than once a second.
  if (wall_s() - run_json_wall_s_ > 1) write_run_json(world, RunStatus::running, "");
  return true;
}

void RunFolder::write_checkpoint(const World& world) {
  const fs::path path = save_checkpoint(folder_, world);
  count_checkpoints();
  log(fmt::format("checkpoint {} at t = {:.6g} s, step {}", path.filename().string(), world.time, world.step));
}

void RunFolder::log(const std::string& line) {
  log_.append(fmt::format("{} {:9.2f} s  {}\n", now_utc(), wall_s(), line));
}

void RunFolder::finish(const World& world, RunStatus status, const std::string& reason) {
  write_run_json(world, status, reason);
  log(fmt::format("{} at t = {:.6g} s, step {}, state {}{}{}", name_of(status), world.time, world.step,
                  state_hash_text(world), reason.empty() ? "" : ": ", reason));
}

void RunFolder::write_run_json(const World& world, RunStatus status, const std::string& reason) {
  Json out;
  out["program"] = "imbibe";
  out["version"] = IMBIBE_VERSION;
  out["title"] = setup_.title;
  out["command"] = setup_.command;
  out["status"] = name_of(status);
  if (!reason.empty()) out["reason"] = reason;
  out["started_at"] = started_at_;
  out["updated_at"] = now_utc();
  out["wall_s"] = wall_s();
  out["time_s"] = number(world.time);
  out["until_s"] = number(setup_.until_s);
  out["steps"] = world.step;
  out["outputs"] = outputs_;
  out["particles"] = world.liquid.particles.size();
  out["seed"] = setup_.seed;
  out["threads"] = setup_.threads;
  out["state_hash"] = state_hash_text(world);
  const Machine machine = this_machine();
  out["machine"] = {{"processor", machine.processor},
                    {"cores", machine.cores},
                    {"memory_bytes", machine.memory_bytes},
                    {"system", machine.system},
                    {"compiler", machine.compiler}};
  const MassBalance m = mass_balance(world);
  out["ledger"] = {{"initial_kg", number(m.initial)}, {"supplied_kg", number(m.supplied)},
                   {"free_kg", number(m.free)},       {"sorbed_kg", number(m.sorbed)},
                   {"yarn_kg", number(m.yarn)},       {"pore_kg", number(m.pore)},
                   {"cell_kg", number(m.cell)},       {"evaporated_kg", number(m.evaporated)},
                   {"left_kg", number(m.left)},       {"ledger_error", number(m.error())}};
  out["wet_saturation"] = number(setup_.measures.wet_saturation);
  out["liquid"] = {{"name", world.liquid.kind.name},
                   {"density_kg_m3", number(world.liquid.kind.density)},
                   {"viscosity_Pa_s", number(world.liquid.kind.viscosity)},
                   {"surface_tension_N_m", number(world.liquid.kind.surface_tension)},
                   {"particle_mass_kg", number(world.liquid.particle_mass)}};
  out["fabrics"] = Json::array();
  for (const auto& [name, text] : setup_.fabrics) out["fabrics"].push_back({{"name", name}, {"numbers", text}});
  out["files"] = Json::array();
  for (const auto& [name, contents] : setup_.files) out["files"].push_back(name);
  out["notes"] = notes_;
  // Texts come from the user's files: what is not UTF-8 is replaced rather than refused.
  write_whole_file(folder_ / "run.json", out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  run_json_wall_s_ = wall_s();
}

}  // namespace imbibe
