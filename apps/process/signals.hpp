// How SIGINT and SIGTERM end the program.
//
// A signal ends the program at once, with exit code 130, wherever it is, for as long as there is
// nothing that has to be completed: no loop has to look for it. While a Finishing exists, the work
// under way looks itself and ends where its files are complete. If it does not look for too long,
// the program ends at once after all; files are then as after a kill.
#pragma once

#include <sys/types.h>

#include <ctime>

namespace apothem {

/// Has both signals end the program. Called first of all, before main() even.
void heed_signals() noexcept;

/// Has a program that a signal ends at once say so as a JSON object on standard output, too.
void say_endings_in_json() noexcept;

/// The signal is passed on to this process when it ends the program at once. 0: to none.
void end_with_program(pid_t child) noexcept;

/// Work that looks for signals and then ends by itself.
class Finishing {
 public:
  Finishing();
  ~Finishing();
  Finishing(const Finishing&) = delete;
  Finishing& operator=(const Finishing&) = delete;

  /// Whether there has been a signal. To be called often: a signal that nobody has looked for after
  /// four seconds, or after twice the longest time between two looks so far, ends the program.
  [[nodiscard]] bool asked();
  /// From now on the work may take its time. It is about to end.
  void take_time();

 private:
  timespec last_{};
  double longest_ = 0;  // between two looks, s
};

}  // namespace apothem
