#include "apps/process/out_of_memory.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <new>
#include <string_view>

#include "apps/commands.hpp"

namespace apothem {
namespace {

// Less than this is left where an allocation has failed, unless that was a larger one. Libraries
// allocate less at a time.
constexpr size_t kLack = size_t{1} << 26;  // bytes

[[noreturn]] void end_without_memory() {
  constexpr std::string_view kText = "apothem: out of memory\n";
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, kText.data(), kText.size());
  _exit(exit_code::system_failed);
}

[[maybe_unused]] bool has_memory() {
  void* const some = mmap(nullptr, kLack, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (some == MAP_FAILED) return false;
  munmap(some, kLack);
  return true;
}

#ifndef __SANITIZE_ADDRESS__  // which reports crashes itself
// Libraries of others use memory that they have not got, and the stack may find none to grow. Where
// there is enough, the program has a mistake that is to be seen: the signal comes again.
void on_crash(int signal) {
  if (!has_memory()) end_without_memory();
  std::signal(signal, SIG_DFL);
  raise(signal);
}

void heed_crashes() {
  static std::array<char, 1 << 16> stack;  // a stack that cannot grow has no room for a handler
  stack_t own{};
  own.ss_sp = stack.data();
  own.ss_size = stack.size();
  sigaltstack(&own, nullptr);
  struct sigaction action = {};
  action.sa_handler = on_crash;
  action.sa_flags = SA_ONSTACK;
  for (const int signal : {SIGSEGV, SIGBUS, SIGABRT}) sigaction(signal, &action, nullptr);
}
#else
void heed_crashes() {}
#endif

void on_terminate() {
  try {
    if (std::current_exception()) std::rethrow_exception(std::current_exception());
  } catch (const std::bad_alloc&) {
    end_without_memory();
  } catch (...) {
    // A mistake in the program, which is to be seen.
  }
  std::abort();
}

}  // namespace

void heed_lack_of_memory() {
  std::set_terminate(on_terminate);
  heed_crashes();
}

}  // namespace apothem
