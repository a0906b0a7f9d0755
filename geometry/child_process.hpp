// Work that may hang, crash or eat all memory, done in a child process.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace apothem {

struct ChildAnswer {
  std::vector<double> numbers;
  std::string failure;  ///< empty if the work was done, otherwise what happened to it
};

/// Runs `work` in a forked child, silenced, and returns what it returned. The child may take
/// `seconds` of processor time (rounded up), ten times that by the clock, and 4 GB of memory. An
/// exception of `work` is a failure like any other.
ChildAnswer in_child_process(const std::function<std::vector<double>()>& work, double seconds);

}  // namespace apothem
