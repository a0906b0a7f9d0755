#include "geometry/skeleton/helper_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <system_error>

#include "geometry/skeleton/helper_side.hpp"
#include "lib/system/clock.hpp"

namespace apothem {
namespace {

constexpr int kFailed = 1;  // exit code of helper_side.cpp where the work has failed
constexpr std::chrono::milliseconds kLook{100};  // between two calls of `meanwhile`
constexpr int kFree = 3;  // file descriptors below are standard input, output and error

[[noreturn]] void fail(int error, const std::string& what) {
  throw std::system_error(error, std::generic_category(), what);
}

// An open file, closed at the end of its scope.
class File {
 public:
  explicit File(int file) : file_(file) {}
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() { close(file_); }
  [[nodiscard]] int number() const { return file_; }

 private:
  int file_;
};

// A file descriptor that is not one of the standard ones, even if this program has closed those.
int above_standard(int file) {
  if (file < 0 || file >= kFree) return file;
  const int other = fcntl(file, F_DUPFD_CLOEXEC, kFree);
  close(file);
  return other;
}

// The request, as a file in memory. In contrast to a pipe, it takes any amount before somebody
// reads, and writing to it raises no SIGPIPE.
std::unique_ptr<File> file_of(const std::vector<double>& request) {
  auto file = std::make_unique<File>(above_standard(memfd_create("request", MFD_CLOEXEC)));
  const char* data = reinterpret_cast<const char*>(request.data());
  size_t left = request.size() * sizeof(double);
  while (left > 0) {
    const ssize_t written = write(file->number(), data, left);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail(errno, "request to a helper program");
    data += written;
    left -= static_cast<size_t>(written);
  }
  lseek(file->number(), 0, SEEK_SET);
  return file;
}

// Starts the program with these files as standard input and output, and with no others. It has no
// signal handlers, and a process group of its own, so that the terminal interrupts only us.
pid_t start(const std::string& program, int input, int output, double seconds) {
  std::string name = program, parent = std::to_string(getpid());
  std::string limit = std::to_string(static_cast<long long>(std::ceil(seconds)));
  const std::array<char*, 4> arguments{name.data(), parent.data(), limit.data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addclosefrom_np(&actions, kFree);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t signals;
  sigemptyset(&signals);
  posix_spawnattr_setsigmask(&attributes, &signals);
  sigfillset(&signals);
  posix_spawnattr_setsigdefault(&attributes, &signals);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes,
                           POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  pid_t id = 0;
  const int error =
      posix_spawn(&id, program.c_str(), &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) fail(error, "the helper program " + program + " cannot be started");
  return id;
}

// How long the machine has been up, by what the kernel says in a file: programs that are shown
// another time by their environment wait as long as others.
class Uptime {
 public:
  Uptime() : file_(open("/proc/uptime", O_RDONLY | O_CLOEXEC)) {}
  [[nodiscard]] Clock::duration now() const {
    char text[64] = {};
    if (pread(file_.number(), text, sizeof text - 1, 0) <= 0)
      return Clock::now().time_since_epoch();
    const double seconds = std::strtod(text, nullptr);
    return std::chrono::milliseconds(static_cast<long long>(1000 * seconds));
  }

 private:
  File file_;
};

// A child process, killed at the end of its scope unless it has been waited for.
class Child {
 public:
  explicit Child(pid_t id) : id_(id) {}
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    if (waited_) return;
    end();
    wait();
  }
  void end() const { kill(id_, SIGKILL); }
  // That it has used, s.
  [[nodiscard]] double processor_time() const {
    clockid_t clock{};
    timespec used{};
    if (clock_getcpuclockid(id_, &clock) != 0 || clock_gettime(clock, &used) != 0) return 0;
    return in_seconds(used);
  }
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

// A helper at work, and what it has sent so far.
class Worker {
 public:
  // Starts the helper.
  Worker(const StartProcess& start, double patience)
      : patience_(std::chrono::milliseconds(static_cast<long long>(1000 * patience))),
        left_(patience_) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) fail(errno, "pipe of a helper program");
    pipe_ = std::make_unique<File>(ends[0]);
    const File output(above_standard(ends[1]));
    child_ = std::make_unique<Child>(start(output.number()));
  }

