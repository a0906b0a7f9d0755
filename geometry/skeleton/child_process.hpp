// Functions that run work in child processes, so that the program survives if the work crashes,
// never ends or takes too much memory.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace apothem {

/// What a child process has sent, and how it ended.
struct ChildAnswer {
  /// How the child ended: the work was finished; it failed with an exception; it crashed with a
  /// signal; it was killed because it had sent nothing for too long; or it could not be started.
  enum class End { finished, failed, crashed, silent, not_started };
  std::vector<double> numbers;  ///< all numbers that were sent before the end
  End end = End::not_started;   ///< how the child ended
  int signal = 0;               ///< number of the signal that ended the child, otherwise 0

  /// Describes the failure in words; empty if the work was finished.
  [[nodiscard]] std::string failure() const;
};

/// Sends numbers to the parent process. The work may call it any number of times.
using SendNumbers = std::function<void(const std::vector<double>&)>;

/// Work for a child process.
using ChildWork = std::function<void(const SendNumbers&)>;

/// Runs `work` in a child process, whose standard output and standard error are discarded. The
/// child is killed if it sends nothing for `seconds` of processor time (rounded up), or for ten
/// times that by the clock. It may take 4 GB of memory in addition to what the parent has mapped.
/// Failures of the child are reported in the answer and not by an exception. `meanwhile` is called
/// several times a second; if it throws, the child is killed and the exception passed on. The child
/// does not outlive the parent.
ChildAnswer run_in_child(const ChildWork& work, double seconds,
                         const std::function<void()>& meanwhile = {});

/// Runs several works at the same time, each as run_in_child does. The limits hold for each child.
std::vector<ChildAnswer> run_in_children(const std::vector<ChildWork>& works, double seconds,
                                         const std::function<void()>& meanwhile = {});

}  // namespace apothem
