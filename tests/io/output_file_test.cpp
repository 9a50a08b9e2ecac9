#include "imbibe/core/output_file.h"

#include <gtest/gtest.h>

#include <cerrno>

#include "imbibe/core/error.h"
#include "io/limited_file_size.h"
#include "io/temporary_folder.h"

namespace imbibe {
namespace {

using testing::LimitedFileSize;
using testing::TemporaryFolder;
using testing::text_of;

TEST(OutputFile, appears_only_when_it_is_complete) {
  const TemporaryFolder folder;
  const auto path = folder / "data.bin";
  write_whole_file(path, "old");
  {
    OutputFile file(path);
    file.write("new content");
    EXPECT_EQ(text_of(path), "old");
    file.commit();
    EXPECT_EQ(text_of(path), "new content");
  }
  EXPECT_EQ(testing::files_in(folder.path()), 1u);
}

TEST(OutputFile, given_up_leaves_the_old_file_and_no_rubbish) {
  const TemporaryFolder folder;
  const auto path = folder / "data.bin";
  write_whole_file(path, "old");
  {
    OutputFile file(path);
    file.write("half");
  }
  EXPECT_EQ(text_of(path), "old");
  EXPECT_EQ(testing::files_in(folder.path()), 1u);
}

TEST(OutputFile, larger_than_its_buffer_is_written_whole_and_in_order) {
  const TemporaryFolder folder;
  std::string expected;
  OutputFile file(folder / "data.bin");
  for (int i = 0; i < 40; ++i) {
    const std::string piece(static_cast<std::size_t>(1) << (i % 20), static_cast<char>('a' + i % 26));
    file.write(piece);
    expected += piece;
  }
  file.commit(true);
  EXPECT_TRUE(text_of(folder / "data.bin") == expected);
}

TEST(OutputFile, on_a_full_disk_says_so_and_keeps_the_old_file) {
  const TemporaryFolder folder;
  const auto path = folder / "data.bin";
  write_whole_file(path, "old");
  // /dev/full is a device that always answers "no space left"; the part file is made to be it.
  std::filesystem::create_symlink("/dev/full", folder / "data.bin.part");
  OutputFile file(path);
  file.write("something");
  try {
    file.commit();
    FAIL() << "no error";
  } catch (const OutputError& error) {
    EXPECT_EQ(error.error_number, ENOSPC);
    EXPECT_NE(std::string(error.what()).find("No space left on device"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find(path.string()), std::string::npos) << error.what();
  }
  EXPECT_EQ(text_of(path), "old");
  EXPECT_FALSE(std::filesystem::is_symlink(folder / "data.bin.part"));
}

TEST(OutputFile, that_hits_a_size_limit_keeps_the_old_file) {
  const TemporaryFolder folder;
  const auto path = folder / "data.bin";
  write_whole_file(path, "old");
  {
    const LimitedFileSize limit(100000);
    OutputFile file(path);
    EXPECT_THROW(
        {
          file.write(std::string(500000, 'x'));
          file.commit();
        },
        OutputError);
  }
  EXPECT_EQ(text_of(path), "old");
  EXPECT_EQ(testing::files_in(folder.path()), 1u);
}

TEST(OutputFile, in_a_folder_that_vanished_says_so) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "run");
  OutputFile file(folder / "run/data.bin");
  file.write("x");
  std::filesystem::remove_all(folder / "run");
  EXPECT_THROW(file.commit(), OutputError);
  EXPECT_THROW(OutputFile(folder / "run/other.bin"), OutputError);
}

TEST(AppendFile, that_hits_a_full_disk_takes_the_half_record_back) {
  const TemporaryFolder folder;
  const auto path = folder / "table.csv";
  AppendFile file(path);
  file.append("header\n");
  file.append("row 1\n");
  {
    const LimitedFileSize limit(20);
    EXPECT_THROW(file.append("row 2, which is too long\n"), OutputError);
  }
  EXPECT_EQ(text_of(path), "header\nrow 1\n");
  file.append("row 2\n");
  EXPECT_EQ(text_of(path), "header\nrow 1\nrow 2\n");
}

TEST(AppendFile, continues_an_existing_file_and_notices_when_it_was_removed) {
  const TemporaryFolder folder;
  const auto path = folder / "log.txt";
  AppendFile(path).append("first\n");
  AppendFile file(path);
  file.append("second\n");
  EXPECT_EQ(text_of(path), "first\nsecond\n");
  std::filesystem::remove(path);
  EXPECT_THROW(file.append("third\n"), OutputError);
}

TEST(ReadWholeFile, of_a_missing_file_or_a_folder_is_an_input_error) {
  const TemporaryFolder folder;
  EXPECT_THROW(read_whole_file(folder / "none"), InputError);
  EXPECT_THROW(read_whole_file(folder.path()), InputError);
}

}  // namespace
}  // namespace imbibe
