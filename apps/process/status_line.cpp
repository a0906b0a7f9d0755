#include "apps/process/status_line.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace apothem {

StatusLine::StatusLine(std::optional<Clock::duration> wait)
    : terminal_(isatty(STDERR_FILENO) != 0),
      pause_(std::chrono::milliseconds(terminal_ ? 200 : 5000)),
      next_(Clock::now() + wait.value_or(pause_)) {}

bool StatusLine::is_due() {
  const Clock::time_point now = Clock::now();
  if (now < next_) return false;
  next_ = now + pause_;
  return true;
}

void StatusLine::show(const std::string& text) {
  fmt::print(stderr, "{}{}{}", terminal_ ? "\r\033[K" : "", text, terminal_ ? "" : "\n");
  std::fflush(stderr);
  drawn_ = true;
}

void StatusLine::clear() {
  if (!drawn_ || !terminal_) return;
  fmt::print(stderr, "\r\033[K");
  std::fflush(stderr);
  drawn_ = false;
}

}  // namespace apothem
