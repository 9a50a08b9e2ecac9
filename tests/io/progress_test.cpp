#include "imbibe/io/progress.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

namespace imbibe {
namespace {

Progress typical() {
  return {.time_s = 0.512,
          .until_s = 2,
          .wall_s = 9.5,
          .left_s = 14.2,
          .step_s = 2.1e-4,
          .step_bound = "capillary",
          .free_kg = 1.52e-3,
          .absorbed_kg = 1.2e-4,
          .ledger_error = 3e-15,
          .steps = 2400,
          .particles = 7420};
}

TEST(ProgressText, says_time_share_time_left_step_masses_and_balance) {
  EXPECT_EQ(progress_text(typical()),
            "t 512 ms of 2.00 s   25 %  left 14 s  step 210 µs (capillary)  free 1.52 g  absorbed 120 mg  balance "
            "3e-15");
}

TEST(ProgressText, says_a_hundred_percent_only_at_the_end) {
  Progress p = typical();
  p.time_s = 1.9999;
  EXPECT_NE(progress_text(p).find(" 99 %"), std::string::npos);
  p.time_s = 2;
  EXPECT_NE(progress_text(p).find("100 %"), std::string::npos);
}

TEST(ProgressJson, is_one_object_with_every_number_and_null_for_what_is_not_known) {
  Progress p = typical();
  p.left_s = -1;
  p.ledger_error = std::numeric_limits<Real>::quiet_NaN();
  const std::string text = progress_json(p);
  EXPECT_EQ(text.find('\n'), std::string::npos);
  const auto json = nlohmann::json::parse(text);
  EXPECT_EQ(json["time_s"], 0.512);
  EXPECT_EQ(json["step_bound"], "capillary");
  EXPECT_EQ(json["steps"], 2400);
  EXPECT_EQ(json["particles"], 7420);
  EXPECT_TRUE(json["left_s"].is_null());
  EXPECT_TRUE(json["ledger_error"].is_null());
}

TEST(DurationText, reads_well_from_milliseconds_to_days) {
  EXPECT_EQ(duration_text(0.85), "850 ms");
  EXPECT_EQ(duration_text(0.9999), "1.0 s");
  EXPECT_EQ(duration_text(14.4), "14 s");
  EXPECT_EQ(duration_text(200), "3 min 20 s");
  EXPECT_EQ(duration_text(7500), "2 h 05 min");
  EXPECT_EQ(duration_text(3 * 86400.0), "3.0 days");
  EXPECT_EQ(duration_text(-1), "unknown");
}

TEST(ScaledText, picks_the_prefix_after_rounding) {
  EXPECT_EQ(scaled_text(1.523e-3, "kg"), "1.52 g");
  EXPECT_EQ(scaled_text(50e-6, "kg"), "50.0 mg");
  EXPECT_EQ(scaled_text(0.99999, "s"), "1.00 s");
  EXPECT_EQ(scaled_text(9.9999e-4, "s"), "1.00 ms");
  EXPECT_EQ(scaled_text(0, "kg"), "0 g");
  EXPECT_EQ(scaled_text(3.6e-3, "m2"), "36.0 cm²");
  EXPECT_EQ(scaled_text(2.5e-5, "m2"), "25.0 mm²");
  EXPECT_EQ(scaled_text(-2e-3, "m"), "-2.00 mm");
  EXPECT_EQ(scaled_text(1234.5, "Pa"), "1.23 kPa");
  EXPECT_EQ(scaled_text(3600, "s"), "3600 s");
}

TEST(TimeLeft, of_a_steady_run_is_exact) {
  TimeLeft left;
  EXPECT_LT(left.update(0, 0, 10), 0);
  for (int i = 1; i <= 20; ++i) {
    const Real wall = 0.5 * i, time = 0.25 * i;  // half a simulated second per second
    EXPECT_NEAR(left.update(wall, time, 10), (10 - time) / 0.5, 1e-9);
  }
  EXPECT_EQ(left.update(30, 10, 10), 0);
}

TEST(TimeLeft, follows_a_run_that_becomes_faster) {
  TimeLeft left;
  left.update(0, 0, 1000);
  for (int i = 1; i <= 100; ++i) left.update(0.1 * i, 0.001 * i, 1000);  // 0.01 s/s for 10 s
  Real last = 0, time = 0.1;
  for (int i = 1; i <= 200; ++i) last = left.update(10 + 0.1 * i, time += 1, 1000);  // then 10 s/s for 20 s
  // The average over the whole run would say (1000 - 200.1) / (200.1 / 30) = 120 s; the truth is 80 s. After four
  // windows of at most 6 s less than exp(-3.3) = 4 % of the old speed is left.
  EXPECT_NEAR(last, (1000 - time) / 10, 0.05 * (1000 - time) / 10);
}

TEST(ProgressWriter, holds_lines_back_but_never_the_last) {
  std::ostringstream out;
  ProgressWriter writer(out, ProgressStyle::json);
  for (int i = 0; i <= 100; ++i) {
    Progress p = typical();
    p.wall_s = 0.01 * i;
    p.steps = static_cast<std::uint64_t>(i);
    writer.show(p);
  }
  writer.finish();
  std::istringstream in(out.str());
  std::vector<int> steps;
  for (std::string line; std::getline(in, line);) steps.push_back(nlohmann::json::parse(line)["steps"]);
  EXPECT_EQ(steps, (std::vector<int>{0, 50, 100}));
}

TEST(ProgressWriter, never_writes_wider_than_the_terminal) {
  std::ostringstream out;
  ProgressWriter writer(out, ProgressStyle::terminal, 40);
  writer.show(typical());
  writer.finish();
  const std::string text = out.str();
  EXPECT_EQ(text.front(), '\r');
  EXPECT_EQ(text.back(), '\n');
  int characters = 0;
  for (const char c : text) characters += (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  EXPECT_LE(characters, 39 + 1 + 3 + 1);  // the line, return, erase to the end, new line
}

}  // namespace
}  // namespace imbibe
