#include "apps/process/work_line.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <utility>

namespace apothem {
namespace {

std::string describe(const Stage& stage, double seconds) {
  if (!stage.done) return fmt::format("{}, {:.0f} s, end not known", stage.name, seconds);
  const double share = *stage.done;
  if (!(share > 0)) return std::string(stage.name);
  return fmt::format("{}, {:.0f} %, {:.0f} s left", stage.name, 100 * share,
                     seconds * (1 - share) / share);
}

}  // namespace

WorkLine::WorkLine(std::string work)
    : work_(std::move(work)),
      terminal_(isatty(STDERR_FILENO) != 0),
      stage_start_(Clock::now()),
      next_(stage_start_ + std::chrono::seconds(1)) {}

WorkLine::~WorkLine() {
  if (drawn_ && terminal_) {
    std::fputs("\r\033[K", stderr);
    std::fflush(stderr);
  }
}

void WorkLine::report(const Stage& stage) {
  check();
  const Clock::time_point now = Clock::now();
  if (stage.name != stage_) {
    stage_ = stage.name;
    stage_start_ = now;
  }
  if (now < next_) return;
  next_ = now + (terminal_ ? std::chrono::milliseconds(200) : std::chrono::milliseconds(5000));
  drawn_ = true;
  const double seconds = std::chrono::duration<double>(now - stage_start_).count();
  const std::string text = fmt::format("{}: {}", work_, describe(stage, seconds));
  const std::string line = terminal_ ? "\r\033[K" + text : text + "\n";
  std::fputs(line.c_str(), stderr);
  std::fflush(stderr);
}

void WorkLine::check() {
  if (signals_.asked()) throw Interrupted();
}

}  // namespace apothem
