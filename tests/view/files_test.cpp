// PNG, film, and reading back the files of a run.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "imbibe/core/error.h"
#include "imbibe/core/output_file.h"
#include "imbibe/view/film.h"
#include "imbibe/view/png.h"
#include "imbibe/view/run_pictures.h"
#include "imbibe/view/vtp_reader.h"
#include "view/scenes.h"

namespace imbibe {
namespace {

namespace fs = std::filesystem;

class PictureFiles : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder = fs::path(testing::TempDir()) / (std::string("imbibe_view_") + test->name());
    fs::remove_all(folder);
    fs::create_directories(folder);
    if (const char* path = std::getenv("PATH")) path_before = path;
  }
  void TearDown() override {
    setenv("PATH", path_before.c_str(), 1);
    fs::remove_all(folder);
  }
  fs::path folder;
  std::string path_before;
};

Image coloured(int width, int height) {
  Image image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      image.pixel(x, y)[0] = static_cast<std::uint8_t>(3 * x);
      image.pixel(x, y)[1] = static_cast<std::uint8_t>(5 * y);
      image.pixel(x, y)[2] = static_cast<std::uint8_t>(x ^ y);
    }
  return image;
}

TEST_F(PictureFiles, PngReadsBackToTheSamePixels) {
  const Image image = coloured(67, 31);
  write_png(folder / "a.png", image);
  EXPECT_TRUE(read_png(folder / "a.png") == image);
  EXPECT_FALSE(fs::exists(folder / "a.png.part"));
}

TEST_F(PictureFiles, PngThatCannotBeWrittenSaysWhere) {
  const fs::path nowhere = folder / "missing" / "a.png";
  try {
    write_png(nowhere, Image(4, 4));
    FAIL() << "should have thrown";
  } catch (const OutputError& error) {
    EXPECT_NE(std::string(error.what()).find("missing"), std::string::npos) << error.what();
  }
  std::ofstream(folder / "b.png") << "not a picture";
  EXPECT_THROW(read_png(folder / "b.png"), InputError);
}

TEST_F(PictureFiles, WithoutFfmpegThereIsNoFilmAndAReason) {
  setenv("PATH", "", 1);
  EXPECT_FALSE(find_ffmpeg());
  FilmWriter film(folder / "film.mp4", 25);
  film.add(Image(64, 36));
  const FilmResult result = film.finish();
  EXPECT_FALSE(result.written);
  EXPECT_NE(result.message.find("ffmpeg"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder / "film.mp4"));
}

TEST_F(PictureFiles, AnFfmpegThatDiesIsNoErrorEither) {
  fs::create_directories(folder / "bin");
  std::ofstream(folder / "bin" / "ffmpeg") << "#!/bin/sh\nexit 3\n";
  fs::permissions(folder / "bin" / "ffmpeg", fs::perms::owner_all);
  setenv("PATH", (folder / "bin").c_str(), 1);
  FilmWriter film(folder / "film.mp4", 25);
  for (int i = 0; i < 20; ++i) film.add(Image(320, 180));  // more than a socket holds
  const FilmResult result = film.finish();
  EXPECT_FALSE(result.written);
  EXPECT_FALSE(fs::exists(folder / "film.mp4"));
  EXPECT_FALSE(fs::exists(folder / "film.mp4.part"));
}

TEST_F(PictureFiles, FilmIsWrittenWhereFfmpegIs) {
  ASSERT_TRUE(find_ffmpeg()) << "apt-packages.txt names ffmpeg";
  const fs::path path = folder / "film with space; $(touch x).mp4";  // no shell reads it
  FilmWriter film(path, 25);
  for (int i = 0; i < 5; ++i) film.add(coloured(65, 37));  // odd sizes are padded
  const FilmResult result = film.finish();
  EXPECT_TRUE(result.written) << result.message;
  const std::string content = read_whole_file(path);
  EXPECT_EQ(content.substr(4, 4), "ftyp");
  EXPECT_LT(content.find("moov"), content.find("mdat")) << "the index comes first, so that it plays while it loads";
}

TEST_F(PictureFiles, FilmNeedsAFolder) { EXPECT_THROW(FilmWriter(folder / "no" / "film.mp4", 25), InputError); }

TEST_F(PictureFiles, APicturesFolderHoldsNumberedPictures) {
  PictureOptions options;
  options.width = 64, options.height = 64, options.samples = 1;
  RunPictures pictures(folder, options);
  const Frame frame = test::drop_on_weave(4);
  EXPECT_EQ(pictures.add(frame), folder / "pictures" / "picture_000000.png");
  EXPECT_EQ(pictures.add(frame, 7), folder / "pictures" / "picture_000007.png");
  EXPECT_EQ(pictures.count(), 2);
  EXPECT_EQ(pictures.finish().written, find_ffmpeg().has_value());
  EXPECT_EQ(read_png(folder / "pictures" / "picture_000007.png").width, 64);
}

PolyData two_lines() {
  PolyData data;
  for (int i = 0; i < 5; ++i) data.points.push_back({0.1f * static_cast<float>(i), 2, 3});
  data.line_start = {0, 2, 5};
  data.add("saturation", std::vector<float>{0, 0.25f, 0.5f, 0.75f, 1});
  data.add("yarn", std::vector<std::int32_t>{0, 0, 1, 1, 1});
  return data;
}

TEST_F(PictureFiles, VtpReadsBackWhatWasWritten) {
  const PolyData written = two_lines();
  write_vtp(folder / "a.vtp", written, {0.5, 3});
  const PolyData read = read_vtp(folder / "a.vtp");
  EXPECT_EQ(read.points, written.points);
  EXPECT_EQ(read.line_start, written.line_start);
  ASSERT_NE(find_floats(read, "saturation"), nullptr);
  EXPECT_EQ(*find_floats(read, "saturation"), *find_floats(written, "saturation"));
  EXPECT_EQ(find_floats(read, "yarn"), nullptr) << "whole numbers are not floats";
  PolyData none;
  write_vtp(folder / "b.vtp", none, {});
  EXPECT_TRUE(read_vtp(folder / "b.vtp").points.empty());
}

TEST_F(PictureFiles, ADamagedVtpIsRefusedWhereverItIsCut) {
  write_vtp(folder / "a.vtp", two_lines(), {});
  const std::string whole = read_whole_file(folder / "a.vtp");
  const std::size_t end = whole.rfind("\n</AppendedData>");
  for (std::size_t length = 0; length < end; length += 7) {
    write_whole_file(folder / "cut.vtp", whole.substr(0, length));
    EXPECT_THROW(read_vtp(folder / "cut.vtp"), InputError) << length << " bytes";
  }
  std::string huge = whole;
  huge.replace(huge.find("NumberOfPoints=\"5\""), 18, "NumberOfPoints=\"5000000000000000000\"");
  write_whole_file(folder / "huge.vtp", huge);
  EXPECT_THROW(read_vtp(folder / "huge.vtp"), InputError);
  EXPECT_THROW(read_vtp(folder / "missing.vtp"), InputError);
}

}  // namespace
}  // namespace imbibe
