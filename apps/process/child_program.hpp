// Private header: programs as child processes.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace apothem {

/// This program, as a child may be.
inline constexpr const char* kProgramItself = "/proc/self/exe";

/// Starts a program, `words[0]`, with its arguments. It reads nothing, and what it prints and its
/// messages go to two descriptors, which may be the same. Returns 0 or the number of the error.
int start_program(std::vector<std::string> words, int output, int messages, pid_t& process);

/// What a program that has ended leaves.
struct ProgramResult {
  int code = 0;          ///< exit code, or minus the number of the signal that has ended it
  std::string out, err;  ///< what it has printed, and its messages
  int start_error = 0;   ///< number of the error if it could not be started; otherwise 0
};

/// Runs a program until it ends. Throws SystemFailure if the system fails.
ProgramResult run_program(const std::vector<std::string>& words);

}  // namespace apothem
