// imbibe run: simulates a scene into a run folder, with pictures, film and report.
#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

#include "apps/commands.h"
#include "imbibe/core/error.h"
#include "imbibe/core/output_file.h"
#include "imbibe/core/parallel.h"
#include "imbibe/core/quantity.h"
#include "imbibe/io/background_writer.h"
#include "imbibe/io/machine.h"
#include "imbibe/io/progress.h"
#include "imbibe/io/report.h"
#include "imbibe/io/run_folder.h"
#include "imbibe/live/recorder.h"
#include "imbibe/scene/builder.h"
#include "imbibe/scene/library.h"
#include "imbibe/scene/live_change.h"
#include "imbibe/scene/scene.h"
#include "imbibe/sim/checkpoint.h"
#include "imbibe/sim/mechanism.h"
#include "imbibe/sim/run.h"
#include "imbibe/view/frame_from_world.h"
#include "imbibe/view/run_frames.h"
#include "imbibe/view/run_pictures.h"

namespace fs = std::filesystem;
using namespace imbibe;

namespace {

volatile std::sig_atomic_t stop_signal = 0;  // the one global: a signal handler can reach nothing else
void on_signal(int number) { stop_signal = number; }

struct RunArguments {
  std::string scene;
  std::string output;
  std::string changes;
  std::vector<std::string> overrides;
  std::string until;  // a time, with a unit or in s
  int threads = 0;
  bool resume = false, overwrite = false, no_pictures = false;
  std::string progress = "auto";
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

Real until_of(const std::string& text) {
  Real until = 0;
  try {
    until = parse_quantity(text, "s");
  } catch (const QuantityError& e) {
    throw InputError(fmt::format("--until: {}", e.what()));
  }
  if (!(until > 0)) throw InputError(fmt::format("--until: {} is not a time after the start", text));
  return until;
}

ProgressStyle progress_style(const std::string& wanted) {
  if (wanted == "json") return ProgressStyle::json;
  if (wanted == "lines") return ProgressStyle::lines;
  return isatty(STDERR_FILENO) ? ProgressStyle::terminal : ProgressStyle::lines;
}

Progress progress_of(const World& world, const StepReport& report, Real until, Real wall) {
  const MassBalance b = mass_balance(world);
  Progress p;
  p.time_s = world.time, p.until_s = until, p.wall_s = wall;
  p.step_s = report.step_s, p.step_bound = report.step_bound;
  p.free_kg = b.free, p.absorbed_kg = b.sorbed + b.yarn + b.pore + b.cell - b.initial, p.evaporated_kg = b.evaporated;
  p.ledger_error = b.error();
  p.steps = world.step, p.particles = world.liquid.particles.size();
  return p;
}

// Everything a run has open at once, so that each way out can save and close it.
class RunSession {
 public:
  RunSession(const RunArguments& arguments, const CommandContext& context)
      : arguments_(arguments), program_(context.program), scene_file_(arguments.scene) {
    if (arguments.resume && fs::is_directory(scene_file_)) folder_path_ = scene_file_, scene_file_ /= "scene.yaml";
    if (arguments.resume && folder_path_.empty() && arguments.output.empty())
      throw InputError("--resume wants the folder of the run: run FOLDER --resume");
    if (!folder_path_.empty() && !fs::exists(scene_file_))
      throw InputError(fmt::format("{} holds no scene.yaml: nothing of a run is there yet to resume; start it with run "
                                   "SCENE -o {}", folder_path_.string(), folder_path_.string()));
    scene_ = read_scene(scene_file_, arguments.overrides);
    if (!arguments.until.empty()) scene_.duration = until_of(arguments.until);
    if (!arguments.output.empty()) folder_path_ = arguments.output;
    // A rerun never touches an earlier result.
    if (folder_path_.empty()) folder_path_ = live::free_folder(fs::path("runs") / scene_file_.stem());
    if (!arguments.changes.empty()) changes_.emplace(read_changes(arguments.changes));
    library_ = read_library(library_folders(scene_file_, context.data_folders));
    world_ = build_world(scene_, library_);
    warn_of_little_space();
    const bool with_pictures = scene_.output.pictures && !arguments.no_pictures;
    std::optional<Stage> stage;  // of a resumed run: that of its first picture
    if (arguments.resume) {
      if (with_pictures) stage = first_stage();
      resume();
    }
    folder_ = std::make_unique<RunFolder>(folder_path_, live::run_setup(scene_, world_, context.command_line),
                                          arguments.resume      ? ExistingFolder::resume
                                          : arguments.overwrite ? ExistingFolder::overwrite
                                                                : ExistingFolder::refuse,
                                          world_);
    if (with_pictures) {
      pictures_ = std::make_unique<RunPictures>(folder_path_, scene_.picture, std::move(stage));
      pictures_->take_up(folder_->outputs());
    }
  }

