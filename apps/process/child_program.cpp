#include "apps/process/child_program.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>

#include "apps/process/signals.hpp"
#include "lib/output/files.hpp"

namespace apothem {
namespace {

// A file in memory, which takes any amount while nobody reads.
class Buffer {
 public:
  Buffer() : descriptor_(memfd_create("output", MFD_CLOEXEC)) {
    if (descriptor_ < 0) throw SystemFailure("output of a child process", errno);
  }
  ~Buffer() { ::close(descriptor_); }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;
  [[nodiscard]] int descriptor() const { return descriptor_; }
  [[nodiscard]] std::string text() const {
    std::string all;
    std::array<char, 4096> part{};
    lseek(descriptor_, 0, SEEK_SET);
    for (ssize_t n = 0; (n = ::read(descriptor_, part.data(), part.size())) > 0;) {
      all.append(part.data(), static_cast<size_t>(n));
    }
    return all;
  }

 private:
  int descriptor_;
};

// In the new process; returns if the program cannot begin. Only calls that are safe after a fork.
void become(const std::vector<char*>& arguments, int output, int messages, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(127);
  const int nothing = ::open("/dev/null", O_RDONLY);
  if (nothing < 0 || dup2(nothing, STDIN_FILENO) < 0 || dup2(output, STDOUT_FILENO) < 0 ||
      dup2(messages, STDERR_FILENO) < 0) {
    return;
  }
  if (nothing > STDERR_FILENO) ::close(nothing);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  execv(arguments[0], arguments.data());
}

}  // namespace

// A child of a program that is killed would go on alone: it is asked to end instead.
int start_program(std::vector<std::string> words, int output, int messages, pid_t& process) {
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  std::array<int, 2> failure{};  // through which the child says why it could not begin
  if (pipe2(failure.data(), O_CLOEXEC) != 0) return errno;
  const pid_t parent = getpid();
  process = fork();
  if (process == 0) {
    become(arguments, output, messages, parent);
    const int error = errno;
    static_cast<void>(!::write(failure[1], &error, sizeof error));
    _exit(127);
  }
  int error = process < 0 ? errno : 0;
  ::close(failure[1]);
  if (process > 0) {
    ssize_t count = 0;
    while ((count = ::read(failure[0], &error, sizeof error)) < 0 && errno == EINTR) continue;
    if (count > 0) waitpid(process, nullptr, 0);
  }
  ::close(failure[0]);
  return error;
}

ProgramResult run_program(const std::vector<std::string>& words) {
  const Buffer out, err;
  ProgramResult result;
  pid_t process = 0;
  result.start_error = start_program(words, out.descriptor(), err.descriptor(), process);
  if (result.start_error != 0) return result;
  end_with_program(process);
  int status = 0;
  while (waitpid(process, &status, 0) < 0) {
    if (errno != EINTR) throw SystemFailure(words[0], errno);
  }
  end_with_program(0);
  result.code = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  result.out = out.text();
  result.err = err.text();
  return result;
}

}  // namespace apothem
