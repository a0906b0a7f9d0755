#include "apps/process/signals.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <string_view>

#include "apps/commands.hpp"
#include "lib/system/clock.hpp"

namespace apothem {
namespace {

constexpr unsigned kPatience = 4;  // s

// Signal handlers use nothing but these.
std::atomic<bool> finishing = false, asked_to_end = false, in_json = false;
std::atomic<unsigned> patience = kPatience;  // s; 0: without end
std::atomic<pid_t> child = 0;
static_assert(std::atomic<unsigned>::is_always_lock_free &&
              std::atomic<pid_t>::is_always_lock_free);

void say(int descriptor, std::string_view text) {
  [[maybe_unused]] const ssize_t written = write(descriptor, text.data(), text.size());
}

[[noreturn]] void end_at_once(int /*signal*/) {
  const bool late = finishing;
  const std::string_view message =
      late ? "interrupted, and ended before what was under way was finished; files are as they "
             "were then"
           : "interrupted";
  say(STDERR_FILENO, "apothem: ");
  say(STDERR_FILENO, message);
  say(STDERR_FILENO, "\n");
  if (in_json) {
    say(STDOUT_FILENO, "{\"error\":\"");
    say(STDOUT_FILENO, message);
    say(STDOUT_FILENO, "\"}\n");
  }
  if (child > 0) kill(child, SIGINT);
  _exit(exit_code::interrupted);
}

void on_signal(int signal) {
  if (!finishing) end_at_once(signal);
  if (!asked_to_end.exchange(true)) alarm(patience);
}

void handle(int signal, void (*handler)(int)) {
  struct sigaction action = {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;  // a file that is being opened is none that has failed
  sigaction(signal, &action, nullptr);
}

#ifndef __SANITIZE_ADDRESS__
// The initialisation of the libraries takes longer than all else in a short call. This comes before
// it.
[[gnu::section(".preinit_array"), gnu::used]] void (*const before_libraries)() = [] {
  heed_signals();
};
#endif

}  // namespace

void heed_signals() noexcept {
  handle(SIGINT, on_signal);
  handle(SIGTERM, on_signal);
  handle(SIGALRM, end_at_once);
}

void say_endings_in_json() noexcept { in_json = true; }

void end_with_program(pid_t process) noexcept { child = process; }

Finishing::Finishing() {
  clock_gettime(CLOCK_MONOTONIC_COARSE, &last_);
  patience = kPatience;
  asked_to_end = false;
  finishing = true;
}

Finishing::~Finishing() {
  alarm(0);
  finishing = false;
}

bool Finishing::asked() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC_COARSE, &now);  // within 4 ms, in a few nanoseconds
  const double since = in_seconds(now) - in_seconds(last_);
  last_ = now;
  if (since > longest_) {
    longest_ = since;
    patience = std::max(kPatience, static_cast<unsigned>(std::min(std::ceil(2 * since), 1e6)));
  }
  if (asked_to_end) take_time();
  return asked_to_end;
}

void Finishing::take_time() {
  patience = 0;
  alarm(0);
}

}  // namespace apothem
