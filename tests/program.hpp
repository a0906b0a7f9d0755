// Runs the program under test as a process of its own.
#pragma once

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "folder.hpp"
#include "support.hpp"

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
};

inline Result run(std::vector<std::string> arguments, const Folder& folder,
                  const Limits& limits = {}) {
  arguments.insert(arguments.begin(), kProgram);
  const std::string out = folder / "stdout", err = folder / "stderr";
  const pid_t child = fork();
  if (child == 0) {
    if (limits.file_size != RLIM_INFINITY) {
      const rlimit limit{limits.file_size, limits.file_size};
      setrlimit(RLIMIT_FSIZE, &limit);
    }
    dup2(::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), 1);
    dup2(::open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), 2);
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
  int status = 0;
  waitpid(child, &status, 0);
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
