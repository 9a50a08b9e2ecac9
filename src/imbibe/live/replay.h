// A finished (or still growing) run on the page: frames from the files in its folder (view/run_frames.h), curves from
// series.csv. Plays at the wanted speed, pauses, and goes to any time.
// Tested with the page, in viewer/test/live.test.mjs.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <memory>
#include <mutex>
#include <thread>

#include "imbibe/io/series.h"
#include "imbibe/live/feed.h"
#include "imbibe/scene/library.h"
#include "imbibe/scene/scene.h"
#include "imbibe/sim/world.h"
#include "imbibe/view/run_frames.h"

namespace imbibe::live {

class Replay final : public Feed {
 public:
  // Throws InputError when the folder holds no frames.
  Replay(const std::filesystem::path& folder, std::shared_ptr<const Library> library, std::function<void()> wake);
  ~Replay() override;

  void post(Command command) override;
  std::string scene_text() const override { return scene_text_; }
  const std::vector<Real>& times() const { return frames_.times; }

 private:
  void thread();
  bool handle(const Command& command);  // true: another frame is to be shown
  void show(std::size_t frame);
  void tell_contents(std::uint64_t viewer, const InspectMessage& message);
  std::vector<double> values_at(Real time) const;

  Scene scene_;
  std::shared_ptr<const Library> library_;
  World world_;
  RunFrames frames_;
  std::vector<RunFrames::Collection> pores_;  // per textile
  SeriesTable series_;
  std::string scene_text_;
  std::shared_ptr<const Snapshot> last_;
  std::size_t frame_ = 0;
  std::size_t recalled_ = std::size_t(-1);   // frame whose contents world_ holds
  std::vector<std::vector<Vec3>> places_;    // of its nodes, per textile
  std::uint32_t number_ = 0;
  bool playing_ = true;
  Real speed_ = 1;           // recorded seconds per second; 0: every frame, as fast as it goes
  std::chrono::steady_clock::time_point shown_at_{};

  std::mutex lock_;
  std::condition_variable woken_;
  std::deque<Command> commands_;
  bool quit_ = false;
  std::thread thread_;
};

}  // namespace imbibe::live
