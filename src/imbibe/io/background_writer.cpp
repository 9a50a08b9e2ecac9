#include "imbibe/io/background_writer.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace imbibe {

namespace {
using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }
}  // namespace

BackgroundWriter::BackgroundWriter(std::size_t most_waiting, std::size_t few_waiting)
    : most_waiting_(most_waiting), few_waiting_(std::min(few_waiting, most_waiting)), thread_([this] { work(); }) {}

BackgroundWriter::~BackgroundWriter() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void BackgroundWriter::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return !jobs_.empty() || ending_; });
    if (jobs_.empty()) return;
    std::function<void()> job = std::move(jobs_.front());
    jobs_.pop_front();
    busy_ = true;
    lock.unlock();
    changed_.notify_all();  // there is room for one more
    const auto start = Clock::now();
    std::exception_ptr thrown;
    try {
      job();
    } catch (...) {
      thrown = std::current_exception();
    }
    job = nullptr;  // its copy of the world goes before the next one is made
    const double seconds = seconds_since(start);
    lock.lock();
    working_s_ += seconds;
    busy_ = false;
    if (thrown) failure_ = thrown, failed_ = true, jobs_.clear();
    changed_.notify_all();
  }
}

void BackgroundWriter::rethrow(std::unique_lock<std::mutex>& lock) {
  if (!failure_) return;
  const std::exception_ptr thrown = std::exchange(failure_, nullptr);
  lock.unlock();
  std::rethrow_exception(thrown);
}

void BackgroundWriter::post(std::function<void()> job, bool large) {
  std::unique_lock lock(mutex_);
  const auto start = Clock::now();
  changed_.wait(lock, [&] { return jobs_.size() < (large ? few_waiting_ : most_waiting_) || failed_; });
  waited_s_ += seconds_since(start);
  rethrow(lock);
  if (failed_) return;  // already told; nothing may come after what was lost
  jobs_.push_back(std::move(job));
  changed_.notify_all();
}

void BackgroundWriter::finish() {
  std::unique_lock lock(mutex_);
  const auto start = Clock::now();
  changed_.wait(lock, [&] { return jobs_.empty() && !busy_; });
  waited_s_ += seconds_since(start);
  rethrow(lock);
}

void BackgroundWriter::abandon() noexcept {
  std::unique_lock lock(mutex_);
  jobs_.clear();
  failed_ = true;
  changed_.wait(lock, [&] { return !busy_; });
  failure_ = nullptr;
}

double BackgroundWriter::working_s() const {
  const std::lock_guard lock(mutex_);
  return working_s_;
}

}  // namespace imbibe
