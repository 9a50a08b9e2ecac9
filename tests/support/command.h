// The built command (IMBIBE_COMMAND) driven from tests: run to its end, or started and signalled.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

namespace imbibe::test {

struct Outcome {
  int code = -1;  // -1: ended by a signal
  std::string output;  // of stdout and stderr
};

// `line` as a shell reads it.
inline Outcome run_line(const std::string& line) {
  FILE* pipe = popen(("exec 2>&1; " + line).c_str(), "r");
  Outcome outcome;
  std::array<char, 4096> buffer;
  while (const std::size_t n = fread(buffer.data(), 1, buffer.size(), pipe)) outcome.output.append(buffer.data(), n);
  const int status = pclose(pipe);
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

// The command with `arguments`; `before` is put in front of it, e.g. "ulimit -f 100;".
inline Outcome run_command(const std::string& arguments, const std::string& before = "") {
  return run_line(before + " IMBIBE_DATA_DIR='" IMBIBE_SOURCE_DIR "' '" IMBIBE_COMMAND "' " + arguments);
}

// Starts the command with its output thrown away, sends `signal_number` once `ready()` holds (looked at every
// millisecond, for at most a minute), and waits for its end: its exit code, or -1 when the signal ended it.
inline int signalled_command(std::vector<std::string> words, int signal_number, const std::function<bool()>& ready) {
  words.insert(words.begin(), IMBIBE_COMMAND);
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    setenv("IMBIBE_DATA_DIR", IMBIBE_SOURCE_DIR, 1);
    const int nothing = open("/dev/null", O_WRONLY);
    dup2(nothing, STDOUT_FILENO);
    dup2(nothing, STDERR_FILENO);
    execv(pointers[0], pointers.data());
    _exit(127);
  }
  for (int i = 0; i < 60000 && !ready(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  kill(child, signal_number);
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

inline std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace imbibe::test
