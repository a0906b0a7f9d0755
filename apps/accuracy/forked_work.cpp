#include "apps/accuracy/forked_work.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <system_error>

namespace apothem {
namespace {

// The process has inherited the program's signal handlers and must not run any of them.
void leave_program(int output) {
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGILL, SIGTERM, SIGINT}) {
    std::signal(signal, SIG_DFL);
  }
  dup2(output, STDOUT_FILENO);
  const int silence = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (silence >= 0) dup2(silence, STDERR_FILENO);
}

}  // namespace

HelperAnswer run_forked(const std::function<void(const SendNumbers&)>& work, double seconds) {
  const auto start = [&](int output) {
    const pid_t parent = getpid(), id = fork();
    if (id < 0) throw std::system_error(errno, std::generic_category(), "a process to work in");
    if (id > 0) return id;
    leave_program(output);
    work_as_helper(parent, seconds, work);
  };
  return std::move(run_processes({start}).front());
}

}  // namespace apothem
