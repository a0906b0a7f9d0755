// How the program ends, for the program itself and for studies, whose runs are programs.
#pragma once

namespace apothem {

/// The exit codes of the program, which its users may rely on.
namespace exit_code {
inline constexpr int done = 0;  ///< everything succeeded
/// An expectation of a scene, or an expected value of a file of pairs, was not met; or runs of a
/// study have failed.
inline constexpr int missed = 1;
inline constexpr int bad_input = 2;  ///< the command line or an input file is wrong
inline constexpr int unstable = 3;   ///< unstable, or outside the range of the method
/// The operating system failed: disk full, no permission, out of memory.
inline constexpr int system_failed = 4;
inline constexpr int interrupted = 130;  ///< stopped by a signal; 128 + SIGINT
}  // namespace exit_code

}  // namespace apothem
