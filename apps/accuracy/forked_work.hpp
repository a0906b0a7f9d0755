// Work in a process that is forked from this one, so that it has all that is in memory and harms
// nothing if it crashes. For the program only: the library never forks the process it is used in.
#pragma once

#include "geometry/skeleton/helper_process.hpp"
#include "geometry/skeleton/helper_side.hpp"

namespace apothem {

/// Runs `work` in a forked process, with the limits of run_helpers. Throws std::system_error if the
/// system gives no process.
HelperAnswer run_forked(const std::function<void(const SendNumbers&)>& work, double seconds);

}  // namespace apothem