  [[nodiscard]] bool reading() const { return reading_; }
  [[nodiscard]] int file() const { return pipe_->number(); }
  // Nothing was there to be read for this long. A helper that has done nothing for too long is
  // ended. One that works is left to its limit of processor time, however slow the machine is.
  void wait(Clock::duration time) {
    const double used = child_->processor_time();
    if (used > used_) {
      used_ = used;
      left_ = patience_;
      return;
    }
    left_ -= time;
    if (left_.count() > 0) return;
    child_->end();
    reading_ = false;
    stalled_ = true;
  }
  // Reads what is there.
  void read() {
    char buffer[65536];
    const ssize_t count = ::read(pipe_->number(), buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) return;
    if (count > 0) bytes_.insert(bytes_.end(), buffer, buffer + count);
    reading_ = count > 0;
    left_ = patience_;
  }

  // Waits for the end of the helper.
  HelperAnswer answer() {
    using End = HelperAnswer::End;
    HelperAnswer answer;
    answer.numbers.resize(bytes_.size() / sizeof(double));
    std::copy_n(bytes_.data(), answer.numbers.size() * sizeof(double),
                reinterpret_cast<char*>(answer.numbers.data()));
    const int status = child_->wait();
    answer.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    answer.code = WIFSIGNALED(status) ? 0 : WEXITSTATUS(status);
    answer.end = stalled_                 ? End::stalled
                 : answer.signal != 0     ? end_by(answer.signal)
                 : answer.code == 0       ? End::finished
                 : answer.code == kFailed ? End::failed
                                          : End::prevented;
    return answer;
  }

 private:
  // Signals that a program raises by what it does itself; others come from outside.
  static HelperAnswer::End end_by(int signal) {
    using End = HelperAnswer::End;
    if (signal == SIGXCPU) return End::overran;
    constexpr std::array kOwn{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP, SIGSYS};
    return std::ranges::find(kOwn, signal) != kOwn.end() ? End::crashed : End::prevented;
  }

  Clock::duration patience_, left_;  // to the next sign of life
  std::unique_ptr<File> pipe_;
  std::unique_ptr<Child> child_;
  std::vector<char> bytes_;
  bool reading_ = true;
  double used_ = 0;  // processor time at the last sign of work, s
  bool stalled_ = false;
};

}  // namespace

std::string HelperAnswer::failure() const {
  switch (end) {
    case End::finished:
      break;
    case End::failed:
      return "failed with an exception or for lack of memory";
    case End::crashed:
      return "crashed with signal " + std::to_string(signal);
    case End::overran:
      return "did not return in its processor time";
    case End::stalled:
      return "did nothing for a long time";
    case End::prevented:
      return signal != 0              ? "was killed by signal " + std::to_string(signal)
             : code == kWithoutMemory ? "was refused memory"
                                      : "ended with the code " + std::to_string(code);
  }
  return "";
}

std::vector<HelperAnswer> run_helpers(const std::string& program,
                                      const std::vector<std::vector<double>>& requests,
                                      double seconds, const std::function<void()>& meanwhile,
                                      double patience) {
  std::vector<StartProcess> starts;
  starts.reserve(requests.size());
  for (const std::vector<double>& request : requests) {
    starts.emplace_back(
        [&](int output) { return start(program, file_of(request)->number(), output, seconds); });
  }
  return run_processes(starts, meanwhile, patience);
}

std::vector<HelperAnswer> run_processes(const std::vector<StartProcess>& starts,
                                        const std::function<void()>& meanwhile, double patience) {
  const Uptime uptime;
  std::vector<Worker> workers;
  workers.reserve(starts.size());
  for (const StartProcess& start : starts) workers.emplace_back(start, patience);
  while (true) {
    std::vector<pollfd> waits;
    std::vector<Worker*> waiting;
    for (Worker& worker : workers) {
      if (!worker.reading()) continue;
      waits.push_back({worker.file(), POLLIN, 0});
      waiting.push_back(&worker);
    }
    if (waits.empty()) break;
    const Clock::duration before = uptime.now();
    const int ready = poll(waits.data(), waits.size(), static_cast<int>(kLook.count()));
    if (meanwhile) meanwhile();
    // Time in which this program was stopped does not count: its helpers may have been, too.
    const auto waited = std::min<Clock::duration>(2 * kLook, uptime.now() - before);
    for (size_t i = 0; i < waits.size(); ++i) {
      if (ready > 0 && waits[i].revents != 0) {
        waiting[i]->read();
      } else {
        waiting[i]->wait(waited);
      }
    }
  }
  std::vector<HelperAnswer> answers;
  answers.reserve(workers.size());
  for (Worker& worker : workers) answers.push_back(worker.answer());
  return answers;
}

}  // namespace apothem
