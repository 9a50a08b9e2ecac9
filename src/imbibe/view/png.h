// PNG files by libpng: 8-bit RGB.
#pragma once

#include <filesystem>

#include "imbibe/view/image.h"

namespace imbibe {

// Writes beside `path` and renames, so a reader never sees half a picture. OutputError when the file cannot be written.
void write_png(const std::filesystem::path& path, const Image& image);
Image read_png(const std::filesystem::path& path);

}  // namespace imbibe
