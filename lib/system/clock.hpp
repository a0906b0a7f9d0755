// Seconds of real time and of processors.
#pragma once

#include <chrono>
#include <ctime>

namespace apothem {

using Clock = std::chrono::steady_clock;

/// Real time since `start`, s.
inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

inline double in_seconds(const timespec& time) {
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Time that processors have worked for this process, in all its threads, s.
inline double processor_time() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return in_seconds(time);
}

}  // namespace apothem
