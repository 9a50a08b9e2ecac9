// Pictures and film of a run, made while it runs: pictures/picture_000000.png ... and film.mp4 in the run's folder.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "imbibe/scene/picture_options.h"
#include "imbibe/view/film.h"
#include "imbibe/view/frame.h"
#include "imbibe/view/picture.h"

namespace imbibe {

class RunPictures {
 public:
  // `folder`: the run folder; must exist. The stage is set by the first frame unless given.
  RunPictures(std::filesystem::path folder, PictureOptions options, std::optional<Stage> stage = {});
  // Draws the frame and returns the picture's path. Numbers count up from 0, or from `number` when given.
  std::filesystem::path add(const Frame& frame, std::optional<int> number = {});
  // Goes on with a film whose run was stopped: the pictures 0 to count - 1 that are there become its first frames. One
  // that is missing, damaged or of another size is left out.
  void take_up(int count);
  // Finishes the film. A film that cannot be made is said in the result, never thrown.
  FilmResult finish();
  int count() const { return count_; }

 private:
  std::filesystem::path folder_;
  PictureOptions options_;
  std::optional<Stage> stage_;
  std::unique_ptr<PictureSeries> series_;
  std::unique_ptr<FilmWriter> film_;
  int count_ = 0;
};

}  // namespace imbibe
