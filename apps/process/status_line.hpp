// A line on standard error that says how far a long work has come.
#pragma once

#include <optional>
#include <string>

#include "lib/system/clock.hpp"

namespace apothem {

/// The line is redrawn on a terminal, and gone at the end; elsewhere each text is a line of its
/// own.
class StatusLine {
 public:
  /// `wait`: until the first line is due; nothing: as between two lines.
  explicit StatusLine(std::optional<Clock::duration> wait = {});
  ~StatusLine() { clear(); }
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;

  [[nodiscard]] bool on_terminal() const { return terminal_; }
  /// Whether it is time for another line: every 0.2 s on a terminal, every 5 s elsewhere.
  [[nodiscard]] bool is_due();
  void show(const std::string& text);
  void clear();

 private:
  bool terminal_, drawn_ = false;
  Clock::duration pause_;
  Clock::time_point next_;  // when the next line is due
};

}  // namespace apothem
