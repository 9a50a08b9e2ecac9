// Files that are whole at any moment, whatever happens to the disk, the folder or the program meanwhile.
//   OutputFile  is written beside its place (path + ".part") and renamed into it when complete; a reader sees the old
//               file or the new one, never half of one.
//   AppendFile  grows by whole records; a record that does not fit on the disk is taken back.
// POSIX calls rather than streams, because the reason of a failure (disk full, folder gone, not allowed) must reach
// the user. Tested in tests/io/output_file_test.cpp.
#pragma once

#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace imbibe {

// The machine would not take our output: disk full, folder vanished or not writable. A run-time failure (exit code 1),
// not a mistake in the scene.
class OutputError : public std::runtime_error {
 public:
  OutputError(const std::filesystem::path& path_, const std::string& what_failed, int error_number);
  std::filesystem::path path;
  int error_number;  // errno
};

class OutputFile {
 public:
  explicit OutputFile(std::filesystem::path path);
  ~OutputFile();  // without commit(): the .part is removed, the old file stays
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(const void* data, std::size_t bytes);
  void write(std::string_view text) { write(text.data(), text.size()); }

  // Renames the complete file into place. `durable`: wait until it is on the disk first, so that a power cut cannot
  // leave an empty file under the final name (checkpoints).
  void commit(bool durable = false);

 private:
  void flush();
  void fail(const char* what);

  std::filesystem::path path_, part_;
  int file_ = -1;
  std::vector<char> buffer_;
};

class AppendFile {
 public:
  AppendFile() = default;
  explicit AppendFile(std::filesystem::path path);  // creates it, or continues at its end
  ~AppendFile();
  AppendFile(AppendFile&& other) noexcept;
  AppendFile& operator=(AppendFile&& other) noexcept;

  void append(std::string_view record);
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  int file_ = -1;
};

// The whole of a small text file in one go.
void write_whole_file(const std::filesystem::path& path, std::string_view text);
// Throws InputError when it cannot be read, or holds more than `most_bytes`: also of what never ends, as a device may.
std::string read_whole_file(const std::filesystem::path& path, std::size_t most_bytes = static_cast<std::size_t>(-1));

}  // namespace imbibe