  int go() {
    ProgressWriter progress(std::cerr, progress_style(arguments_.progress));
    RunPlan plan = run_plan(scene_);
    RunHooks hooks;
    hooks.at_output = [&](const World& world, const StepReport& report) { write(world, report); };
    hooks.after_step = [&](const World& world, const StepReport& report) {
      liquid_s_ += report.liquid_wall_s, wetting_s_ += report.wetting_wall_s;
      moved_ += report.liquid_moved, wetted_ += report.wetting_ran;
      contact_ += report.contact;
      progress.show(progress_of(world, report, plan.until, seconds_since(started_)));
      check_particles(world);
      check_memory(world);
      // At an output time the output comes first: its row holds numbers of this step, which a checkpoint does not keep.
      if (!is_output_time(world)) checkpoint_when_due(world);
    };
    if (changes_) {
      hooks.before_step = [&](World& world, Real& until) {
        const bool changed = changes_->apply_due(scene_, world, library_, until);
        plan.until = until;
        return changed;
      };
    }
    hooks.stop_requested = [&] { return stop_signal != 0 || (changes_ && changes_->ended()); };
    try {
      RunEnd end = run_and_write(plan, hooks);
      if (changes_ && changes_->ended()) end = RunEnd::finished;
      progress.finish();
      folder_->write_checkpoint(world_);
      close(end == RunEnd::finished ? RunStatus::done : RunStatus::interrupted,
            end == RunEnd::finished ? "" : "stopped by a signal");
      return end == RunEnd::finished ? 0 : 130;
    } catch (const NumericalError& error) {
      progress.finish();
      try {
        keep_last_good_state();
      } catch (const std::exception& why) {
        std::fprintf(stderr, "the last good state could not be kept: %s\n", why.what());
      }
      close(RunStatus::failed, error.what());
      throw;
    } catch (const OutputError& error) {  // a full disk, a vanished folder
      return fail(progress, error.what());
    } catch (const InputError& error) {  // a limit of the scene: what there is stays, and can go on with a higher one
      progress.finish();
      std::fprintf(stderr, "%s\n", error.what());
      folder_->write_checkpoint(world_);
      close(RunStatus::failed, error.problems().front().message);
      return 1;
    } catch (const std::exception& error) {  // out of memory, or our own bug: the last checkpoint stays as it is
      progress.finish();
      close_quietly(error.what());
      throw;
    }
  }

 private:
  // Runs with the writing beside it; returns or throws when all that was to be written is.
  RunEnd run_and_write(const RunPlan& plan, const RunHooks& hooks) {
    try {
      const RunEnd end = run(world_, plan, hooks);
      const auto start = std::chrono::steady_clock::now();
      writer_.finish();
      finishing_s_ = seconds_since(start);
      return end;
    } catch (const OutputError&) {
      writer_.abandon();
      throw;
    } catch (...) {
      try {
        writer_.finish();
      } catch (const std::exception& lost) {  // the run's own error says more
        std::fprintf(stderr, "not all was written: %s\n", lost.what());
      }
      throw;
    }
  }

  // The estimate is of the most that the run can write, so it is no reason to refuse.
  void warn_of_little_space() const {
    const double wanted = estimate_scene(scene_, world_.liquid.kind).disk_bytes, there = free_space(folder_path_);
    if (wanted > there)
      std::fprintf(stderr, "warning: the run may write up to %.3g GB, the disk of %s has %.3g GB left\n", wanted / 1e9,
                   folder_path_.c_str(), there / 1e9);
  }

  // world_ is half-way through a step that failed. Every step gives the same bits again, so the state before it is made
  // from the newest checkpoint (or from the start): at most a checkpoint's interval of work, and no second copy of the
  // world while all goes well.
  void keep_last_good_state() {
    if (changes_) return;  // a log of changes reruns from the start only
    const std::uint64_t last = world_.step;
    world_ = World{};  // the room of one world is enough
    world_ = build_world(scene_, library_);
    const auto from = read_newest_checkpoint(folder_path_, world_);
    if (last > world_.step)
      std::fprintf(stderr, "making the last good state again: %llu steps from %s\n",
                   static_cast<unsigned long long>(last - world_.step),
                   from ? from->filename().c_str() : "the start");
    if (!remake(world_, last, run_plan(scene_), [] { return stop_signal != 0; })) return;
    folder_->write_checkpoint(world_);
    std::fprintf(stderr, "the state after step %llu, t = %.6g s, is kept as a checkpoint\n",
                 static_cast<unsigned long long>(world_.step), world_.time);
  }

