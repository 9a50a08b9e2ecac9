#include "imbibe/live/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "imbibe/scene/builder.h"
#include "imbibe/sim/measures.h"

namespace imbibe::live {

using Json = nlohmann::json;

namespace {
constexpr Real longest_lead = 0.05;       // s of wall time at the speed limit that one swatch may be ahead of the other
constexpr Real forgiven_lag = 0.25;       // s: a simulation slower than the limit does not save up to run faster later
constexpr std::size_t most_commands = 4096;  // waiting; what comes on top is dropped and told

std::vector<std::vector<Real>> saturations_of(const World& world) {
  std::vector<std::vector<Real>> all;
  for (const Textile& textile : world.textiles) all.push_back(node_saturations(textile, world.air));
  return all;
}
}  // namespace

Session::Session(SessionSetup setup, std::function<void()> wake) : Feed(std::move(wake)), setup_(std::move(setup)) {
  scene_ = setup_.scene;
  pin_output_interval(scene_);
  world_ = build_world(scene_, *setup_.library);
  running_ = !setup_.wait_for_viewer;
  begin();
  thread_ = std::thread([this] { thread(); });
}

Session::~Session() {
  {
    const std::scoped_lock hold(lock_);
    quit_asked_ = true;
  }
  woken_.notify_one();
  thread_.join();
}

void Session::keep_pace_with(std::shared_ptr<const std::atomic<Real>> other) {
  const std::scoped_lock hold(lock_);
  other_time_ = std::move(other);
}

void Session::post(Command command) {
  command.arrived_at_step = steps_made_.load(std::memory_order_relaxed);
  {
    const std::scoped_lock hold(lock_);
    if (commands_.size() >= most_commands) return outlet.tell(command.viewer, error_event(setup_.swatch, "busy", "too many commands are waiting"));
    commands_.push_back(std::move(command));
  }
  woken_.notify_one();
}

std::string Session::scene_text() const {
  const std::scoped_lock hold(lock_);
  return scene_text_;
}

std::string Session::history_json() const {
  History rows;
  {
    const std::scoped_lock hold(lock_);
    rows = history_;
  }
  return rows.json();
}

void Session::begin() {
  ++generation_;
  start_scene_ = scene_;
  ended_ = failed_ = false;
  steps_left_ = 0;
  report_ = {};
  last_ = nullptr;
  emit_due(world_);  // as run() does: drops that hang there at the start are seen before the first step
  recorder_.reset();
  recorder_.emplace(setup_.record, scene_, world_);
  begun_ = true;
  rebase();
  time_reached_->store(world_.time);
  steps_made_.store(world_.step);
  speed_time_ = world_.time, speed_wall_ = Clock::now(), speed_ = 0;
  {
    const std::scoped_lock hold(lock_);
    scene_text_ = write_scene(scene_);
    history_.clear();
  }
  outlet.publish(std::make_shared<const Geometry>(take_geometry(
      generation_, scene_, world_, *setup_.library, {setup_.swatch, false, recorder_->folder().string()})));
  publish();
}

void Session::thread() {
  while (!quit_) {
    const RunPlan plan = run_plan(scene_);
    RunHooks hooks;
    hooks.before_step = [this](World& world, Real& until) { return between_steps(world, until); };
    hooks.after_step = [this](const World&, const StepReport& report) { after_step(report); };
    hooks.at_output = [this](const World& world, const StepReport& report) { recorder_->write_output(world, report); };
    hooks.stop_requested = [this] { return stop_; };
    std::string reason = "ended by the user";
    RunStatus status = RunStatus::done;
    try {
      if (!begun_) begin();
      run(world_, plan, hooks);
    } catch (const std::exception& error) {  // numerics, the disk, or our bug: the page says so and may start anew
      reason = error.what(), status = RunStatus::failed;
      wait_after_failure(reason);
    }
    end_recording(status, reason);
    stop_ = false;
    if (!next_) continue;
    scene_ = std::move(next_->first), world_ = std::move(next_->second);
    next_.reset();
    begun_ = false;
  }
}

// Answers the viewers until one of them starts anew. What fails here (a full disk, mostly) is told too: an exception that
// left the thread would end the program.
void Session::wait_after_failure(const std::string& reason) {
  failed_ = true, running_ = false;
  outlet.tell(all_viewers, error_event(setup_.swatch, "simulation", reason));
  told_ = false;
  Real until = world_.time;
  while (!stop_) {
    try {
      between_steps(world_, until);
    } catch (const std::exception& error) {
      outlet.tell(all_viewers, error_event(setup_.swatch, "simulation", error.what()));
    }
  }
}

void Session::end_recording(RunStatus status, const std::string& reason) {
  if (!recorder_) return;  // it could not begin
  try {
    recorder_->finish(world_, status, reason);
  } catch (const std::exception& error) {
    outlet.tell(all_viewers, error_event(setup_.swatch, "run folder", error.what()));
  }
  setup_.record.overwrite = recorder_->untouched();
  if (setup_.record.overwrite) setup_.record.folder = recorder_->folder(), setup_.record.exactly = true;
  else setup_.record.exactly = false;
}

std::uint16_t Session::flags() const {
  return static_cast<std::uint16_t>((running_ ? flag_running : 0) | (ended_ ? flag_ended : 0) |
                                    (world_.pace.resting ? flag_resting : 0) |
                                    (recorder_ && recorder_->recording() ? flag_recording : 0) |
                                    (failed_ ? flag_failed : 0));
}

void Session::publish() {
  const auto saturations = saturations_of(world_);
  auto snapshot = std::make_shared<Snapshot>(take_snapshot(world_, saturations, last_.get()));
  snapshot->generation = generation_, snapshot->number = ++number_, snapshot->flags = flags();
  LiveColumns more;
  more.speed = running_ ? speed_ : 0;
  more.step_bound = step_bound_index(report_.step_bound);
  more.converged = report_.converged;
  snapshot->values = live_values(series_row(world_, report_, scene_.measures), more);
  {
    const std::scoped_lock hold(lock_);
    history_.add(snapshot->values);
  }
  last_ = std::move(snapshot);
  outlet.publish(last_);
  // Steps end when they end: due times that follow each other, not the last snapshot, keep the rate. After a step longer
  // than a frame the next comes sooner.
  const auto every = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<Real>(setup_.snapshot_every));
  publish_due_ = std::max(publish_due_ + every, Clock::now() - every);
  told_ = true;
}

