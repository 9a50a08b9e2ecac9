#include "imbibe/io/background_writer.h"

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

namespace imbibe {
namespace {

// A job that holds the writer until the test lets it go.
struct Gate {
  std::atomic<bool> open{false};
  void wait() const {
    while (!open) std::this_thread::yield();
  }
};

TEST(BackgroundWriter, jobs_are_done_in_the_order_they_were_posted) {
  std::vector<int> done, expected(50);
  std::iota(expected.begin(), expected.end(), 0);
  BackgroundWriter writer(3);
  for (int i = 0; i < 50; ++i) writer.post([&done, i] { done.push_back(i); });
  writer.finish();
  EXPECT_EQ(done, expected);
}

TEST(BackgroundWriter, the_run_goes_on_while_a_job_is_done) {
  Gate gate;
  BackgroundWriter writer;
  writer.post([&] { gate.wait(); });  // posting returns although the job cannot end
  gate.open = true;
  writer.finish();
}

// Six jobs that cannot end are posted to a writer: one is being done and two wait, until they are let go.
void expect_two_waiting(BackgroundWriter& writer, bool large) {
  Gate gate;
  std::atomic<int> posted = 0;
  std::thread run([&] {
    for (int i = 0; i < 6; ++i) writer.post([&] { gate.wait(); }, large), ++posted;
  });
  while (posted < 3) std::this_thread::yield();
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_LE(posted, 3);
  gate.open = true;
  run.join();
  writer.finish();
  EXPECT_EQ(posted, 6);
}

TEST(BackgroundWriter, no_more_jobs_wait_than_allowed) {
  BackgroundWriter writer(2);
  expect_two_waiting(writer, false);
}

TEST(BackgroundWriter, of_a_large_run_fewer_jobs_wait) {
  BackgroundWriter writer(20, 2);
  expect_two_waiting(writer, true);
}

TEST(BackgroundWriter, what_a_job_throws_reaches_the_run_and_nothing_is_written_after_it) {
  std::atomic<bool> later = false;
  Gate gate;
  BackgroundWriter writer;
  writer.post([&]() {
    gate.wait();
    throw std::runtime_error("disk full");
  });
  writer.post([&] { later = true; });
  gate.open = true;
  std::string message;
  try {
    writer.finish();
  } catch (const std::runtime_error& error) {
    message = error.what();
  }
  EXPECT_EQ(message, "disk full");
  EXPECT_NO_THROW(writer.post([&] { later = true; }));  // told once
  EXPECT_NO_THROW(writer.finish());
  EXPECT_FALSE(later);
}

TEST(BackgroundWriter, a_failure_comes_out_of_the_next_post) {
  Gate failed;
  BackgroundWriter writer(1);
  writer.post([&] {
    failed.open = true;
    throw std::runtime_error("folder gone");
  });
  failed.wait();
  EXPECT_THROW(for (int i = 0; i < 1000; ++i) writer.post([] { std::this_thread::sleep_for(std::chrono::milliseconds(1)); }),
               std::runtime_error);
}

TEST(BackgroundWriter, what_waits_at_the_end_is_still_done) {
  int done = 0;
  {
    BackgroundWriter writer(8);
    for (int i = 0; i < 8; ++i) writer.post([&] { ++done; });
  }
  EXPECT_EQ(done, 8);
}

}  // namespace
}  // namespace imbibe
