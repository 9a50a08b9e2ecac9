// A simulation with viewers: steps a World by sim/run.h in a thread of its own, takes commands between steps, logs every
// change (scene/live_change.h), and publishes snapshots at the viewers' rate. The run itself is that of `imbibe run`:
// same step sizes, same output times, so that the log reruns it bit for bit.
// Tested with the page, in viewer/test/live.test.mjs.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "imbibe/live/capture.h"
#include "imbibe/live/feed.h"
#include "imbibe/live/gallery.h"
#include "imbibe/live/history.h"
#include "imbibe/live/recorder.h"
#include "imbibe/scene/library.h"
#include "imbibe/sim/run.h"

namespace imbibe::live {

struct SessionSetup {
  int swatch = 0;
  Scene scene;
  std::shared_ptr<const Library> library;
  std::shared_ptr<const Gallery> gallery;
  RecorderOptions record;
  bool wait_for_viewer = true;  // the clock starts when the first page is there
  Real speed_limit = 1;         // simulated per wall-clock second, 0 = none
  Real snapshot_every = 1.0 / 30;  // s of wall time
};

class Session final : public Feed {
 public:
  // Builds the world: throws InputError as `imbibe run` would. Then runs until it is destroyed.
  Session(SessionSetup setup, std::function<void()> wake);
  ~Session() override;

  void post(Command command) override;
  std::string scene_text() const override;
  std::string history_json() const override;
  // Another swatch that this one keeps step with (compare): neither runs ahead of the other.
  void keep_pace_with(std::shared_ptr<const std::atomic<Real>> other);
  std::shared_ptr<const std::atomic<Real>> time_reached() const { return time_reached_; }

  struct Change {
    std::uint64_t viewer = all_viewers;
    std::vector<std::string> assignments;
  };

 private:
  using Clock = std::chrono::steady_clock;

  void thread();
  void wait_after_failure(const std::string& reason);
  void begin();                                   // a new world is there
  bool between_steps(World& world, Real& until);  // RunHooks::before_step
  bool may_step(Real& wait_s);
  void after_step(const StepReport& report);
  void check_limits();
  void publish();
  std::uint16_t flags() const;
  void sample();
  void rebase() { pace_wall_ = Clock::now(), pace_time_ = world_.time; }

  // Commands, each in the session's thread. True: the world was changed.
  bool handle_next(std::deque<Command>& todo);
  bool handle(const Command& command);
  bool change(const std::vector<Change>& changes);
  bool drop(std::uint64_t viewer, const DropMessage& message);
  void restart(std::uint64_t viewer, Scene scene);
  void restart_with(std::uint64_t viewer, const std::vector<std::string>& assignments);
  void open(std::uint64_t viewer, const OpenMessage& message);
  void end_recording(RunStatus status, const std::string& reason);
  std::string change_event(std::uint64_t viewer, const std::vector<std::string>& assignments) const;

  SessionSetup setup_;
  Scene scene_, start_scene_;  // as changed; as it began
  World world_;
  StepReport report_;
  std::optional<Recorder> recorder_;
  std::shared_ptr<const Snapshot> last_;
  std::uint32_t generation_ = 0, number_ = 0;

  bool running_ = true, ended_ = false, failed_ = false;
  bool begun_ = false;  // begin() was carried out for this world
  bool stop_ = false;   // leave the run: a new world, or the end
  bool quit_ = false;
  bool told_ = false;   // the state since the last publish() is told
  int steps_left_ = 0;
  std::optional<std::pair<Scene, World>> next_;  // to go on with

  Clock::time_point pace_wall_ = Clock::now(), publish_due_{}, speed_wall_ = Clock::now();
  Real pace_time_ = 0, speed_time_ = 0, speed_ = 0;
  std::atomic<std::uint64_t> steps_made_{0};
  std::shared_ptr<std::atomic<Real>> time_reached_ = std::make_shared<std::atomic<Real>>(0);  // 1e30: it will not move

  mutable std::mutex lock_;  // of what follows
  std::condition_variable woken_;
  std::deque<Command> commands_;
  bool quit_asked_ = false;
  std::shared_ptr<const std::atomic<Real>> other_time_;
  std::string scene_text_;
  History history_;

  std::thread thread_;  // last: it uses all of the above
};

}  // namespace imbibe::live
