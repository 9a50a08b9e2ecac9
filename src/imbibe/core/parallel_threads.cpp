// The loops of parallel.h on plain threads, in place of oneTBB: for the thread sanitizer (IMBIBE_SANITIZE=thread), which
// sees how these threads hand work over to each other. It cannot see into oneTBB's library, and would call every loop a
// race. Not for speed: threads sleep between loops.
#ifdef IMBIBE_PLAIN_THREADS

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

#include "imbibe/core/parallel.h"

namespace imbibe {

namespace {

int all_cores() { return static_cast<int>(std::max(1u, std::thread::hardware_concurrency())); }

struct Limits {
  std::mutex mutex;
  std::multiset<int> set;
};
Limits& limits() {
  static Limits all;
  return all;
}

thread_local bool inside_a_loop = false;

class Pool {
 public:
  ~Pool() {
    {
      const std::lock_guard lock(mutex_);
      closing_ = true;
    }
    wake_.notify_all();
    for (std::thread& thread : threads_) thread.join();
  }

  void run(std::size_t tiles, void* body, detail::TileCall call) {
    const int helpers = available_threads() - 1;
    std::unique_lock alone(one_loop_, std::defer_lock);
    // A loop inside a loop, or beside another thread's, is done by its caller.
    if (inside_a_loop || helpers < 1 || !alone.try_lock()) {
      for (std::size_t tile = 0; tile < tiles; ++tile) call(body, tile);
      return;
    }
    {
      const std::lock_guard lock(mutex_);
      while (static_cast<int>(threads_.size()) < helpers) {
        threads_.emplace_back([this, index = static_cast<int>(threads_.size())] { serve(index); });
      }
      body_ = body, call_ = call, tiles_ = tiles, helpers_ = helpers;
      next_ = 0, error_ = nullptr, open_ = true;
      ++loop_;
    }
    wake_.notify_all();
    work();
    std::unique_lock lock(mutex_);
    open_ = false;
    done_.wait(lock, [&] { return busy_ == 0; });
    if (error_) std::rethrow_exception(error_);
  }

 private:
  void work() {
    inside_a_loop = true;
    try {
      for (std::size_t tile = next_++; tile < tiles_; tile = next_++) call_(body_, tile);
    } catch (...) {
      next_ = tiles_;
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
    }
    inside_a_loop = false;
  }

  void serve(int index) {
    std::uint64_t seen = 0;
    std::unique_lock lock(mutex_);
    while (true) {
      wake_.wait(lock, [&] { return closing_ || (loop_ != seen && open_ && index < helpers_); });
      if (closing_) return;
      seen = loop_;
      ++busy_;
      lock.unlock();
      work();
      lock.lock();
      if (--busy_ == 0) done_.notify_all();
    }
  }

  std::mutex one_loop_, mutex_;
  std::condition_variable wake_, done_;
  std::vector<std::thread> threads_;
  void* body_ = nullptr;
  detail::TileCall call_ = nullptr;
  std::size_t tiles_ = 0;
  std::atomic<std::size_t> next_{0};
  std::exception_ptr error_;
  std::uint64_t loop_ = 0;
  int helpers_ = 0, busy_ = 0;
  bool open_ = false, closing_ = false;
};

Pool& pool() {
  static Pool all;
  return all;
}

}  // namespace

struct ThreadLimit::Control {
  std::multiset<int>::iterator place;
};

ThreadLimit::ThreadLimit(int threads) : control_(new Control) {
  const std::lock_guard lock(limits().mutex);
  control_->place = limits().set.insert(threads > 0 ? threads : all_cores());
}
ThreadLimit::~ThreadLimit() {
  const std::lock_guard lock(limits().mutex);
  limits().set.erase(control_->place);
}

int available_threads() {
  const std::lock_guard lock(limits().mutex);
  return limits().set.empty() ? all_cores() : *limits().set.begin();
}

void detail::run_tiles(std::size_t tiles, void* body, TileCall call) { pool().run(tiles, body, call); }

}  // namespace imbibe

#endif
