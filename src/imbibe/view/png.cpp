#include "imbibe/view/png.h"

#include <png.h>

#include <csetjmp>
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

void append(png_structp png, png_bytep data, png_size_t size) {
  auto& bytes = *static_cast<std::vector<std::uint8_t>*>(png_get_io_ptr(png));
  bytes.insert(bytes.end(), data, data + size);
}

// libpng leaves by longjmp on an error: no object with a destructor lives in this function.
bool encode(const Image& image, std::vector<std::uint8_t>& bytes) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  if (!png) return false;
  png_infop info = png_create_info_struct(png);
  if (!info || setjmp(png_jmpbuf(png))) {
    png_destroy_write_struct(&png, &info);
    return false;
  }
  png_set_write_fn(png, &bytes, append, nullptr);
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height), 8,
               PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB_gAMA_and_cHRM(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  // A third of the time of the default level for a few per cent more bytes.
  png_set_compression_level(png, 3);
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB | PNG_FILTER_UP);
  png_write_info(png, info);
  for (int y = 0; y < image.height; ++y) png_write_row(png, image.pixel(0, y));
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return true;
}

}  // namespace

void write_png(const std::filesystem::path& path, const Image& image) {
  IMBIBE_ASSERT(image.width > 0 && image.height > 0);
  // In memory first: the file is then written by OutputFile, which knows what to say when the disk is full.
  std::vector<std::uint8_t> bytes;
  if (!encode(image, bytes)) throw cannot("encode", path, "libpng gave up");
  OutputFile file(path);
  file.write(bytes.data(), bytes.size());
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
