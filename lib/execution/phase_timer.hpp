// Seconds spent in the parts of a step, for run.json.
#pragma once

#include <array>
#include <chrono>

namespace apothem {

/// Parts of the step.
enum class Phase { integrate, elements, place, search, contact, gather };
inline constexpr std::array kPhaseNames{"integrate", "elements", "place",
                                        "search",    "contact",  "gather"};
using PhaseSeconds = std::array<double, kPhaseNames.size()>;

/// Adds the time since the last lap to a part; costs nothing while it is off.
class PhaseTimer {
 public:
  void start(bool on) {
    on_ = on;
    if (on_) last_ = std::chrono::steady_clock::now();
  }
  void lap(Phase phase) {
    if (!on_) return;
    const auto now = std::chrono::steady_clock::now();
    seconds_[static_cast<size_t>(phase)] += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }
  [[nodiscard]] const PhaseSeconds& seconds() const { return seconds_; }

 private:
  bool on_ = false;
  PhaseSeconds seconds_{};
  std::chrono::steady_clock::time_point last_;
};

}  // namespace apothem
