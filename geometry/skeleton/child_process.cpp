#include "apothem/geometry/skeleton/child_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>

namespace apothem {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kMemory = 4e9;  // bytes that the child may map beyond what the parent has mapped
constexpr double kWait = 10;     // limit of the time by the clock over that of the processor time
constexpr int kLook = 100;       // ms between two calls of `meanwhile`

void write_all(int file, const std::vector<double>& numbers) {
  const char* data = reinterpret_cast<const char*>(numbers.data());
  size_t left = numbers.size() * sizeof(double);
  while (left > 0) {
    const ssize_t written = write(file, data, left);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) _exit(1);  // the parent has closed the pipe
    data += written;
    left -= static_cast<size_t>(written);
  }
}

// The kernel ends the process after so much more processor time. This also works if the parent has
// died and cannot kill its child any more.
void limit_processor_time(double seconds) {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  rlimit time{};
  getrlimit(RLIMIT_CPU, &time);
  time.rlim_cur =
      std::min(time.rlim_max, static_cast<rlim_t>(used.ru_utime.tv_sec + used.ru_stime.tv_sec + 1) +
                                  static_cast<rlim_t>(std::ceil(seconds)));
  setrlimit(RLIMIT_CPU, &time);
}

// The memory that this process has mapped, in bytes. The limit has to be counted from there, since
// a sanitizer maps terabytes.
double mapped_bytes() {
  unsigned long pages = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "re")) {
    if (std::fscanf(file, "%lu", &pages) != 1) pages = 0;
    std::fclose(file);
  }
  return static_cast<double>(pages) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

// The child has inherited the program's signal handlers and must not run any of them. An interrupt
// from the terminal reaches it too; the parent sees it as well and ends the child.
[[noreturn]] void work_as_child(int file, const std::function<void(const SendNumbers&)>& work,
                                double seconds, pid_t parent) {
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGILL, SIGTERM, SIGINT}) {
    std::signal(signal, SIG_DFL);
  }
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);  // it has died already
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  limit_processor_time(seconds);
  const auto most = static_cast<rlim_t>(mapped_bytes() + kMemory);
  const rlimit memory{most, most};
  setrlimit(RLIMIT_AS, &memory);
  const int silence = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (silence >= 0) {
    dup2(silence, STDOUT_FILENO);
    dup2(silence, STDERR_FILENO);
  }
  try {
    work([&](const std::vector<double>& numbers) {
      write_all(file, numbers);
      limit_processor_time(seconds);
    });
  } catch (...) {
    _exit(1);
  }
  _exit(0);
}

// Reads the numbers that come through the pipe until it is closed. Returns false if nothing has
// come for kWait * seconds by the clock.
bool read_to_end(int file, double seconds, const std::function<void()>& meanwhile,
                 std::vector<double>& numbers) {
  std::vector<char> bytes;
  char buffer[65536];
  const auto patience = std::chrono::milliseconds(static_cast<long long>(1000 * kWait * seconds));
  Clock::time_point deadline = Clock::now() + patience;
  bool ended = false;
  while (!ended) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now());
    if (left.count() <= 0) break;
    pollfd wait{file, POLLIN, 0};
    const int ready = poll(&wait, 1, static_cast<int>(std::min<long long>(left.count(), kLook)));
    if (meanwhile) meanwhile();
    if (ready <= 0) continue;
    const ssize_t count = read(file, buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    ended = count <= 0;
    if (!ended) bytes.insert(bytes.end(), buffer, buffer + count);
    deadline = Clock::now() + patience;
  }
  numbers.resize(bytes.size() / sizeof(double));
  std::copy_n(bytes.data(), numbers.size() * sizeof(double),
              reinterpret_cast<char*>(numbers.data()));
  return ended;
}

// An open file, closed at the end of its scope.
class File {
 public:
  explicit File(int file) : file_(file) {}
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() { close(file_); }

 private:
  int file_;
};

// A child process, killed at the end of its scope unless it has been waited for.
class Child {
 public:
  explicit Child(pid_t id) : id_(id) {}
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    if (id_ <= 0 || waited_) return;
    end();
    wait();
  }
  [[nodiscard]] pid_t id() const { return id_; }
  void end() const { kill(id_, SIGKILL); }
  int wait() {
    int status = 0;
    while (waitpid(id_, &status, 0) < 0 && errno == EINTR) {
    }
    waited_ = true;
    return status;
  }

 private:
  pid_t id_;
  bool waited_ = false;
};

}  // namespace

std::string ChildAnswer::failure() const {
  switch (end) {
    case End::finished:
      return "";
    case End::failed:
      return "failed with an exception or for lack of memory";
    case End::crashed:
      return "crashed with signal " + std::to_string(signal);
    case End::silent:
      return "did not return in time";
    case End::not_started:
      break;
  }
  return "could not be started in a child process";
}

ChildAnswer run_in_child(const std::function<void(const SendNumbers&)>& work, double seconds,
                         const std::function<void()>& meanwhile) {
  using End = ChildAnswer::End;
  ChildAnswer answer;
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return answer;
  const pid_t parent = getpid();
  Child child(fork());
  if (child.id() == 0) {
    close(ends[0]);
    work_as_child(ends[1], work, seconds, parent);
  }
  close(ends[1]);
  const File pipe(ends[0]);
  if (child.id() < 0) return answer;
  const bool ended = read_to_end(ends[0], seconds, meanwhile, answer.numbers);
  if (!ended) child.end();
  const int status = child.wait();
  if (!ended) {
    answer.end = End::silent;
  } else if (WIFSIGNALED(status)) {
    answer.end = WTERMSIG(status) == SIGXCPU ? End::silent : End::crashed;
    answer.signal = WTERMSIG(status);
  } else {
    answer.end = WEXITSTATUS(status) == 0 ? End::finished : End::failed;
  }
  return answer;
}

}  // namespace apothem
