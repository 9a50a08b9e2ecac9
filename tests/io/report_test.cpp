#include "imbibe/io/report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <regex>

#include "imbibe/core/error.h"
#include "imbibe/io/chart.h"
#include "imbibe/io/run_folder.h"
#include "io/small_world.h"
#include "io/temporary_folder.h"

namespace imbibe {
namespace {

using testing::TemporaryFolder;
namespace fs = std::filesystem;

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size()) ++count;
  return count;
}

// A run of eleven outputs in which a yarn fills.
void make_run(const fs::path& folder, const std::string& title) {
  World world = testing::small_world();
  RunSetup setup;
  setup.command = "imbibe run 'a <b>.yaml'";
  setup.title = title;
  setup.scene_yaml = "version: 1\n";
  setup.until_s = 1;
  setup.fabrics = {{"swatch", "porosity 0.686 & more"}};
  RunFolder run(folder, setup, ExistingFolder::refuse, world);
  for (int i = 0; i <= 10; ++i) {
    world.time = 0.1 * i;
    world.textiles[0].contents.liquid_kg[5] = 1e-8 * i;
    world.ledger.supplied_kg = world.liquid.mass() + 1e-8 * i;
    run.write_output(world, {});
  }
  run.note("Taken up along the yarns.");
  run.finish(world, RunStatus::done);
}

TEST(Report, shows_title_figures_curves_fabric_numbers_notes_and_the_command) {
  const TemporaryFolder folder;
  make_run(folder.path(), "A drop on cotton");
  EXPECT_EQ(write_report(folder.path()), folder / "report.html");
  const std::string html = testing::text_of(folder / "report.html");
  EXPECT_NE(html.find("<h1>A drop on cotton</h1>"), std::string::npos);
  EXPECT_EQ(count_of(html, "<svg class=\"plot\""), 6u);
  for (const char* title : {"Where the liquid is", "Wetted area", "Extent of the stain", "Balance of the liquid"}) {
    EXPECT_NE(html.find(title), std::string::npos) << title;
  }
  EXPECT_NE(html.find("along the warp"), std::string::npos);
  EXPECT_NE(html.find("time [s]"), std::string::npos);
  EXPECT_NE(html.find("porosity 0.686 &amp; more"), std::string::npos);
  EXPECT_NE(html.find("Taken up along the yarns."), std::string::npos);
  EXPECT_NE(html.find("imbibe run &#39;a &lt;b&gt;.yaml&#39;"), std::string::npos);
  EXPECT_EQ(html.find("nan"), std::string::npos);
  EXPECT_EQ(html.find("inf"), std::string::npos);
}

TEST(Report, needs_no_network_and_no_script) {
  const TemporaryFolder folder;
  make_run(folder.path(), "t");
  const std::string html = report_html(folder.path());
  EXPECT_EQ(html.find("http://"), std::string::npos);
  EXPECT_EQ(html.find("https://"), std::string::npos);
  EXPECT_EQ(html.find("<script"), std::string::npos);
  EXPECT_EQ(html.find("<link"), std::string::npos);
  EXPECT_EQ(html.find("@import"), std::string::npos);
}

TEST(Report, escapes_what_the_user_wrote) {
  const TemporaryFolder folder;
  make_run(folder.path(), "<script>alert(\"x\")</script> & co");
  const std::string html = report_html(folder.path());
  EXPECT_EQ(html.find("<script"), std::string::npos);
  EXPECT_NE(html.find("&lt;script&gt;alert(&quot;x&quot;)&lt;/script&gt; &amp; co"), std::string::npos);
}

TEST(Report, links_pictures_and_film_by_relative_path) {
  const TemporaryFolder folder;
  make_run(folder.path(), "t");
  fs::create_directory(folder / "pictures");
  for (int i = 0; i < 20; ++i) {
    write_whole_file(folder / ("pictures/picture_0000" + std::string(i < 10 ? "0" : "") + std::to_string(i) + ".png"),
                     "");
  }
  std::string html = report_html(folder.path());
  EXPECT_NE(html.find("src=\"pictures/picture_000019.png\""), std::string::npos);  // the last, large
  EXPECT_NE(html.find("src=\"pictures/picture_000000.png\""), std::string::npos);
  EXPECT_EQ(count_of(html, "<img "), 7u);
  EXPECT_EQ(html.find("<video"), std::string::npos);
  write_whole_file(folder / "film.mp4", "");
  html = report_html(folder.path());
  EXPECT_NE(html.find("<video controls preload=\"metadata\" src=\"film.mp4\""), std::string::npos);
}

TEST(Report, of_a_run_that_has_only_begun_can_be_made) {
  const TemporaryFolder folder;
  const World world = testing::small_world();
  RunFolder run(folder.path(), {}, ExistingFolder::refuse, world);
  EXPECT_NE(report_html(folder.path()).find("No output time was reached"), std::string::npos);
  run.write_output(world, {});
  EXPECT_NE(report_html(folder.path()).find("Fewer than two rows"), std::string::npos);
}

