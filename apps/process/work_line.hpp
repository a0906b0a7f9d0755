// What a user sees and can do while a polygon takes long: a line with progress on standard error,
// and an end by Ctrl-C.
#pragma once

#include <exception>
#include <string>

#include "apps/process/signals.hpp"
#include "apps/process/status_line.hpp"
#include "geometry/polygon/progress.hpp"

namespace apothem {

/// Thrown where a computation has been interrupted by a signal.
class Interrupted : public std::exception {
 public:
  [[nodiscard]] const char* what() const noexcept override { return "interrupted"; }
};

/// Shows the progress of one computation, from its second second on: redrawn on a terminal, a line
/// every five seconds elsewhere. While it exists, SIGINT and SIGTERM do not end the program; they
/// end the computation at its next report.
class WorkLine {
 public:
  /// `work` says in a few words what is computed.
  explicit WorkLine(std::string work);

  /// Shows a report. Throws Interrupted after a signal.
  void report(const Stage& stage);
  /// Throws Interrupted after a signal.
  void check();

 private:
  Finishing signals_;
  std::string work_;
  StatusLine line_;
  std::string stage_;
  Clock::time_point stage_start_;
};

}  // namespace apothem
