#include "imbibe/view/run_pictures.h"

#include <fmt/format.h>

#include "imbibe/core/error.h"
#include "imbibe/view/png.h"

namespace imbibe {

RunPictures::RunPictures(std::filesystem::path folder, PictureOptions options, std::optional<Stage> stage)
    : folder_(std::move(folder)), options_(std::move(options)), stage_(std::move(stage)) {
  std::error_code error;
  std::filesystem::create_directories(folder_ / "pictures", error);
  if (error) throw InputError("cannot make the folder of the pictures in " + folder_.string() + ": " + error.message());
  if (options_.film) film_ = std::make_unique<FilmWriter>(folder_ / "film.mp4", options_.frames_per_second);
}

std::filesystem::path RunPictures::add(const Frame& frame, std::optional<int> number) {
  if (!stage_) stage_ = stage_for(frame, options_);
  if (!series_) series_ = std::make_unique<PictureSeries>(*stage_, options_);
  const Image image = series_->draw(frame);
  const std::filesystem::path path = folder_ / "pictures" / fmt::format("picture_{:06}.png", number.value_or(count_));
  write_png(path, image);
  if (film_) film_->add(image);
  ++count_;
  return path;
}

void RunPictures::take_up(int count) {
  count_ = count;
  for (int i = 0; film_ && i < count; ++i) {
    try {
      const Image image = read_png(folder_ / "pictures" / fmt::format("picture_{:06}.png", i));
      if (image.width == options_.width && image.height == options_.height) film_->add(image);
    } catch (const InputError&) {  // the film is shorter by this frame
    }
  }
}

FilmResult RunPictures::finish() {
  if (!film_) return {false, "no film was asked for"};
  const FilmResult result = film_->finish();
  film_.reset();
  return result;
}

}  // namespace imbibe
