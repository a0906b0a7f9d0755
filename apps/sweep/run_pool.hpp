// Private header: runs of a study as processes of this program, several at a time. A run that
// crashes takes nothing else down.
#pragma once

#include <sys/types.h>

#include <csignal>
#include <functional>
#include <vector>

#include "lib/sweep/study.hpp"

namespace apothem {

/// SIGINT, SIGTERM and SIGCHLD wait until they are asked for, while this exists.
class HeldSignals {
 public:
  HeldSignals();
  HeldSignals(const HeldSignals&) = delete;
  HeldSignals& operator=(const HeldSignals&) = delete;
  ~HeldSignals();
  /// The next one, or a negative number if there was none for 0.2 s.
  [[nodiscard]] int next() const;

 private:
  sigset_t held_{}, before_{};
};

/// While it exists, SIGINT and SIGTERM do not end the program: the tables of a study are complete
/// too before they do.
class RunPool {
 public:
  /// `jobs`: processes at a time. Runs that have failed are repeated only with `retry_failed`.
  RunPool(const Study& study, int jobs, bool retry_failed);

  struct Progress {
    size_t ended = 0;    ///< runs that this pool has worked on
    size_t failed = 0;   ///< of these
    size_t skipped = 0;  ///< being run by another process, or ended by it meanwhile
    size_t running = 0;
    size_t total = 0;
    double seconds = 0;  ///< since the start
  };
  /// Works on runs, in their order, and calls `report` now and then. SIGINT and SIGTERM are passed
  /// on, and no more runs begin; those that were running leave checkpoints. Returns false after
  /// such a signal. Throws SystemFailure.
  bool work(const std::vector<const PlannedRun*>& runs,
            const std::function<void(const Progress&)>& report);

 private:
  struct Child {
    const PlannedRun* run;
    int messages;  // descriptor, locked while somebody works on the run
    bool resumed;
    pid_t process;
  };
  void start(const PlannedRun& run);
  void launch(Child child);
  void collect();
  bool is_over(const Child& child, int status);

  HeldSignals signals_;
  const Study& study_;
  size_t jobs_;
  bool retry_failed_;
  bool interrupted_ = false;
  std::vector<Child> children_;
  Progress progress_;
};

}  // namespace apothem
