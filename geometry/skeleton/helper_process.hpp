// Runs a helper program, so that this program survives if the work of the helper crashes, never
// ends or takes too much memory. The helper is started with posix_spawn and never by fork: this
// program may have threads, may be a Python interpreter, and may hold much memory.
//
// A request is a list of numbers, which the helper reads from its standard input. It sends numbers
// back through its standard output (helper_side.hpp).
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace apothem {

/// What a helper has sent, and how it ended.
struct HelperAnswer {
  /// How the helper ended. These follow from the request: the work was finished; it failed with an
  /// exception; it crashed with a signal; or it used up its processor time. These say nothing about
  /// the request, and the same one may be asked again: the helper was killed because it did nothing
  /// for too long; or something else kept it from its work, such as a signal from outside or a lack
  /// of memory.
  enum class End { finished, failed, crashed, overran, stalled, prevented };
  std::vector<double> numbers;  ///< all numbers that were sent before the end
  End end = End::failed;        ///< how the helper ended
  int signal = 0;               ///< number of the signal that ended the helper, otherwise 0
  int code = 0;                 ///< exit code, if no signal did

  /// True if the end follows from the request alone.
  [[nodiscard]] bool is_certain() const { return end < End::stalled; }
  /// Describes the failure in words; empty if the work was finished.
  [[nodiscard]] std::string failure() const;
};

/// How long a helper may neither send anything nor use its processor, s of the clock, before it is
/// taken for stalled.
inline constexpr double kHelperPatience = 60;

/// Runs `program` for each request, all of them at the same time. Its standard error is discarded.
/// A helper ends if it sends nothing for `seconds` of processor time (rounded up), and is killed if
/// it has done nothing for `patience` seconds. It may take 4 GB of memory. Failures of a helper are
/// reported in its answer and not by an exception. `meanwhile` is called several times a second; if
/// it throws, the helpers are killed and the exception passed on. Helpers do not outlive this
/// program, and an interrupt from the terminal does not reach them. Throws std::system_error if the
/// program cannot be started.
std::vector<HelperAnswer> run_helpers(const std::string& program,
                                      const std::vector<std::vector<double>>& requests,
                                      double seconds, const std::function<void()>& meanwhile = {},
                                      double patience = kHelperPatience);

/// Starts a process that sends its numbers to the file `output`, as helper_side.hpp does. Returns
/// the number of the process.
using StartProcess = std::function<int(int output)>;

/// The same with processes that are started in some other way, and limit themselves.
std::vector<HelperAnswer> run_processes(const std::vector<StartProcess>& starts,
                                        const std::function<void()>& meanwhile = {},
                                        double patience = kHelperPatience);

}  // namespace apothem
