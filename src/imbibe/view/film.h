// A film (MP4, H.264, yuv420p) by piping frames into ffmpeg, where it is installed. Its absence is a stated fact, not
// an error: pictures remain.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "imbibe/view/image.h"

namespace imbibe {

// The program's full path, looked up in PATH; nothing when there is none.
std::optional<std::filesystem::path> find_ffmpeg();

struct FilmResult {
  bool written = false;
  std::string message;  // where the film is, or why there is none
};

// Opens with the first frame, writes `path`.part.mp4 and renames it when finished. The child gets no shell and only
// a fixed argument list; the output path must not begin with '-' (it is made absolute) and its folder must exist.
class FilmWriter {
 public:
  FilmWriter(std::filesystem::path path, int frames_per_second);
  ~FilmWriter();  // an unfinished film is removed
  FilmWriter(const FilmWriter&) = delete;
  FilmWriter& operator=(const FilmWriter&) = delete;

  void add(const Image& frame);  // all frames of the first one's size
  FilmResult finish();

 private:
  struct Process;
  std::unique_ptr<Process> process_;
};

}  // namespace imbibe
