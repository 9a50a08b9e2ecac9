#include "imbibe/view/png.h"

#include <png.h>

#include <string>
#include <vector>

#include "imbibe/core/error.h"
#include "imbibe/core/output_file.h"

namespace imbibe {

namespace {

InputError cannot(const char* doing, const std::filesystem::path& path, const char* why) {
  return InputError(std::string("cannot ") + doing + " picture " + path.string() + ": " + why);
}

// The simplified libpng interface owns memory until it is freed.
struct PngImage : png_image {
  PngImage() : png_image{} { version = PNG_IMAGE_VERSION; }
  ~PngImage() { png_image_free(this); }
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;
};

}  // namespace

void write_png(const std::filesystem::path& path, const Image& image) {
  IMBIBE_ASSERT(image.width > 0 && image.height > 0);
  PngImage png;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  // In memory first: the file is then written by OutputFile, which knows what to say when the disk is full.
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::vector<std::uint8_t> bytes(size);
  if (!png_image_write_to_memory(&png, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr))
    throw cannot("encode", path, png.message);
  OutputFile file(path);
  file.write(bytes.data(), size);
  file.commit();
}

Image read_png(const std::filesystem::path& path) {
  PngImage png;
  if (!png_image_begin_read_from_file(&png, path.c_str())) throw cannot("read", path, png.message);
  png.format = PNG_FORMAT_RGB;
  if (png.width > 65535 || png.height > 65535) throw cannot("read", path, "larger than 65535 pixels");
  Image image(static_cast<int>(png.width), static_cast<int>(png.height));
  const png_color white{255, 255, 255};
  if (!png_image_finish_read(&png, &white, image.rgb.data(), 0, nullptr)) throw cannot("read", path, png.message);
  return image;
}

}  // namespace imbibe
