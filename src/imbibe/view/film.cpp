#include "imbibe/view/film.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <vector>

#include "imbibe/core/error.h"

extern char** environ;

namespace imbibe {

std::optional<std::filesystem::path> find_ffmpeg() {
  const char* path = std::getenv("PATH");
  if (!path) return {};
  std::istringstream folders(path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    // An empty or relative entry means the working folder: a program lying there is not taken for ffmpeg.
    if (folder.empty() || folder[0] != '/') continue;
    const std::filesystem::path candidate = std::filesystem::path(folder) / "ffmpeg";
    std::error_code error;
    if (std::filesystem::is_regular_file(candidate, error) && access(candidate.c_str(), X_OK) == 0) return candidate;
  }
  return {};
}

struct FilmWriter::Process {
  std::filesystem::path path, part;
  int frames_per_second = 25;
  int width = 0, height = 0;
  pid_t child = 0;
  int channel = -1;  // our end of the socket that is the child's standard input
  int frames = 0;
  std::string problem;

  void start(const Image& first);
  void send_all(const std::uint8_t* data, std::size_t size);
  bool wait_for_child();
};

void FilmWriter::Process::start(const Image& first) {
  width = first.width;
  height = first.height;
  const std::optional<std::filesystem::path> program = find_ffmpeg();
  if (!program) {
    problem = "no film: ffmpeg is not installed (the pictures are there)";
    return;
  }
  // The encoder of a run that was killed lives on for a moment, and may open its output only now. So ours is given an open
  // file, not a name: two encoders never share one.
  std::error_code none;
  std::filesystem::remove(part, none);
  const int output = open(part.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (output < 0) {
    problem = std::string("no film: ") + std::strerror(errno);
    return;
  }
  const std::string size = std::to_string(width) + "x" + std::to_string(height);
  const std::string rate = std::to_string(frames_per_second);
  // Even sizes and yuv420p because many players know nothing else; faststart so that a browser can start at once.
  std::vector<std::string> words{program->string(), "-nostdin", "-loglevel", "error", "-y", "-f", "rawvideo",
                                 "-pixel_format", "rgb24", "-video_size", size, "-framerate", rate, "-i", "pipe:0",
                                 "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white,scale=out_color_matrix=bt709",
                                 "-c:v", "libx264", "-preset", "veryfast", "-crf", "17", "-pix_fmt", "yuv420p",
                                 "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709",
                                 "-fflags", "+bitexact", "-movflags", "+faststart", "-f", "mp4", "/proc/self/fd/3"};
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  // A socket rather than a pipe: send() can then be told not to raise SIGPIPE when the child has died.
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    problem = std::string("no film: no channel to ffmpeg: ") + std::strerror(errno);
    close(output);
    return;
  }
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, output, 3);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  // Its own process group: Ctrl-C reaches us, and we end the film properly.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  const int failure = posix_spawn(&child, program->c_str(), &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  close(output);
  if (failure != 0) {
    child = 0;
    close(ends[0]);
    problem = std::string("no film: ffmpeg did not start: ") + std::strerror(failure);
    return;
  }
  channel = ends[0];
}

void FilmWriter::Process::send_all(const std::uint8_t* data, std::size_t size) {
  while (size > 0) {
    const ssize_t sent = send(channel, data, size, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) {
      problem = "no film: ffmpeg stopped taking frames (the pictures are there)";
      return;
    }
    data += sent;
    size -= static_cast<std::size_t>(sent);
  }
}

bool FilmWriter::Process::wait_for_child() {
  if (channel >= 0) close(channel);
  channel = -1;
  if (child == 0) return false;
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  child = 0;
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

FilmWriter::FilmWriter(std::filesystem::path path, int frames_per_second) : process_(new Process) {
  IMBIBE_ASSERT(frames_per_second > 0);
  // Absolute, so that no file name can be read as an option or as a protocol of ffmpeg's.
  process_->path = std::filesystem::absolute(path);
  if (!std::filesystem::is_directory(process_->path.parent_path()))
    throw InputError("the folder of the film does not exist: " + process_->path.parent_path().string());
  process_->part = process_->path.string() + ".part";
  process_->frames_per_second = frames_per_second;
}

FilmWriter::~FilmWriter() {
  if (process_->child == 0) return;
  kill(process_->child, SIGTERM);
  process_->wait_for_child();
  std::error_code error;
  std::filesystem::remove(process_->part, error);
}

void FilmWriter::add(const Image& frame) {
  Process& p = *process_;
  if (p.frames == 0 && p.problem.empty()) p.start(frame);
  if (!p.problem.empty()) return;
  IMBIBE_ASSERT(frame.width == p.width && frame.height == p.height);
  p.send_all(frame.rgb.data(), frame.rgb.size());
  ++p.frames;
}

FilmResult FilmWriter::finish() {
  Process& p = *process_;
  if (p.problem.empty() && p.frames == 0) p.problem = "no film: there was no frame";
  const bool ended_well = p.wait_for_child();
  if (p.problem.empty() && !ended_well) p.problem = "no film: ffmpeg failed (the pictures are there)";
  std::error_code error;
  if (p.problem.empty()) std::filesystem::rename(p.part, p.path, error);
  if (error) p.problem = "no film: cannot write " + p.path.string() + ": " + error.message();
  if (!p.problem.empty()) {
    std::filesystem::remove(p.part, error);
    return {false, p.problem};
  }
  return {true, p.path.string()};
}

}  // namespace imbibe
