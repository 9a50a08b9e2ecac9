#include "imbibe/io/series.h"

#include <gtest/gtest.h>

#include "imbibe/core/error.h"
#include "io/limited_file_size.h"
#include "io/small_world.h"
#include "io/temporary_folder.h"

namespace imbibe {
namespace {

using testing::TemporaryFolder;
using testing::text_of;

SeriesRow row_at(Real time) {
  SeriesRow row;
  row.time_s = time;
  row.mass.free = 1.0 / 3;
  row.mass.supplied = 1.0 / 3;
  row.steps = static_cast<std::uint64_t>(time * 1000);
  return row;
}

TEST(Series, has_the_fixed_columns_first_and_in_order) {
  const std::vector<std::string> fixed{"time_s",
                                       "free_kg",
                                       "sorbed_kg",
                                       "yarn_kg",
                                       "pore_kg",
                                       "cell_kg",
                                       "evaporated_kg",
                                       "left_kg",
                                       "supplied_kg",
                                       "ledger_error",
                                       "particles",
                                       "wet_area_m2",
                                       "wet_extent_warp_m",
                                       "wet_extent_weft_m",
                                       "mean_saturation",
                                       "max_saturation",
                                       "step_s",
                                       "steps"};
  const std::vector<std::string>& columns = series_columns();
  ASSERT_GE(columns.size(), fixed.size());
  EXPECT_EQ(std::vector<std::string>(columns.begin(), columns.begin() + static_cast<std::ptrdiff_t>(fixed.size())),
            fixed);
}

TEST(Series, reads_back_to_the_same_bits) {
  const TemporaryFolder folder;
  const auto path = folder / "series.csv";
  {
    SeriesFile file(path);
    for (int i = 0; i < 5; ++i) file.write(row_at(0.1 * i));
  }
  const SeriesTable table = read_series(path);
  EXPECT_EQ(table.columns, series_columns());
  ASSERT_EQ(table.rows(), 5u);
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(table.column("time_s")[static_cast<std::size_t>(i)], 0.1 * i);
    EXPECT_EQ(table.column("free_kg")[static_cast<std::size_t>(i)], 1.0 / 3);
  }
  EXPECT_THROW(table.column("no_such_column"), InputError);
}

TEST(Series, is_on_the_disk_after_every_row_and_continues_without_a_second_header) {
  const TemporaryFolder folder;
  const auto path = folder / "series.csv";
  {
    SeriesFile file(path);
    file.write(row_at(0));
    EXPECT_EQ(read_series(path).rows(), 1u);
  }
  SeriesFile again(path);
  again.write(row_at(1));
  EXPECT_EQ(read_series(path).rows(), 2u);
}

TEST(Series, is_cut_at_a_time_and_loses_a_half_row) {
  const TemporaryFolder folder;
  const auto path = folder / "series.csv";
  {
    SeriesFile file(path);
    for (int i = 0; i < 10; ++i) file.write(row_at(i));
  }
  const std::string whole = text_of(path);
  write_whole_file(path, whole + "10,0.333");
  EXPECT_EQ(read_series(path).rows(), 10u);
  cut_series(path, 4);
  EXPECT_EQ(read_series(path).column("time_s"), (std::vector<Real>{0, 1, 2, 3, 4}));
  cut_series(path, -1);
  EXPECT_EQ(read_series(path).rows(), 0u);
  EXPECT_EQ(read_series(path).columns, series_columns());
  cut_series(folder / "none.csv", 0);
}

TEST(Series, on_a_full_disk_keeps_whole_rows_only) {
  const TemporaryFolder folder;
  const auto path = folder / "series.csv";
  SeriesFile file(path);
  file.write(row_at(0));
  const std::size_t size = text_of(path).size();
  {
    const testing::LimitedFileSize limit(size + 20);
    EXPECT_THROW(file.write(row_at(1)), OutputError);
  }
  EXPECT_EQ(text_of(path).size(), size);
  EXPECT_EQ(read_series(path).rows(), 1u);
}

TEST(Series, that_is_damaged_is_refused_with_its_line) {
  const TemporaryFolder folder;
  const auto path = folder / "series.csv";
  write_whole_file(path, "time_s,free_kg\n0,1\n1,x\n");
  try {
    read_series(path);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("series.csv:3:"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("free_kg"), std::string::npos) << error.what();
  }
  write_whole_file(path, "time_s,free_kg\n0\n");
  EXPECT_THROW(read_series(path), InputError);
  write_whole_file(path, "");
  EXPECT_THROW(read_series(path), InputError);
}

TEST(SeriesRow, of_a_world_holds_its_balance_particles_and_wetness) {
  World world = testing::small_world(20);
  world.time = 0.5;
  world.step = 77;
  StepReport report;
  report.step_s = 1e-4;
  SeriesRow row = series_row(world, report);
  EXPECT_EQ(row.time_s, 0.5);
  EXPECT_EQ(row.steps, 77u);
  EXPECT_EQ(row.step_s, 1e-4);
  EXPECT_EQ(row.particles, 20u);
  EXPECT_NEAR(row.mass.free, 20e-8, 1e-20);
  EXPECT_LT(row.mass.error(), 1e-15);  // sums of a few hundred numbers
  EXPECT_EQ(row.wet_area_m2, 0);

  // A second, equal textile: areas add up, saturations do not.
  world.textiles[0].contents.liquid_kg[3] =
      current_volume(*world.textiles[0].model, world.textiles[0].contents, 3) * 998.2;
  row = series_row(world, report);
  EXPECT_GT(row.wet_area_m2, 0);
  EXPECT_GT(row.mass.error(), 0);  // liquid from nowhere shows
  world.textiles.push_back(world.textiles[0]);
  const SeriesRow two = series_row(world, report);
  EXPECT_NEAR(two.wet_area_m2, 2 * row.wet_area_m2, 1e-15);
  EXPECT_NEAR(two.mean_saturation, row.mean_saturation, 1e-12);
  EXPECT_NEAR(two.mass.yarn, 2 * row.mass.yarn, 1e-18);
}

}  // namespace
}  // namespace imbibe
