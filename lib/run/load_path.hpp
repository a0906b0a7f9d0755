// Load steps of automatic size: how far the next one goes, and when the loads cannot grow any more.
#pragma once

#include <algorithm>

#include "lib/archive/archive.hpp"

namespace apothem {

/// The times of load steps. A step without equilibrium is halved until it is found or is as short
/// as the resolution; then the limit lies between its ends.
class LoadPath {
 public:
  static constexpr double kResolution = 1e-4;  ///< of the time at the limit
  static constexpr double kLongest = 0.1;      ///< of the run; the first step, and the longest one

  explicit LoadPath(double end = 1) : end_(end), step_(kLongest * end) {}

  /// The end of the step from an equilibrium at `time`, s.
  [[nodiscard]] double next(double time) const {
    const double step = std::max(step_, resolution(time));
    if (missed_ > 0) return missed_ - time <= step ? missed_ : time + step;
    return end_ - time <= step * (1 + 1e-9) ? end_ : time + step;
  }
  void found(double time) {
    if (missed_ > 0 && time < missed_) {
      step_ = (missed_ - time) / 2;
    } else {
      missed_ = 0;  // what was not found from farther away
      step_ = std::min(2 * step_, kLongest * end_);
    }
  }
  /// There is no equilibrium at `at` that could be reached from that at `time`. Returns true if
  /// that is the limit.
  bool missed(double time, double at) {
    missed_ = at;
    step_ = time > 0 ? (at - time) / 2 : 0;
    return at - time <= resolution(time) * (1 + 1e-9);
  }
  void fields(Archive& archive) { archive("end", end_)("step", step_)("missed", missed_); }

 private:
  [[nodiscard]] double resolution(double time) const {
    return kResolution * std::max(time, end_ / 100);
  }

  double end_, step_;
  double missed_ = 0;  // the earliest time without equilibrium so far, or 0
};

}  // namespace apothem
