// One thread beside the run that does its writing: files, pictures, checkpoints. The run hands over jobs, each with its
// own copy of what it writes, and goes on.
//
// Jobs run one after the other in the order they were posted, so what the run folder promises about order holds. Memory is
// bounded: at most `most_waiting` jobs wait, and `few_waiting` when the run says that it is large already; posting one more
// waits for room (`waited_s` adds up what the run lost by it).
// A job that throws ends the writing: jobs after it are dropped, and its exception comes out of the next post() or
// finish(), in the run's own thread. So a full disk stops the run a few outputs later than it did without a thread.
// Tested in tests/io/background_writer_test.cpp.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace imbibe {

class BackgroundWriter {
 public:
  explicit BackgroundWriter(std::size_t most_waiting = 16, std::size_t few_waiting = 2);
  ~BackgroundWriter();  // does what waits, unless a job has thrown
  BackgroundWriter(const BackgroundWriter&) = delete;
  BackgroundWriter& operator=(const BackgroundWriter&) = delete;

  void post(std::function<void()> job, bool large = false);

  // Returns when all posted jobs are done; throws what one of them threw, once.
  void finish();

  // As finish(), but drops what waits and throws nothing: the way out when the run has failed already.
  void abandon() noexcept;

  double waited_s() const { return waited_s_; }   // by the run, in post() and finish()
  double working_s() const;                       // by the writer

 private:
  void work();
  void rethrow(std::unique_lock<std::mutex>& lock);

  const std::size_t most_waiting_, few_waiting_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> jobs_;
  bool busy_ = false, ending_ = false;
  std::exception_ptr failure_;
  bool failed_ = false;
  double waited_s_ = 0, working_s_ = 0;
  std::thread thread_;  // last: it uses all of the above
};

}  // namespace imbibe
