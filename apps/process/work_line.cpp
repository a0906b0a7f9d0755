#include "apps/process/work_line.hpp"

#include <fmt/format.h>

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
    : work_(std::move(work)), line_(std::chrono::seconds(1)), stage_start_(Clock::now()) {}

void WorkLine::report(const Stage& stage) {
  check();
  if (stage.name != stage_) {
    stage_ = stage.name;
    stage_start_ = Clock::now();
  }
  if (!line_.is_due()) return;
  const double seconds = seconds_since(stage_start_);
  line_.show(fmt::format("{}: {}", work_, describe(stage, seconds)));
}

void WorkLine::check() {
  if (signals_.asked()) throw Interrupted();
}

}  // namespace apothem