  void resume() {
    std::vector<std::string> passed_over;
    const auto from = read_newest_checkpoint(folder_path_, world_, &passed_over);
    for (const std::string& damaged : passed_over) std::fprintf(stderr, "passed over: %s\n", damaged.c_str());
    if (from) std::fprintf(stderr, "resuming from %s at t = %.6g s\n", from->c_str(), world_.time);
    else std::fprintf(stderr, "%s has no checkpoint yet: starting from the beginning\n", folder_path_.c_str());
  }

  // Where the pictures so far are seen from; nothing when the run has no file to say so.
  std::optional<Stage> first_stage() const {
    if (read_pvd(folder_path_ / "liquid.pvd").empty()) return {};
    return stage_for(read_frame(open_run_frames(folder_path_, world_, scene_.title), 0), scene_.picture);
  }

  // Hands a copy of the world to the writer: the run goes on while files and pictures are made.
  void write(const World& world, const StepReport& report) {
    const auto start = std::chrono::steady_clock::now();
    const bool checkpoint = world.step > 0 && checkpoint_due();
    writer_.post([this, report, checkpoint, copy = std::make_shared<const World>(world), title = scene_.title,
                  most = scene_.limits.max_disk] {  // a replayed log may change the scene meanwhile
      const bool written = folder_->write_output(*copy, report);
      // The state a resumed run starts from may be in the film already, or lie between two output times.
      const int number = folder_->outputs() - 1;
      if (pictures_ && (written || !fs::exists(folder_path_ / "pictures" / fmt::format("picture_{:06}.png", number))))
        folder_->count(pictures_->add(frame_from_world(*copy, title), number));
      if (checkpoint) folder_->write_checkpoint(*copy);
      check_disk(*copy, most);
    }, is_large());
    waited_s_ += seconds_since(start);
  }

  // Copies that wait for their pictures may make a run a few times as large: not one that fills a laptop by itself.
  static bool is_large() {
    constexpr double a_gigabyte = 1e9;
    return memory_in_use() > a_gigabyte;
  }

  bool is_output_time(const World& world) const {
    const Real intervals = world.time / output_interval(scene_);
    return world.time >= scene_.duration || std::abs(intervals - std::round(intervals)) < 1e-6;
  }

  bool checkpoint_due() {
    if (seconds_since(last_checkpoint_) < scene_.output.checkpoint_every.value_or(60)) return false;
    last_checkpoint_ = std::chrono::steady_clock::now();
    return true;
  }

  void checkpoint_when_due(const World& world) {
    if (!checkpoint_due()) return;
    const auto start = std::chrono::steady_clock::now();
    writer_.post([this, copy = std::make_shared<const World>(world)] { folder_->write_checkpoint(*copy); },
                 is_large());
    waited_s_ += seconds_since(start);
  }

  void check_disk(const World& world, Real most) const {
    if (folder_->bytes() <= most) return;
    throw InputError(fmt::format(
        "stopped at t = {:.6g} s: the run folder holds {:.4g} MB, more than limits.max_disk = {:.4g} MB; "
        "go on with --resume --set limits.max_disk='{:.4g} MB'",
        world.time, folder_->bytes() / 1e6, most / 1e6, std::ceil(2 * folder_->bytes() / 1e6)));
  }

  void check_particles(const World& world) const {
    if (static_cast<Real>(world.liquid.particles.size()) <= scene_.limits.max_particles) return;
    throw InputError(fmt::format("stopped at t = {:.6g} s: {} particles, more than limits.max_particles = {:.6g}",
                                 world.time, world.liquid.particles.size(), scene_.limits.max_particles));
  }

  // Looked at once a second: what the estimate before the run did not foresee must not take the machine down.
  void check_memory(const World& world) {
    if (seconds_since(memory_looked_at_) < 1) return;
    memory_looked_at_ = std::chrono::steady_clock::now();
    const Real used = memory_in_use(), most = allowed_memory(scene_);
    if (used <= most) return;
    throw InputError(fmt::format(
        "stopped at t = {:.6g} s: the run holds {:.4g} GB of memory, more than {} {:.4g} GB; a coarser "
        "liquid.particle_mass or a smaller textile needs less",
        world.time, used / 1e9, scene_.limits.max_memory ? "limits.max_memory =" : "80 % of this machine's,", most / 1e9));
  }