void Session::sample() {
  const Real wall = std::chrono::duration<Real>(Clock::now() - speed_wall_).count();
  if (wall < 0.5) return;
  speed_ = (world_.time - speed_time_) / wall;
  speed_wall_ = Clock::now(), speed_time_ = world_.time;
}

void Session::check_limits() {
  if (static_cast<Real>(world_.liquid.particles.size()) > scene_.limits.max_particles && running_) {
    running_ = false;
    outlet.tell(all_viewers, notice_event(setup_.swatch, fmt::format("paused: {} particles, more than limits.max_particles",
                                                                     world_.liquid.particles.size())));
  }
  if (recorder_ && recorder_->recording() && recorder_->bytes() > scene_.limits.max_disk) {
    recorder_->record(false);
    outlet.tell(all_viewers, notice_event(setup_.swatch, "recording stopped: the run folder holds more than limits.max_disk"));
  }
}

void Session::after_step(const StepReport& report) {
  report_ = report;
  told_ = false;
  time_reached_->store(world_.time, std::memory_order_relaxed);
  steps_made_.store(world_.step, std::memory_order_relaxed);
  if (steps_left_ > 0) --steps_left_;
  sample();
  check_limits();
  if (outlet.viewers.load(std::memory_order_relaxed) > 0 && Clock::now() >= publish_due_) publish();
}

// Whether the clock may go on now; if not, how long to wait for it (a command wakes earlier).
bool Session::may_step(Real& wait_s) {
  wait_s = 1;
  if (steps_left_ > 0) return true;
  if (!running_) return false;
  const Real limit = setup_.speed_limit;
  if (limit > 0) {
    const Real wall = std::chrono::duration<Real>(Clock::now() - pace_wall_).count();
    const Real ahead = (world_.time - pace_time_) / limit - wall;  // s of wall time
    if (ahead < -forgiven_lag) rebase();
    if (ahead > 0) return wait_s = ahead, false;
  }
  std::shared_ptr<const std::atomic<Real>> other;
  {
    const std::scoped_lock hold(lock_);
    other = other_time_;
  }
  if (other && world_.time > other->load(std::memory_order_relaxed) + longest_lead * std::max(limit, 0.1))
    return wait_s = 0.005, false;
  return true;
}

bool Session::between_steps(World& world, Real& until) {
  bool changed = false;
  for (;;) {
    std::deque<Command> todo;
    {
      const std::scoped_lock hold(lock_);
      todo.swap(commands_);
      if (quit_asked_) quit_ = stop_ = true;
    }
    while (!todo.empty() && !stop_) changed = handle_next(todo) || changed;
    if (stop_) {  // what else was asked is for the world to come
      const std::scoped_lock hold(lock_);
      commands_.insert(commands_.begin(), std::make_move_iterator(todo.begin()), std::make_move_iterator(todo.end()));
      return changed;
    }
    until = failed_ ? until : scene_.duration;
    if (world.time < until) ended_ = false;
    const bool at_end = world.time >= until;
    if (at_end && !failed_ && !ended_) ended_ = true, running_ = false, steps_left_ = 0, told_ = false;
    time_reached_->store(running_ || steps_left_ > 0 ? world.time : 1e30, std::memory_order_relaxed);
    Real wait_s = 1;
    if (!at_end && may_step(wait_s)) return changed;
    const bool waits_long = wait_s > setup_.snapshot_every;
    if (!told_ && (waits_long || !running_)) publish();
    std::unique_lock hold(lock_);
    woken_.wait_for(hold, std::chrono::duration<Real>(std::min<Real>(wait_s, 1)),
                    [this] { return !commands_.empty() || quit_asked_; });
  }
}

}  // namespace imbibe::live
