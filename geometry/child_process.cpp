#include "geometry/child_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <new>
#include <optional>

namespace apothem {
namespace {

constexpr double kMemory = 4e9;  // bytes, beyond what the parent has
constexpr double kWait = 10;     // a busy machine may take so many times the processor time

enum ExitCode { kDone = 0, kException = 1, kNoMemory = 2 };

void write_all(int file, const std::vector<double>& numbers) {
  const char* data = reinterpret_cast<const char*>(numbers.data());
  size_t left = numbers.size() * sizeof(double);
  while (left > 0) {
    const ssize_t written = write(file, data, left);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) _exit(kException);
    data += written;
    left -= static_cast<size_t>(written);
  }
}

void limit(decltype(RLIMIT_CPU) what, double most) {
  const auto value = static_cast<rlim_t>(most);
  const rlimit both{value, value};
  setrlimit(what, &both);
}

// The memory that this process has mapped; a sanitizer maps terabytes.
double mapped_bytes() {
  unsigned long pages = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "re")) {
    if (std::fscanf(file, "%lu", &pages) != 1) pages = 0;
    std::fclose(file);
  }
  return static_cast<double>(pages) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

// The child inherits whatever the program does with signals, and must do none of it.
[[noreturn]] void work_as_child(int file, const std::function<std::vector<double>()>& work,
                                double seconds) {
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGILL, SIGTERM, SIGINT}) {
    std::signal(signal, SIG_DFL);
  }
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, std::ceil(seconds));
  limit(RLIMIT_AS, mapped_bytes() + kMemory);
  const int silence = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (silence >= 0) {
    dup2(silence, STDOUT_FILENO);
    dup2(silence, STDERR_FILENO);
  }
  try {
    write_all(file, work());
  } catch (const std::bad_alloc&) {
    _exit(kNoMemory);
  } catch (...) {
    _exit(kException);
  }
  _exit(kDone);
}

// Reads to the end of the file; nothing when time is up first.
std::optional<std::vector<double>> read_until(int file,
                                              std::chrono::steady_clock::time_point deadline) {
  std::vector<char> bytes;
  char buffer[65536];
  while (true) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
        deadline - std::chrono::steady_clock::now());
    if (left.count() <= 0) return std::nullopt;
    pollfd wait{file, POLLIN, 0};
    const int ready = poll(&wait, 1, static_cast<int>(std::min<long long>(left.count(), 1000)));
    if (ready <= 0) continue;
    const ssize_t count = read(file, buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    bytes.insert(bytes.end(), buffer, buffer + count);
  }
  std::vector<double> numbers(bytes.size() / sizeof(double));
  std::copy_n(bytes.data(), numbers.size() * sizeof(double),
              reinterpret_cast<char*>(numbers.data()));
  return numbers;
}

std::string failure(int status, double seconds) {
  if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL)) {
    return "did not return within " + std::to_string(std::lround(std::ceil(seconds))) + " s";
  }
  if (WIFSIGNALED(status)) return "crashed with signal " + std::to_string(WTERMSIG(status));
  if (WEXITSTATUS(status) == kNoMemory) return "ran out of memory";
  return WEXITSTATUS(status) == kDone ? "" : "failed with an exception";
}

}  // namespace

ChildAnswer in_child_process(const std::function<std::vector<double>()>& work, double seconds) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return {{}, "could not get a pipe to a child process"};
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    work_as_child(ends[1], work, seconds);
  }
  close(ends[1]);
  if (child < 0) {
    close(ends[0]);
    return {{}, "could not start a child process"};
  }
  const auto deadline = std::chrono::steady_clock::now() +
                        std::chrono::milliseconds(static_cast<long long>(1000 * kWait * seconds));
  const std::optional<std::vector<double>> numbers = read_until(ends[0], deadline);
  close(ends[0]);
  if (!numbers) kill(child, SIGKILL);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return {numbers.value_or(std::vector<double>{}), failure(status, seconds)};
}

}  // namespace apothem
