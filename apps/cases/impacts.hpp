// Private header: how well impacts keep energy, for tests and benchmarks.
#pragma once

#include <algorithm>
#include <cmath>

#include "lib/dynamics/simulation.hpp"

namespace apothem::samples {

/// Steps until there have been so many impacts. Returns the root of the mean squared energy error
/// of an impact, over `energy` (J), from the times at which nothing touches.
inline double error_per_impact(Simulation& simulation, int impacts, double energy) {
  int counted = 0, seen = 0, before = 0;
  double last = 0, squares = 0;
  while (counted < impacts) {
    simulation.step();
    const int now = simulation.counts().touching_now;
    counted += std::max(0, now - before);
    before = now;
    if (now > 0 || counted == seen) continue;
    const double error = simulation.energies().total_error / energy;
    squares += (error - last) * (error - last);
    last = error, seen = counted;
  }
  return std::sqrt(squares / seen);
}

}  // namespace apothem::samples
