// Work in a child process: what crashes there, never ends or eats all memory harms nobody.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace apothem {

struct ChildAnswer {
  enum class End { finished, failed, crashed, silent, not_started };
  std::vector<double> numbers;  ///< all that was sent before the end
  End end = End::not_started;   ///< failed: an exception; silent: killed for taking too long
  int signal = 0;               ///< of a crash

  /// What happened, in words; empty if the work was done.
  [[nodiscard]] std::string failure() const;
};

/// Hands numbers to the parent; may be called any number of times.
using SendNumbers = std::function<void(const std::vector<double>&)>;

/// Runs `work` in a child process with standard output and error closed off. It is killed when it
/// sends nothing for `seconds` of processor time (rounded up) or ten times that by the clock, and
/// may take 4 GB of memory.
ChildAnswer run_in_child(const std::function<void(const SendNumbers&)>& work, double seconds);

}  // namespace apothem
