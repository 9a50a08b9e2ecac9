#include "imbibe/core/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "imbibe/core/error.h"

namespace imbibe {

namespace {

constexpr std::size_t buffer_bytes = std::size_t{1} << 18;

std::string advice(int error_number) {
  switch (error_number) {
    case ENOSPC:
    case EDQUOT: return "; free some space and continue with --resume";
    case EFBIG: return "; a file size limit (ulimit -f) is set";
    case ENOENT: return "; was the folder removed during the run?";
    case EACCES:
    case EPERM:
    case EROFS: return "; choose another folder with -o";
    default: return "";
  }
}

// Writes all of it, or returns errno.
int write_all(int file, const char* data, std::size_t bytes) {
  while (bytes > 0) {
    const ssize_t written = ::write(file, data, bytes);
    if (written < 0) {
      if (errno == EINTR) continue;
      return errno;
    }
    data += written;
    bytes -= static_cast<std::size_t>(written);
  }
  return 0;
}

}  // namespace

OutputError::OutputError(const std::filesystem::path& path_, const std::string& what_failed, int number)
    : std::runtime_error(what_failed + " " + path_.string() + ": " + std::strerror(number) + advice(number) +
                         ". Files written before are intact."),
      path(path_),
      error_number(number) {}

OutputFile::OutputFile(std::filesystem::path path) : path_(std::move(path)), part_(path_) {
  part_ += ".part";
  file_ = ::open(part_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file_ < 0) throw OutputError(path_, "cannot write", errno);
  buffer_.reserve(buffer_bytes);
}

OutputFile::~OutputFile() {
  if (file_ < 0) return;
  ::close(file_);
  ::unlink(part_.c_str());
}

void OutputFile::fail(const char* what) {
  const int number = errno;
  if (file_ >= 0) ::close(std::exchange(file_, -1));
  ::unlink(part_.c_str());
  throw OutputError(path_, what, number);
}

void OutputFile::flush() {
  if (const int number = write_all(file_, buffer_.data(), buffer_.size())) {
    errno = number;
    fail("cannot write");
  }
  buffer_.clear();
}

void OutputFile::write(const void* data, std::size_t bytes) {
  IMBIBE_ASSERT(file_ >= 0);
  const char* from = static_cast<const char*>(data);
  if (buffer_.size() + bytes > buffer_bytes) flush();
  if (bytes <= buffer_bytes) {
    buffer_.insert(buffer_.end(), from, from + bytes);
  } else if (const int number = write_all(file_, from, bytes)) {
    errno = number;
    fail("cannot write");
  }
}

void OutputFile::commit(bool durable) {
  IMBIBE_ASSERT(file_ >= 0);
  flush();
  if (durable && ::fsync(file_) != 0 && errno != EINVAL) fail("cannot write");  // EINVAL: not a real disk
  // A network file system may report a full disk only here.
  if (::close(std::exchange(file_, -1)) != 0) fail("cannot write");
  if (::rename(part_.c_str(), path_.c_str()) != 0) fail("cannot put in place");
}

AppendFile::AppendFile(std::filesystem::path path) : path_(std::move(path)) {
  file_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (file_ < 0) throw OutputError(path_, "cannot write", errno);
}

AppendFile::~AppendFile() {
  if (file_ >= 0) ::close(file_);
}

AppendFile::AppendFile(AppendFile&& other) noexcept
    : path_(std::move(other.path_)), file_(std::exchange(other.file_, -1)) {}

AppendFile& AppendFile::operator=(AppendFile&& other) noexcept {
  if (this == &other) return *this;
  if (file_ >= 0) ::close(file_);
  path_ = std::move(other.path_);
  file_ = std::exchange(other.file_, -1);
  return *this;
}

void AppendFile::append(std::string_view record) {
  IMBIBE_ASSERT(file_ >= 0);
  struct stat before {};
  if (::fstat(file_, &before) != 0) throw OutputError(path_, "cannot write", errno);
  // An unlinked file takes writes without complaint, and they are lost.
  if (before.st_nlink == 0) throw OutputError(path_, "cannot write", ENOENT);
  if (const int number = write_all(file_, record.data(), record.size())) {
    // Best effort: a half record at the end of a table is worse than a missing one. Not possible on a device.
    if (S_ISREG(before.st_mode) && ::ftruncate(file_, before.st_size) != 0) {
    }
    throw OutputError(path_, "cannot write", number);
  }
}

void write_whole_file(const std::filesystem::path& path, std::string_view text) {
  OutputFile file(path);
  file.write(text);
  file.commit();
}

std::string read_whole_file(const std::filesystem::path& path, std::size_t most_bytes) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) throw InputError("cannot read " + path.string() + ": " + std::strerror(errno));
  std::string text;
  char piece[1 << 16];
  ssize_t got = 0;
  while ((got = ::read(file, piece, sizeof piece)) > 0 || (got < 0 && errno == EINTR)) {
    if (got > 0) text.append(piece, static_cast<std::size_t>(got));
    if (text.size() > most_bytes) {
      ::close(file);
      throw InputError(std::vector{Problem{path.string(), 0, 0, "", "is larger than " + std::to_string(most_bytes >> 20) +
                                                                        " MiB, the most that is read"}});
    }
  }
  const int number = errno;
  ::close(file);
  if (got < 0) throw InputError("cannot read " + path.string() + ": " + std::strerror(number));
  return text;
}

}  // namespace imbibe
