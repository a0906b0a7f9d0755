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
#include <memory>

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
[[noreturn]] void work_as_child(int file, const ChildWork& work, double seconds, pid_t parent) {
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

// A child at work, and what it has sent so far.
class Worker {
 public:
  // Starts the child.
  Worker(const ChildWork& work, double seconds)
      : patience_(static_cast<long long>(1000 * kWait * seconds)) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) return;
    const pid_t parent = getpid();
    const pid_t id = fork();
    if (id == 0) {
      close(ends[0]);
      work_as_child(ends[1], work, seconds, parent);
    }
    close(ends[1]);
    pipe_ = std::make_unique<File>(ends[0]);
    if (id < 0) return;
    child_ = std::make_unique<Child>(id);
    deadline_ = Clock::now() + patience_;
    reading_ = true;
  }

  [[nodiscard]] bool reading() const { return reading_; }
  [[nodiscard]] int file() const { return pipe_->number(); }
  // Time that is left to the next sign of life.
  [[nodiscard]] std::chrono::milliseconds left() const {
    return std::chrono::duration_cast<std::chrono::milliseconds>(deadline_ - Clock::now());
  }
  // Ends a child that has sent nothing for too long.
  void give_up() {
    child_->end();
    reading_ = false;
    silent_ = true;
  }
  // Reads what is there.
  void read() {
    char buffer[65536];
    const ssize_t count = ::read(pipe_->number(), buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) return;
    if (count > 0) bytes_.insert(bytes_.end(), buffer, buffer + count);
    reading_ = count > 0;
    deadline_ = Clock::now() + patience_;
  }

  // Waits for the end of the child.
  ChildAnswer answer() {
    using End = ChildAnswer::End;
    ChildAnswer answer;
    if (!child_) return answer;
    answer.numbers.resize(bytes_.size() / sizeof(double));
    std::copy_n(bytes_.data(), answer.numbers.size() * sizeof(double),
                reinterpret_cast<char*>(answer.numbers.data()));
    const int status = child_->wait();
    if (silent_) {
      answer.end = End::silent;
    } else if (WIFSIGNALED(status)) {
      answer.end = WTERMSIG(status) == SIGXCPU ? End::silent : End::crashed;
      answer.signal = WTERMSIG(status);
    } else {
      answer.end = WEXITSTATUS(status) == 0 ? End::finished : End::failed;
    }
    return answer;
  }

 private:
  std::chrono::milliseconds patience_;
  std::unique_ptr<File> pipe_;
  std::unique_ptr<Child> child_;
  Clock::time_point deadline_;
  std::vector<char> bytes_;
  bool reading_ = false;
  bool silent_ = false;
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

ChildAnswer run_in_child(const ChildWork& work, double seconds,
                         const std::function<void()>& meanwhile) {
  return std::move(run_in_children({work}, seconds, meanwhile).front());
}

std::vector<ChildAnswer> run_in_children(const std::vector<ChildWork>& works, double seconds,
                                         const std::function<void()>& meanwhile) {
  std::vector<Worker> workers;
  workers.reserve(works.size());
  for (const ChildWork& work : works) workers.emplace_back(work, seconds);
  while (true) {
    std::vector<pollfd> waits;
    std::vector<Worker*> waiting;
    long long wait = kLook;
    for (Worker& worker : workers) {
      if (worker.reading() && worker.left().count() <= 0) worker.give_up();
      if (!worker.reading()) continue;
      waits.push_back({worker.file(), POLLIN, 0});
      waiting.push_back(&worker);
      wait = std::min<long long>(wait, worker.left().count() + 1);
    }
    if (waits.empty()) break;
    const int ready = poll(waits.data(), waits.size(), static_cast<int>(wait));
    if (meanwhile) meanwhile();
    if (ready <= 0) continue;
    for (size_t i = 0; i < waits.size(); ++i) {
      if (waits[i].revents != 0) waiting[i]->read();
    }
  }
  std::vector<ChildAnswer> answers;
  answers.reserve(workers.size());
  for (Worker& worker : workers) answers.push_back(worker.answer());
  return answers;
}

}  // namespace apothem
