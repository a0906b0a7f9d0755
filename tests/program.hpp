// Runs the program under test as a process of its own.
#pragma once

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/folder.hpp"
#include "tests/support.hpp"

namespace apothem::test {

struct Result {
  int code;
  std::string out, err;
};

struct Limits {
  rlim_t file_size = RLIM_INFINITY;
  double interrupt_after = 0;  // s
  int signal = SIGINT;         // that interrupts
  std::string once_exists{};   // the interrupt waits for this file
  rlim_t memory = RLIM_INFINITY, descriptors = RLIM_INFINITY;
  bool closed_screens = false;             // no standard output, no standard error
  std::vector<std::string> environment{};  // NAME=VALUE, more than that of this process
  double most_seconds = HUGE_VAL;          // of real time, then the program is killed
};

/// What becomes of the child process before the program is in it.
inline void set_up(const Limits& limits, const std::string& out, const std::string& err) {
  const auto limit = [](auto kind, rlim_t most) {
    const rlimit both{most, most};
    if (most != RLIM_INFINITY) setrlimit(kind, &both);
  };
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_DFL);  // not Catch2's
  for (const std::string& variable : limits.environment) {
    const size_t at = variable.find('=');
    setenv(variable.substr(0, at).c_str(), variable.substr(at + 1).c_str(), 1);
  }
  dup2(::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600), 1);
  dup2(::open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600), 2);
  if (limits.closed_screens) ::close(1), ::close(2);
  limit(RLIMIT_FSIZE, limits.file_size);
  limit(RLIMIT_NOFILE, limits.descriptors);
  if (!kSanitized) limit(RLIMIT_AS, limits.memory);  // a sanitizer maps terabytes
}

/// The status of a child process, which is killed after so many seconds of real time.
inline int status_of(pid_t child, double most_seconds) {
  int status = 0;
  const auto start = std::chrono::steady_clock::now();
  while (most_seconds < HUGE_VAL) {
    if (waitpid(child, &status, WNOHANG) == child) return status;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    const std::chrono::duration<double> since = std::chrono::steady_clock::now() - start;
    if (since.count() < most_seconds) continue;
    kill(child, SIGKILL);
    break;
  }
  waitpid(child, &status, 0);
  return status;
}

inline Result run(std::vector<std::string> arguments, const Folder& folder,
                  const Limits& limits = {}) {
  arguments.insert(arguments.begin(), kProgram);
  const std::string out = folder / "stdout", err = folder / "stderr";
  const pid_t child = fork();
  if (child == 0) {
    set_up(limits, out, err);
    std::vector<char*> argv;
    for (std::string& a : arguments) argv.push_back(a.data());
    argv.push_back(nullptr);
    execv(argv[0], argv.data());
    _exit(127);
  }
  if (limits.interrupt_after > 0) {
    for (int i = 0; i < 6000 && !limits.once_exists.empty(); ++i) {
      if (std::filesystem::exists(limits.once_exists)) break;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    std::this_thread::sleep_for(std::chrono::duration<double>(limits.interrupt_after));
    kill(child, limits.signal);
  }
  const int status = status_of(child, limits.most_seconds);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), content(out), content(err)};
}

inline int lines(const std::string& text) {
  return static_cast<int>(std::count(text.begin(), text.end(), '\n'));
}

/// A text with the first `what` exchanged.
inline std::string exchanged(std::string text, const std::string& what, const std::string& by) {
  const size_t at = text.find(what);
  if (at == std::string::npos) throw std::logic_error("\"" + what + "\" is not in the text");
  return text.replace(at, what.size(), by);
}

}  // namespace apothem::test