TEST(Report, of_a_damaged_run_is_an_input_error) {
  const TemporaryFolder folder;
  EXPECT_THROW(report_html(folder.path()), InputError);
  make_run(folder.path(), "t");
  write_whole_file(folder / "run.json", "{\"title\": ");
  EXPECT_THROW(report_html(folder.path()), InputError);
}

TEST(RoundTicks, cover_the_range_with_few_round_numbers) {
  EXPECT_EQ(round_ticks(0, 1, 5), (std::vector<Real>{0, 0.2, 0.4, 0.2 * 3, 0.8, 1}));
  EXPECT_EQ(round_ticks(0, 37, 5), (std::vector<Real>{0, 10, 20, 30, 40}));
  EXPECT_EQ(round_ticks(-3, 7, 5), (std::vector<Real>{-4, -2, 0, 2, 4, 6, 8}));
  for (const auto& [lower, upper] :
       {std::pair<Real, Real>{0, 1.234e-9}, {-5e7, 3.3e7}, {0.999, 1.001}, {0, 0}, {5, 5}}) {
    const std::vector<Real> ticks = round_ticks(lower, upper, 5);
    ASSERT_GE(ticks.size(), 2u);
    EXPECT_LE(ticks.size(), 7u);
    EXPECT_LE(ticks.front(), lower + 1e-9 * std::fabs(lower));
    EXPECT_GE(ticks.back(), upper - 1e-9 * std::fabs(upper));
  }
}

// The points of the first curve's path in the drawing.
std::vector<std::pair<Real, Real>> path_points(const std::string& html) {
  const std::size_t plot = html.find("<svg class=\"plot\"");
  const std::regex path("<path class=\"curve c1\" d=\"([^\"]*)\"><title>");
  std::smatch match;
  const std::string rest = html.substr(plot);
  EXPECT_TRUE(std::regex_search(rest, match, path));
  const std::string d = match[1];
  std::vector<std::pair<Real, Real>> points;
  const std::regex point("[ML]([-0-9.]+) ([-0-9.]+)");
  for (std::sregex_iterator it(d.begin(), d.end(), point), end; it != end; ++it) {
    points.emplace_back(std::stod((*it)[1]), std::stod((*it)[2]));
  }
  return points;
}

TEST(Chart, draws_a_straight_line_straight_and_inside_its_axes) {
  Chart chart;
  chart.x_unit = {1, "s"};
  chart.y_unit = {1e-3, "mm"};
  for (int i = 0; i <= 100; ++i) chart.x.push_back(i);
  Curve curve{"line", {}, ""};
  for (const Real x : chart.x) curve.values.push_back(1e-3 * x);
  chart.curves.push_back(curve);
  const auto points = path_points(chart_html(chart));
  ASSERT_EQ(points.size(), 101u);
  // The left, right, lower and upper edges of the plot; values are written to a tenth of a pixel.
  EXPECT_NEAR(points.front().first, 62, 0.06);
  EXPECT_NEAR(points.front().second, 240, 0.06);
  EXPECT_NEAR(points.back().first, 606, 0.06);
  EXPECT_NEAR(points.back().second, 12, 0.06);
  EXPECT_NEAR(points[50].first, (62 + 606) / 2.0, 0.06);
  EXPECT_NEAR(points[50].second, (240 + 12) / 2.0, 0.06);
}

TEST(Chart, of_many_points_keeps_the_peaks) {
  Chart chart;
  for (int i = 0; i < 100000; ++i) chart.x.push_back(i);
  Curve curve{"spike", std::vector<Real>(100000, 0.1), ""};
  curve.values[77777] = 1;
  curve.values[12345] = 0;
  chart.curves.push_back(curve);
  const auto points = path_points(chart_html(chart));
  EXPECT_LE(points.size(), 620u);
  const auto [highest, lowest] = std::minmax_element(points.begin(), points.end(),
                                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  EXPECT_NEAR(highest->second, 12, 0.06);  // y grows downwards
  EXPECT_NEAR(lowest->second, 240, 0.06);
}

TEST(Chart, on_a_logarithmic_axis_takes_zeros_and_shows_its_limit) {
  Chart chart;
  chart.logarithmic = true;
  chart.limit = 1e-10;
  chart.limit_name = "limit";
  chart.x = {0, 1, 2};
  chart.curves.push_back({"error", {0, 1e-15, 1e-13}, ""});
  const std::string html = chart_html(chart);
  EXPECT_NE(html.find("class=\"limit\""), std::string::npos);
  EXPECT_EQ(html.find("nan"), std::string::npos);
  EXPECT_EQ(html.find("inf"), std::string::npos);
  const auto points = path_points(html);
  EXPECT_EQ(points[0].second, points[1].second);  // zero at the lower end, where 1e-15 is
  EXPECT_LT(points[2].second, points[1].second);
}

}  // namespace
}  // namespace imbibe
