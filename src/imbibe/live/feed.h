// What the server shows and steers: a running simulation (session.h) or a finished run (replay.h). Each has a thread of
// its own; the server and it meet only here, under one lock held for the time of a pointer's copy, so that a viewer can
// never make a simulation wait.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "imbibe/core/error.h"
#include "imbibe/live/protocol.h"
#include "imbibe/live/snapshot.h"

namespace imbibe::live {

inline constexpr std::uint64_t all_viewers = 0;

struct Event {
  std::uint64_t viewer = all_viewers;
  std::string json;
};

// The feed's side writes, the server's side reads.
class Outlet {
 public:
  explicit Outlet(std::function<void()> wake) : wake_(std::move(wake)) {}

  void publish(std::shared_ptr<const Snapshot> snapshot);
  void publish(std::shared_ptr<const Geometry> geometry);  // the snapshot of the world before is dropped
  void tell(std::uint64_t viewer, std::string json);

  std::shared_ptr<const Snapshot> snapshot() const;
  std::shared_ptr<const Geometry> geometry() const;
  std::vector<Event> take_events();

  std::atomic<int> viewers{0};  // none: snapshots need not be made

 private:
  mutable std::mutex lock_;
  std::function<void()> wake_;
  std::shared_ptr<const Snapshot> snapshot_;
  std::shared_ptr<const Geometry> geometry_;
  std::vector<Event> events_;
};

struct Command {
  std::uint64_t viewer = all_viewers;
  Message message;
  std::uint64_t arrived_at_step = 0;  // steps that were made when it came
};

class Feed {
 public:
  explicit Feed(std::function<void()> wake) : outlet(std::move(wake)) {}
  virtual ~Feed() = default;
  Feed(const Feed&) = delete;
  Feed& operator=(const Feed&) = delete;

  virtual void post(Command command) = 0;       // any thread
  virtual std::string scene_text() const = 0;   // the scene as it is now, any thread; "" when there is none
  // The rows so far of the world that is shown, for a page that comes late; any thread. "[]": in the scene message, or none.
  virtual std::string history_json() const { return "[]"; }

  Outlet outlet;
};

// ---- events as JSON

std::string error_event(int swatch, const std::string& about, const std::vector<Problem>& problems);
std::string error_event(int swatch, const std::string& about, const std::string& message);
std::string notice_event(int swatch, const std::string& message);
// The message that asked with this number was carried out, or refused by an error told before, at this step; it had come
// when `arrived` steps were made, so that a change of it holds from step `step` + 1 on.
std::string done_event(int swatch, double ask, std::uint64_t arrived, std::uint64_t step, Real time);

}  // namespace imbibe::live