  void close(RunStatus status, const std::string& reason) {
    for (const std::string& sentence : explain_uptake(world_)) folder_->note(sentence);
    folder_->finish(world_, status, reason);
    const FilmResult film = pictures_ ? pictures_->finish() : FilmResult{false, "no pictures were asked for"};
    const fs::path report = write_report(folder_path_);
    std::printf("%s after %.1f s of wall time\n", status == RunStatus::done ? "done" : reason.c_str(),
                seconds_since(started_));
    std::printf("  of it       liquid %.1f s (%llu steps), network %.1f s (%llu steps), waiting for output %.1f s\n", liquid_s_,
                static_cast<unsigned long long>(moved_), wetting_s_, static_cast<unsigned long long>(wetted_), waited_s_);
    std::printf("  beside it   files and pictures %.1f s, of it %.1f s after the last step\n", writer_.working_s(), finishing_s_);
    if (moved_ > 0)
      std::printf("  liquid      density error %.2g %% (mean), %.2g %% in the worst step, of it compression %.2g %%; of one particle up to %.2g %%\n",
                  100 * world_.density.mean(), 100 * world_.density.worst_mean, 100 * world_.density.mean_compression(),
                  100 * world_.density.worst_particle);
    if (contact_.textile_boxes > 0)
      std::printf("  contact     boxes tested: %llu of textiles, %llu of yarns, %llu of segments; %llu pieces, %llu triangles\n",
                  static_cast<unsigned long long>(contact_.textile_boxes),
                  static_cast<unsigned long long>(contact_.yarn_boxes),
                  static_cast<unsigned long long>(contact_.segment_boxes),
                  static_cast<unsigned long long>(contact_.pieces), static_cast<unsigned long long>(contact_.triangles));
    std::printf("  run folder  %s\n  report      %s\n", folder_path_.c_str(), report.c_str());
    if (pictures_) std::printf("  pictures    %s\n", (folder_path_ / "pictures").c_str());
    std::printf("  film        %s\n", film.message.c_str());
    std::printf("  ParaView    %s (and textile_*.pvd)\n", (folder_path_ / "liquid.pvd").c_str());
    if (status == RunStatus::interrupted)
      std::printf("  go on with  %s run %s --resume\n", program_.c_str(), folder_path_.c_str());
  }

  int fail(ProgressWriter& progress, const char* reason) {
    progress.finish();
    std::fprintf(stderr, "error: %s\n", reason);
    close_quietly(reason);
    return 1;
  }

  // The disk may be full: what can be said is said, what cannot be written stays as it last was.
  void close_quietly(const std::string& reason) {
    try {
      folder_->finish(world_, RunStatus::failed, reason);
    } catch (const std::exception&) {
    }
  }

  RunArguments arguments_;
  std::string program_;
  fs::path scene_file_, folder_path_;
  Scene scene_;
  Library library_;
  World world_;
  std::optional<ChangeReplay> changes_;
  std::unique_ptr<RunFolder> folder_;
  std::unique_ptr<RunPictures> pictures_;
  double liquid_s_ = 0, wetting_s_ = 0, waited_s_ = 0, finishing_s_ = 0;
  std::uint64_t moved_ = 0, wetted_ = 0;
  ContactCounts contact_;
  std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now(), last_checkpoint_ = started_,
                                        memory_looked_at_ = started_;
  BackgroundWriter writer_;  // last: its thread uses what is above
};

}  // namespace

void add_run_command(CLI::App& app, CommandContext& context) {
  auto arguments = std::make_shared<RunArguments>();
  CLI::App* command = app.add_subcommand("run", "simulate a scene into a run folder");
  command->add_option("scene", arguments->scene, "scene file; with --resume also a run folder")->required();
  CLI::Option* resume =
      command->add_flag("--resume", arguments->resume, "go on from the newest checkpoint of the run folder");
  command->add_option("-o,--output", arguments->output, "run folder; default runs/<scene>, numbered when taken");
  command->add_option("--set", arguments->overrides, "path=value: change a key of the scene")->allow_extra_args(false);
  command
      ->add_option("--changes", arguments->changes,
                   "changes.jsonl of a live run: makes the same changes at the same steps, and ends where it ended")
      ->excludes(resume);
  command->add_option("--until", arguments->until,
                      "simulated time (\"90 s\", \"2 min\"; bare: seconds), in place of the scene's duration");
  command->add_option("--threads", arguments->threads, "0 = all cores; results do not depend on it")
      ->check(CLI::Range(0, 1024));
  command->add_flag("--overwrite", arguments->overwrite, "replace an earlier run in the folder given with -o");
  command->add_flag("--no-pictures", arguments->no_pictures, "no pictures and no film");
  command->add_option("--progress", arguments->progress, "auto | lines | json")
      ->check(CLI::IsMember({"auto", "lines", "json"}));
  command->callback([arguments, &context] {
    std::signal(SIGINT, on_signal);
    std::signal(SIGTERM, on_signal);
    std::signal(SIGPIPE, SIG_IGN);  // a film encoder that dies is an error return
    std::signal(SIGXFSZ, SIG_IGN);  // so is a file that may not grow
    std::unique_ptr<ThreadLimit> limit;
    if (arguments->threads > 0) limit = std::make_unique<ThreadLimit>(arguments->threads);
    context.exit_code = RunSession(*arguments, context).go();
  });
}
