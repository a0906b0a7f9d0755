// Work in a child process: what crashes there or never ends harms nobody.
#pragma once

#include <functional>
#include <vector>

namespace apothem {

struct ChildAnswer {
  enum class End { finished, failed, crashed, silent, not_started };
  std::vector<double> numbers;  ///< all that was sent before the end
  End end = End::not_started;   ///< failed: an exception; silent: killed for taking too long
  int signal = 0;               ///< of a crash
};

/// Hands numbers to the parent; may be called any number of times.
using SendNumbers = std::function<void(const std::vector<double>&)>;

/// Runs `work` in a child process with standard output and error closed off. It is killed when it
/// sends nothing for `seconds`, and ends by itself after a little more processor time if the parent
/// is gone.
ChildAnswer run_in_child(const std::function<void(const SendNumbers&)>& work, double seconds);

}  // namespace apothem
